"""Materials and parts of a case."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from typing import Any

import numpy as np

from ... import RadialDirection
from ...checks import validation
from ...geometry.edges import edges_where
from ...geometry.line_order import path_along
from ...geometry.topology import boundary_edges
from ...model.fabrics import Fabric, OrthotropicFabric
from ...model.foils import MooneyRivlin, NeoHooke
from ...model.laws import Law
from ...model.parts import Cable, Line, Mast, Membrane, Part, Rope
from .choices import Choices, Nodes
from .faults import Fault, Faults, Unknown, Wrong, at_key, nearest
from .making import make
from .names import check_groups
from .structure_schema import AxisModel, BarPart, PartModel
from .table import BROKEN, given, is_whole, one_of

MATERIALS: dict[str, Any] = {
    "fabric": Fabric,
    "woven": OrthotropicFabric,
    "neo-hooke": NeoHooke,
    "mooney-rivlin": MooneyRivlin,
}


def rope_along(cells: Any, **numbers: Any) -> Rope:
    """Make a rope of the segments of one line.

    Raises:
        ValueError: They branch, or are in several pieces; a number does not fit.
    """
    return Rope(path_along(np.asarray(cells)), **numbers)


KINDS: dict[str, Any] = {"membrane": Membrane, "cable": Cable, "mast": Mast, "rope": rope_along}
SOUND: dict[str, dict[str, float]] = {
    "fabric": {"nu": 0.3},
    "woven": {"Et_warp": 1.0, "Et_weft": 1.0, "nu": 0.3, "Gt": 1.0},
    "neo-hooke": {},
    "mooney-rivlin": {},
}
Trail = tuple[str | int, ...]
PER_WIDTH = {  # numbers per width of the material, or others with a thickness
    "fabric": (("Et",), ("E", "thickness")),
    "neo-hooke": (("Gt",), ("E", "thickness")),
    "mooney-rivlin": (("C10t", "C01t"), ("C10", "C01", "thickness")),
}


def material_of(faults: Faults, trail: Trail, table: Any) -> Law:
    """Make a material.

    Raises:
        ValueError: Its numbers are not complete, or do not fit together.
        Unknown: Some of them have a fault.
    """
    values, maker = given(table, "kind"), MATERIALS[table.kind]
    if table.kind not in PER_WIDTH:
        return make(faults, trail, maker, values, SOUND[table.kind])
    usual, others = PER_WIDTH[table.kind]
    from_others = maker.from_moduli if table.kind == "mooney-rivlin" else maker.from_modulus
    common = {key: value for key, value in values.items() if key not in (*usual, *others)}
    makers = {usual: maker, others: from_others}
    with faults.at(*trail):
        keys = others if _alternative(values, usual, others) else usual
        return make(faults, trail, makers[keys], values, SOUND[table.kind] | dict.fromkeys(keys, 1.0))
    for keys, act in makers.items():  # each number alone
        sound = {key: 0.3 if key == "nu" else 1.0 for key in (*keys, *SOUND[table.kind])}
        for key, value in values.items():
            if is_whole(value) and (key in keys or (key in common and keys is usual)):
                with faults.at(*trail, key):
                    act(**{**sound, key: value})
    raise Unknown


def bar_of(faults: Faults, trail: Trail, table: BarPart, cells: Any) -> Line:
    """Make cables, masts or a rope of some cells, BROKEN for unknown ones.

    Raises:
        ValueError: Their numbers are not complete, or do not fit together.
        Unknown: Some of them have a fault.
    """
    values = given(table, *PLACES, "kind", "E", "area") | {"cells": cells}
    for key in ("E", "area"):
        value = getattr(table, key)
        if value is not None:
            with faults.at(*trail, key):
                if is_whole(value):
                    validation.positive(key, value)
    with faults.at(*trail):
        if _alternative(given(table), ("axial_stiffness",), ("E", "area")):
            E, area = table.E, table.area
            known = is_whole((E, area)) and E is not None and area is not None and min(E, area) > 0
            values["axial_stiffness"] = E * area if known else BROKEN  # type: ignore[operator]
    sound = {"cells": cells if is_whole(cells) else [[0, 1]], "axial_stiffness": 1.0}
    bar: Line = make(faults, trail, KINDS[table.kind], _of_cells(values), sound, _names(table))  # type: ignore[attr-defined]
    return bar


def part_of(faults: Faults, trail: Trail, table: Any, cells: Any, materials: Any, points: Any) -> Part:
    """Make a part of some cells, BROKEN for unknown ones.

    Raises:
        ValueError: Its numbers do not fit together.
        Unknown: It has a fault, or its material has one.
    """
    if table.kind != "membrane":
        return bar_of(faults, trail, table, cells)
    values = given(table, *PLACES, "kind") | {"cells": cells}
    if materials is BROKEN or table.material is BROKEN:
        values["material"] = BROKEN
    else:
        if table.material not in materials:
            near = nearest(table.material, materials)
            faults.append(Fault((*trail, "material"), f"{table.material!r} is not among materials{near}"))
        values["material"] = materials.get(table.material, BROKEN)
    if isinstance(table.warp, AxisModel):
        values["warp"] = BROKEN
        with faults.at(*trail, "warp"):
            if is_whole(table.warp):
                axis = RadialDirection(**given(table.warp))
                values["warp"] = axis(points[cells].mean(axis=1).T) if is_whole(cells) else (1.0, 0.0, 0.0)
    sound = {"cells": cells if is_whole(cells) else [[0, 1, 2]], "material": Fabric(1.0, 0.3), "warp": (1.0, 0.0, 0.0)}
    return make(faults, trail, Membrane, _of_cells(values), sound, _names(table))


def _names(table: PartModel) -> dict[str, str]:
    """Key by which a part chooses its cells."""
    return {"cells": next((key for key in PLACES[:-1] if getattr(table, key) is not None), "")}


def _of_cells(values: dict[str, Any]) -> dict[str, Any]:
    """Leave out what may be one for each cell, where these are not known."""
    if is_whole(values["cells"]):
        return values
    one = ("prestress", "warp", "natural_stretch")
    return {key: BROKEN if key in one and not _is_one(value) else value for key, value in values.items()}


def _is_one(value: Any) -> bool:
    """Tell if a value is of one cell for sure: a number, or three of a vector."""
    return isinstance(value, float) or (isinstance(value, list | tuple) and np.shape(value) == (3,))


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
        Unknown: They are edges of a part that has a fault, or the geometry has one.
    """
    key = one_of(table, "group", "cells", "lines", "edges_of")
    if key == "edges_of":
        choices.check_part(
            None, table.edges_of, 2, "edges_of"
        ) if table.edges_of not in cells or not choices.drawn else None
    if key in ("", "group") and not choices.drawn and table.group is not BROKEN:
        with at_key("group") if key else nullcontext():
            check_groups(choices.groups, table.group or name)
    if not choices.drawn or not is_whole((getattr(table, key or "group"), table.where)):
        raise Unknown
    points = choices.drawing.points
    if key in ("cells", "lines"):
        rows = choices.by_hand(table, np.arange(len(points)))
        wrong = np.flatnonzero(((rows < 0) | (rows >= len(points))).any(axis=1))
        if len(wrong):
            row = (int(wrong[0]),) if key == "cells" else ()
            raise Wrong(f"cells are rows of nodes from 0 to {len(points) - 1}; correct them", key, *row)
        return rows
    if key != "edges_of":
        with at_key("group") if key else nullcontext():
            return choices.of_groups(table.group or name, split)
    triangles = cells[str(table.edges_of)]
    if triangles is BROKEN:
        raise Unknown
    if np.shape(triangles)[1] != 3:
        raise Wrong(f"part {table.edges_of!r} is no membrane; name one", "edges_of")
    if table.where is None:
        return boundary_edges(triangles)
    with at_key("where"):
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
