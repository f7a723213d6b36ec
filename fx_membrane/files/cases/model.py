"""Objects of the package from the tables of a case file; faults are collected, each with the path of its table."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ... import RadialDirection
from ...model.parts import Part
from ...model.stages import Stage, check_stages
from ...model.structure import Structure
from ...model.supports import Support
from ..drawing import Drawing
from .choices import CHOICES, NUMBERED, Choices, Nodes, Outline, given, one_of, sound
from .faults import Faults, Unknown, nearest
from .form_schema import ForceDensity, MastsAndStays, MethodModel, NewMesh
from .forms import Step, check_constraints, density_step, masts_step, mesh_step, method_step
from .geometry import drawing_from
from .loads import constraint_of, displacement_of, load_of
from .parts import bar_of, cells_of, material_of, part_of
from .schema import CaseModel
from .structure_schema import BROKEN, AxisModel


class Builder:
    """Maker of the objects of a case.

    Args:
        case: The validated tables; those with faults of their own are BROKEN.
        folder: Folder of the case file, from which names of files are taken.

    Attributes:
        faults: The faults found so far.
    """

    def __init__(self, case: CaseModel, folder: Path):
        self.faults = Faults()
        self._case, self._folder = case, folder
        bars = [set(step.bars) for step in case.form_finding if isinstance(step, MastsAndStays)]
        self._names = set(case.parts).union(*bars)
        self._choices = Choices(Drawing("the geometry", "group", np.zeros((0, 3))), self._names)

    def structure(self) -> Structure | None:
        """Make the structure, of all parts that have no fault; None if there is none."""
        materials: dict[str, Any] = dict.fromkeys(self._case.materials, BROKEN)
        for name, table in sound(self._case.materials):
            with self.faults.at("materials", name):
                materials[name] = material_of(table)
        drawn = False
        if self._case.geometry is not BROKEN:
            with self.faults.at("geometry"):
                drawing = drawing_from(self._case.geometry, self._folder, self._case.units)
                self._choices, drawn = Choices(drawing, self._names), True
        if not drawn:
            self._check_names(materials)
            return None
        return self._made(self._parts(materials))

    def stages(self, outline: Outline) -> list[Stage]:
        """Make the stages of a structure."""
        stages = []
        for number, table in sound(self._case.stages):
            trail = ("stages", number)
            loads = self._loads(outline, table.loads, *trail)
            moves = []
            for row, entry in sound(table.displacements):
                with self.faults.at(*trail, "displacements", row):
                    moves.append(displacement_of(self._choices, outline, entry))
            with self.faults.at(*trail):
                stages.append(Stage(loads=loads, displacements=moves, **given(table, "loads", "displacements")))
        if len(stages) == len(self._case.stages):
            alone = [replace(stage, loads=(), displacements=()) for stage in stages]
            with self.faults.at("stages"):
                check_stages(outline.structure, alone if self.faults else stages)
        return stages

    def form_finding(self, structure: Structure) -> tuple[list[Step], Outline]:
        """Prepare the steps of form finding; return them, and the structure with the bars that they add."""
        steps, outline, formed = list[Step](), Outline(structure), False
        for number, table in sound(self._case.form_finding):
            with self.faults.at("form_finding", number):
                if isinstance(table, MastsAndStays):
                    step, outline = self._masts(outline, table, number, formed)
                elif isinstance(table, NewMesh):
                    step, outline, formed = self._mesh(outline, table), outline._replace(renumbered=True), False
                else:
                    step, formed = self._method(outline, table, number), True
                steps.append(step)
        return steps, outline

    def check_part(self, structure: Structure, name: str, dimension: int) -> None:
        """Refuse a part that does not exist, or of another dimension.

        Raises:
            ValueError: The file has no part of that name, or one of another dimension.
            Unknown: It has one, with a fault.
        """
        self._choices.check_part(structure, name)
        if structure.parts[name].dimension != dimension:
            raise ValueError(f"part {name!r} is {'no membrane' if dimension == 2 else 'no cable or mast'}; name one")

    def _parts(self, materials: dict[str, Any]) -> dict[str, Part]:
        """Parts without a fault, in the numbers of the structure."""
        cells = self._cells()
        known = [rows for rows in cells.values() if rows is not BROKEN]
        self._choices.whole = len(known) == len(self._case.parts)
        used = np.unique(np.concatenate([rows.ravel() for rows in known])) if known else np.zeros(0, dtype=np.int64)
        self._choices.rows[used] = np.arange(len(used))
        self._used, parts = used, dict[str, Part]()
        for name, part in sound(self._case.parts):
            if cells[name] is not BROKEN:
                with self.faults.at("parts", name):
                    made = part_of(part, cells[name], materials, self._choices.drawing.points)
                    parts[name] = replace(made, cells=self._choices.rows[made.cells])
        return parts

    def _cells(self) -> dict[str, Any]:
        """Cells of each part as rows of the geometry, edges of membranes last; BROKEN for those with a fault."""
        split = bool(getattr(self._case.geometry, "split_quadrilaterals", None))
        cells: dict[str, Any] = {name: BROKEN for name, part in self._case.parts.items() if part is BROKEN}
        for late in (False, True):
            for name, part in sound(self._case.parts):
                if (part.edges_of is not None) is late:
                    with self.faults.at("parts", name):
                        cells[name] = cells_of(name, part, cells, self._choices, split)
                    cells.setdefault(name, BROKEN)
        return cells

    def _made(self, parts: dict[str, Part]) -> Structure | None:
        made = None
        if parts or not self._case.parts:
            separate = [pair for pair in self._case.separate if not set(pair) & (self._names - parts.keys())]
            with self.faults.at("parts"):
                made = Structure(self._choices.drawing.points[self._used], parts, (), separate)
        if made is None:
            return None
        supports = self._supports(Outline(made), self._case.supports, "supports")
        if len(parts) < len(self._case.parts):
            return made  # its nodes are not all that the supports know
        with self.faults.at("supports"):
            made = replace(made, supports=supports)
        return made

    def _supports(self, outline: Outline, tables: Sequence[Any], *trail: str | int) -> list[Support]:
        supports = []
        for number, table in sound(tables):
            with self.faults.at(*trail, number):
                supports.append(Support(self._choices.nodes(outline, table), **given(table, *CHOICES)))
        return supports

    def _loads(self, outline: Outline, tables: Sequence[Any], *trail: str | int) -> list[Any]:
        loads = []
        for number, table in sound(tables):
            with self.faults.at(*trail, "loads", number):
                loads.append(load_of(self._choices, outline, table))
        return loads

    def _method(self, outline: Outline, table: MethodModel, number: int) -> Step:
        trail = ("form_finding", number)
        loads = self._loads(outline, table.loads, *trail)
        check_constraints(table)
        for name in getattr(table, "stress", {}):
            self._choices.check_part(outline.structure, name)
        constraints = []
        for row, entry in sound(table.constraints):
            with self.faults.at(*trail, "constraints", row):
                constraints.append(constraint_of(self._choices, outline, entry))
        if isinstance(table, ForceDensity):
            return self._net(outline, table, number, loads)
        axes = {
            name: RadialDirection(**given(part.warp))
            for name, part in sound(self._case.parts)
            if isinstance(getattr(part, "warp", None), AxisModel)
        }
        return method_step(table, outline.structure, loads, constraints, axes)

    def _net(self, outline: Outline, table: ForceDensity, number: int, loads: Sequence[Any]) -> Step:
        branches = []
        for row, entry in sound(table.net):
            with self.faults.at("form_finding", number, "net", row):
                branches.append(self._branches(outline, entry))
        if len(branches) < len(table.net):
            raise Unknown
        supports: Sequence[Support] = outline.structure.supports
        if table.supports is not None:
            supports = self._supports(outline, table.supports, "form_finding", number, "supports")
        forces = np.zeros(outline.structure.points.shape)
        for load in loads:
            if not hasattr(load, "force"):
                raise ValueError("a net of force densities takes loads of kind 'point' only; give these")
            forces[load.nodes] += load.force
        return density_step(branches, supports, forces)

    def _branches(self, outline: Outline, table: Any) -> tuple[str, Nodes, Any]:
        one_of(table, "part", "group", "cells", "lines", needed=True)
        if table.part is None:
            return "", self._choices.lines(outline, table), table.density
        self._choices.check_part(outline.structure, table.part)
        part = outline.structure.parts[table.part]
        if part.dimension != 1:
            raise ValueError(f"part {table.part!r} is no cable; name one, or give lines")
        return table.part, part.cells, table.density

    def _masts(self, outline: Outline, table: MastsAndStays, number: int, formed: bool) -> tuple[Step, Outline]:
        """Step of masts and stays, and the structure with them, their forces unknown."""
        if not formed:
            raise ValueError("masts and stays need a form; put a method of form finding before them")
        if not self._choices.whole:
            raise Unknown
        n = len(outline.structure.points)
        named = table.points if isinstance(table.points, dict) else dict(enumerate(table.points))
        points = np.array(list(named.values()), dtype=np.float64).reshape(-1, 3)
        names = {name: n + row for row, name in enumerate(named) if isinstance(name, str)}
        places, bars = np.concatenate([outline.structure.points, points]), dict[str, Any]()
        for name, entry in sound(table.bars):
            with self.faults.at("form_finding", number, "bars", name):
                one_of(entry, "cells", "lines", needed=True)
                if outline.renumbered:
                    raise ValueError(NUMBERED)
                bars[name] = bar_of(entry, self._choices.by_hand(entry, self._choices.rows, names))
        heads = self._heads(outline, table, names, len(places))
        given_points = [tuple(point) for point in points.tolist()]
        feet = np.setdiff1d(np.arange(n, len(places)), [] if heads is None else heads)
        held = [*outline.structure.supports, *([Support(feet)] if len(feet) else [])]
        parts = {**outline.structure.parts, **bars}
        made = replace(outline.structure, points=places, parts=parts, supports=held)
        return masts_step(bars, given_points, heads, table.components), outline._replace(structure=made)

    def _heads(self, outline: Outline, table: MastsAndStays, names: Mapping[str, int], count: int) -> Nodes | None:
        """Heads of masts, which may be new points."""
        if table.heads is None or table.heads.nodes is None:
            return self._choices.nodes(outline, table.heads) if table.heads else None
        one_of(table.heads, *CHOICES)
        heads = [self._choices.node(entry, self._choices.rows, names) for entry in table.heads.nodes]
        if not all(0 <= node < count for node in heads):
            raise ValueError(f"heads are nodes from 0 to {count - 1}; correct them")
        return np.array(heads, dtype=np.int64)

    def _mesh(self, outline: Outline, table: NewMesh) -> Step:
        keep = self._choices.nodes(outline, table.keep) if table.keep else np.zeros(0, dtype=np.int64)
        return mesh_step(table, keep)

    def _check_names(self, materials: dict[str, Any]) -> None:
        """Check names alone, where there is no geometry to check more."""
        for name, part in sound(self._case.parts):
            with self.faults.at("parts", name):
                if getattr(part, "material", None) not in (None, *materials):
                    near = nearest(part.material, materials)
                    raise ValueError(f"its material {part.material!r} is not among materials{near}")
        earlier: list[str] = []
        for number, stage in sound(self._case.stages):
            for row, load in sound(stage.loads):
                with self.faults.at("stages", number, "loads", row):
                    if getattr(load, "part", None) not in (None, *self._names):
                        raise ValueError(f"there is no part {load.part!r}{nearest(load.part, self._names)}")
            with self.faults.at("stages", number):
                if stage.after not in (None, *earlier) and len(earlier) == number:
                    raise ValueError(f"no stage {stage.after!r} is before it{nearest(stage.after, earlier)}")
            earlier.append(stage.name)
