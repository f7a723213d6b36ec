"""Materials and parts of a case."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ... import RadialDirection
from ...geometry.edges import edges_where
from ...geometry.topology import boundary_edges
from ...model.laws import Law
from ...model.materials import Fabric, MooneyRivlin, NeoHooke, OrthotropicFabric
from ...model.parts import Cable, Mast, Membrane, Part
from .choices import Choices, Nodes, given, one_of
from .faults import Unknown, nearest
from .structure_schema import BROKEN, AxisModel, BarPart, PartModel

MATERIALS: dict[str, Any] = {
    "fabric": Fabric,
    "woven": OrthotropicFabric,
    "neo-hooke": NeoHooke,
    "mooney-rivlin": MooneyRivlin,
}
KINDS: dict[str, Any] = {"membrane": Membrane, "cable": Cable, "mast": Mast}
PER_WIDTH = {  # numbers per width of the material, or others with a thickness
    "fabric": (("Et",), ("E", "thickness")),
    "neo-hooke": (("Gt",), ("E", "thickness")),
    "mooney-rivlin": (("C10t", "C01t"), ("C10", "C01", "thickness")),
}


def material_of(table: Any) -> Law:
    """Make a material.

    Raises:
        ValueError: Its numbers are not complete, or out of range.
    """
    values = given(table, "kind")
    maker = MATERIALS[table.kind]
    if table.kind in PER_WIDTH:
        per_width, others = PER_WIDTH[table.kind]
        if _alternative(values, per_width, others):
            maker = maker.from_moduli if table.kind == "mooney-rivlin" else maker.from_modulus
    law: Law = maker(**values)
    return law


def bar_of(table: BarPart, cells: Nodes) -> Cable | Mast:
    """Make cables or masts of some cells.

    Raises:
        ValueError: Their numbers are not complete, or out of range.
    """
    values = given(table, *PLACES, "kind", "E", "area")
    if _alternative(given(table), ("axial_stiffness",), ("E", "area")):
        assert table.E is not None
        assert table.area is not None
        values["axial_stiffness"] = table.E * table.area
    bar: Cable | Mast = KINDS[table.kind](cells, **values)  # type: ignore[attr-defined]  # of the derived tables
    return bar


def part_of(table: Any, cells: Nodes, materials: Mapping[str, Any], points: Any) -> Part:
    """Make a part of some cells.

    Raises:
        ValueError: It has no material, or its numbers are not complete or out of range.
        Unknown: Its material has a fault.
    """
    if table.kind != "membrane":
        return bar_of(table, cells)
    values = given(table, *PLACES, "kind", "material")
    if table.material not in materials:
        raise ValueError(f"its material {table.material!r} is not among materials{nearest(table.material, materials)}")
    if materials[table.material] is BROKEN:
        raise Unknown
    if isinstance(table.warp, AxisModel):
        values["warp"] = RadialDirection(**given(table.warp))(points[cells].mean(axis=1).T)
    return Membrane(cells, materials[table.material], **values)


PLACES = ("group", "cells", "lines", "edges_of", "where")


def cells_of(name: str, table: PartModel, cells: Mapping[str, Any], choices: Choices, split: bool) -> Nodes:
    """Cells of a part as rows of points of the geometry.

    Args:
        name: Name of the part.
        table: Its table.
        cells: Cells of the parts before it; BROKEN for one with a fault.
        choices: Choices in the geometry.
        split: Split quadrilaterals.

    Raises:
        ValueError: They are not given in one way, or do not exist.
        Unknown: They are edges of a part that has a fault.
    """
    one_of(table, "group", "cells", "lines", "edges_of")
    points = choices.drawing.points
    if table.cells is not None or table.lines is not None:
        rows = choices.by_hand(table, np.arange(len(points)))
        if rows.min() < 0 or rows.max() >= len(points):
            raise ValueError(f"cells are rows of nodes from 0 to {len(points) - 1}; correct them")
        return rows
    if table.edges_of is None:
        return choices.of_groups(table.group or name, split)
    if table.edges_of not in cells:
        near = nearest(table.edges_of, cells)
        raise ValueError(f"edges_of names {table.edges_of!r}, which is no membrane with cells{near}")
    triangles = cells[table.edges_of]
    if triangles is BROKEN:
        raise Unknown
    if np.shape(triangles)[1] != 3:
        raise ValueError(f"edges_of names {table.edges_of!r}, which is no membrane; name one")
    if table.where is None:
        return boundary_edges(triangles)
    return edges_where(points, triangles, lambda x: choices.inside(table.where, x.T))


def _alternative(values: Mapping[str, Any], usual: tuple[str, ...], others: tuple[str, ...]) -> bool:
    """Return True if the other numbers are given in the place of the usual ones.

    Raises:
        ValueError: Neither is given whole, or both.
    """
    found = {key for key in (*usual, *others) if values.get(key) is not None}
    if found not in (set(usual), set(others)):
        have = f", not {' and '.join(sorted(found))}" if found else ""
        raise ValueError(f"give {' and '.join(usual)}, or {', '.join(others[:-1])} and {others[-1]}{have}")
    return found == set(others)
