"""Objects of the package from the tables of a case file; faults are collected, each with the path of its table."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.edges import edges_where
from ...geometry.grids import rectangle
from ...geometry.topology import boundary_edges
from ...model.loads import DistributedLoad, Load, PlanLoad, PointLoad, Pressure
from ...model.materials import Fabric, MooneyRivlin, NeoHooke, OrthotropicFabric
from ...model.parts import Cable, Mast, Membrane, Part
from ...model.stages import PrescribedDisplacement, Stage, check_stages
from ...model.structure import Structure
from ...model.supports import Support
from ..drawing import Drawing, nodes_of, triangles_of
from ..mesh_files import drawing_of
from . import schema, structure_schema
from .faults import Fault, nearest

Nodes = NDArray[np.int64]
Trail = tuple[str | int, ...]
MATERIALS = {
    "fabric": Fabric,
    "woven": OrthotropicFabric,
    "neo-hooke": NeoHooke,
    "mooney-rivlin": MooneyRivlin,
}
PARTS: dict[str, type[Part]] = {"membrane": Membrane, "cable": Cable, "mast": Mast}
NEAR = 1e-9  # of the size of the structure: a place within it of a range is in the range


class Builder:
    """Maker of the objects of a case.

    Args:
        case: The validated tables.
        folder: Folder of the case file, from which names of files are taken.

    Attributes:
        faults: The faults found so far.
    """

    def __init__(self, case: schema.CaseModel, folder: Path):
        self.faults: list[Fault] = []
        self._case, self._folder = case, folder
        self._drawing = Drawing("the geometry", "group", np.zeros((0, 3)))

    def structure(self) -> Structure | None:
        """Make the structure; None if it has a fault."""
        with self.at("geometry"):
            self._drawing = self._geometry()
        if self.faults:
            return None
        materials = {}
        for name, table in self._case.materials.items():
            with self.at("materials", name):
                materials[name] = MATERIALS[table.kind](**given(table, "kind"))
        cells = self._cells()
        parts: dict[str, Part] = {}
        for name, part in self._case.parts.items():
            known = getattr(part, "material", None) not in self._case.materials.keys() - materials.keys()
            with self.at("parts", name):
                if name in cells and known:  # what is not has its fault already
                    parts[name] = self._part(part, cells[name], materials)
        if self.faults:
            return None
        used = np.unique(np.concatenate([part.cells.ravel() for part in parts.values()]))
        row = np.full(len(self._drawing.points), -1)
        row[used] = np.arange(len(used))
        numbered = {name: replace(part, cells=row[part.cells]) for name, part in parts.items()}
        self._row = row
        made = None
        with self.at("parts"):
            made = Structure(self._drawing.points[used], numbered, (), self._case.separate)
        if made is None:
            return None
        supports = []
        for number, choice in enumerate(self._case.supports):
            with self.at("supports", number):
                supports.append(Support(self._nodes(made, choice), **given(choice, *CHOICES)))
        if not self.faults:
            with self.at("supports"):
                return replace(made, supports=supports)
        return None

    def stages(self, structure: Structure) -> list[Stage]:
        """Make the stages of a structure."""
        stages = []
        for number, table in enumerate(self._case.stages):
            trail: Trail = ("stages", number)
            loads = self._loads(structure, table.loads, trail)
            moves = []
            for row, entry in enumerate(table.displacements):
                with self.at(*trail, "displacements", row):
                    nodes = self._nodes(structure, entry)
                    moves.append(PrescribedDisplacement(nodes, **given(entry, *CHOICES)))
            with self.at(*trail):
                stages.append(Stage(loads=loads, displacements=moves, **given(table, "loads", "displacements")))
        if not self.faults:
            with self.at("stages"):
                check_stages(structure, stages)
        return stages

    def form_loads(self, structure: Structure) -> list[Load]:
        """Make the loads of form finding."""
        tables = self._case.form_finding.loads if self._case.form_finding else []
        return self._loads(structure, tables, ("form_finding",))

    @contextmanager
    def at(self, *trail: str | int) -> Iterator[None]:
        """Keep an error of the package as a fault of a table."""
        try:
            yield
        except (ValueError, TypeError, OSError, ImportError) as error:
            self.faults.append(Fault(trail, str(error)))

    def _geometry(self) -> Drawing:
        table = self._case.geometry
        if isinstance(table, structure_schema.FileGeometry):
            unit = self._case.units.length if self._case.units else None
            options = given(table, "kind", "file")
            return drawing_of(self._folder / table.file, options.pop("weld", None), unit)
        drawing = Drawing("the geometry", "group", np.zeros((0, 3)))
        if isinstance(table, structure_schema.GridGeometry):
            drawing.points, triangles = rectangle(**given(table, "kind"))
            drawing.add("grid", triangles)
        else:
            drawing.points = np.array(table.points, dtype=np.float64).reshape(-1, 3)
        return drawing

    def _cells(self) -> dict[str, Nodes]:
        """Cells of each part, edges of membranes last."""
        cells: dict[str, Nodes] = {}
        for late in (False, True):
            for name, part in self._case.parts.items():
                if (part.edges_of is not None) is late:
                    with self.at("parts", name):
                        cells[name] = self._cells_of(name, part, cells)
        return cells

    def _cells_of(self, name: str, part: structure_schema.PartModel, cells: Mapping[str, Nodes]) -> Nodes:
        _one_of(part, "group", "cells", "edges_of")
        points = self._drawing.points
        if part.cells is not None:
            rows = np.array(part.cells, dtype=np.int64)
            if rows.ndim != 2 or rows.min() < 0 or rows.max() >= len(points):
                raise ValueError(f"cells are rows of nodes from 0 to {len(points) - 1}; correct them")
            return rows
        if part.edges_of is not None:
            if part.edges_of not in cells:
                raise ValueError(
                    f"edges_of names {part.edges_of!r}, which is no membrane with cells{nearest(part.edges_of, cells)}"
                )
            triangles = cells[part.edges_of]
            if part.where is None:
                return boundary_edges(triangles)
            return edges_where(points, triangles, lambda x: self._in(part.where, x.T))
        split = getattr(self._case.geometry, "split_quadrilaterals", None)
        return triangles_of(self._drawing, part.group or name, bool(split))

    def _part(self, table: Any, cells: Nodes, materials: Mapping[str, Any]) -> Part:
        values = given(table, "kind", "group", "cells", "edges_of", "where", "material")
        if table.kind == "membrane":
            if table.material not in materials:
                raise ValueError(
                    f"its material {table.material!r} is not among materials{nearest(table.material, materials)}"
                )
            values["material"] = materials[table.material]
        return PARTS[table.kind](cells, **values)

    def _nodes(self, structure: Structure, table: structure_schema.NodeChoice) -> Nodes:
        _one_of(table, *CHOICES, needed=True)
        if table.nodes is not None:
            return np.array(table.nodes, dtype=np.int64)
        if table.group is not None:
            rows = self._row[nodes_of(self._drawing, table.group)]
            return rows[rows >= 0]
        if table.rim_of is not None:
            return np.unique(boundary_edges(structure.part(table.rim_of, Membrane).cells))
        found = np.flatnonzero(self._in(table.where, structure.points) & structure.used)
        if not len(found):
            raise ValueError("no node is in the range of where; correct it")
        return found

    def _loads(self, structure: Structure, tables: Sequence[Any], trail: Trail) -> list[Load]:
        loads: list[Load] = []
        for number, table in enumerate(tables):
            with self.at(*trail, "loads", number):
                loads.append(self._load(structure, table))
        return loads

    def _load(self, structure: Structure, table: Any) -> Load:
        if isinstance(table, schema.PointLoadModel):
            return PointLoad(self._nodes(structure, table), table.force)
        cells = self._chosen(structure, table)
        if isinstance(table, schema.PressureModel):
            return Pressure(table.pressure, table.part, cells)
        part = structure.parts.get(table.part)
        wanted = 1 if isinstance(table, schema.LineLoadModel) else 2
        if part is not None and part.dimension != wanted:
            raise ValueError(f"a load of kind {table.kind!r} does not act on part {table.part!r}; give another kind")
        kind = PlanLoad if isinstance(table, schema.PlanLoadModel) else DistributedLoad
        return kind(table.load, table.part, cells)

    def _chosen(self, structure: Structure, table: schema.CellChoice) -> Nodes | None:
        _one_of(table, "cells", "where")
        if table.part not in structure.parts:
            raise ValueError(f"there is no part {table.part!r}{nearest(table.part, structure.parts)}")
        if table.cells is not None:
            return np.array(table.cells, dtype=np.int64)
        if table.where is None:
            return None
        centres = structure.points[structure.parts[table.part].cells].mean(axis=1)
        found = np.flatnonzero(self._in(table.where, centres))
        if not len(found):
            raise ValueError("no cell has its centroid in the range of where; correct it")
        return found

    def _in(self, box: structure_schema.Box | None, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        inside = np.ones(len(points), dtype=bool)
        room = NEAR * np.ptp(self._drawing.points, axis=0).max()
        for axis, ends in enumerate((box.x, box.y, box.z) if box else ()):
            if ends is not None:
                inside &= (points[:, axis] >= ends[0] - room) & (points[:, axis] <= ends[1] + room)
        return inside


CHOICES = ("nodes", "group", "where", "rim_of")


def given(table: structure_schema.Model, *without: str) -> dict[str, Any]:
    """Values that a table gives, apart from some keys: the package has the defaults."""
    return {name: getattr(table, name) for name in table.model_fields_set if name not in without}


def _one_of(table: structure_schema.Model, *keys: str, needed: bool = False) -> None:
    given = [key for key in keys if getattr(table, key) is not None]
    if len(given) > 1 or (needed and not given):
        raise ValueError(f"give one of {', '.join(keys)}" + (f", not {' and '.join(given)}" if given else ""))
