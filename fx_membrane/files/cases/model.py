"""Objects of the package from the tables of a case file; faults are collected, each with the path of its table."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ... import RadialDirection
from ...checks import validation
from ...model.loads import check_load
from ...model.parts import Part
from ...model.stages import Stage, check_stages
from ...model.structure import Structure
from ...model.supports import Support
from .choices import CHOICES, NUMBERED, Choices, Nodes, Outline, at_key, given, one_of, sound
from .faults import Fault, Faults, Unknown
from .form_schema import ForceDensity, MastsAndStays, MethodModel, NewMesh
from .forms import (
    Step,
    check_constraints,
    check_options,
    densities_of,
    density_step,
    masts_step,
    mesh_step,
    method_step,
    stress_of,
)
from .geometry import drawing_from
from .loads import constraint_of, displacement_of, load_of, support_of
from .making import make
from .names import kinds_of, no_stage_before
from .parts import bar_of, cells_of, material_of, part_of
from .schema import CaseModel
from .structure_schema import AxisModel
from .table import BROKEN, is_whole


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
        self._kinds = kinds_of(case)
        self._choices = Choices(None, self._kinds)

    def structure(self) -> Structure | None:
        """Make the structure, of all parts that have no fault; None if there is none."""
        materials: Any = self._case.materials
        if materials is not BROKEN:
            materials = dict.fromkeys(materials, BROKEN)
            for name, table in sound(self._case.materials):
                with self.faults.at("materials", name):
                    materials[name] = material_of(self.faults, ("materials", name), table)
        if self._case.geometry is not BROKEN:
            with self.faults.at("geometry"):
                drawing = drawing_from(self.faults, self._case.geometry, self._folder, self._case.units)
                self._choices = Choices(drawing, self._kinds)
        return self._made(self._parts(materials))

    def stages(self, outline: Outline) -> list[Stage]:
        """Make the stages of a structure."""
        stages, earlier = list[Stage](), list[Any]()
        for number, table in sound(self._case.stages):
            trail = ("stages", number)
            loads = self._loads(outline, table.loads, *trail)
            moves = []
            for row, entry in sound(table.displacements):
                with self.faults.at(*trail, "displacements", row):
                    moves.append(
                        displacement_of(self.faults, (*trail, "displacements", row), self._choices, outline, entry)
                    )
            with self.faults.at(*trail):
                values = given(table, "loads", "displacements")
                stages.append(Stage(loads=loads, displacements=moves, **self._head(trail, values, earlier)))
            earlier.append(table.name)
        if outline.structure is not None and not self.faults and self._case.stages is not BROKEN:
            with self.faults.at("stages"):
                check_stages(outline.structure, stages)
        return stages

    def _head(self, trail: tuple[str | int, ...], values: dict[str, Any], earlier: Sequence[Any]) -> dict[str, Any]:
        """Values of a stage apart from what it adds; its name and the stage before it are checked."""
        name, after = values.get("name"), values.get("after")
        names = [BROKEN if entry is BROKEN else entry.name for entry in self._case.stages]
        if name is not BROKEN and name in earlier:
            self.faults.append(Fault((*trail, "name"), f"{name!r} is the name of an earlier stage; give another"))
        if is_whole((after, earlier)) and after is not None and after not in earlier:
            with self.faults.at(*trail, "after"):
                raise ValueError(no_stage_before(after, name, earlier, names))
        make(self.faults, trail, Stage, values, {"name": "stage"})
        return values

    def form_finding(self, structure: Structure | None) -> tuple[list[Step], Outline]:
        """Prepare the steps of form finding; return them, and the structure with the bars that they add."""
        steps, outline, formed = list[Step](), Outline(structure), False
        tables = sound(self._case.form_finding)
        for number, table in tables:
            with self.faults.at("form_finding", number):
                if isinstance(table, MastsAndStays):
                    step, outline = self._masts(outline, table, number, formed)
                elif isinstance(table, NewMesh):
                    step, outline, formed = self._mesh(outline, table, number), outline._replace(renumbered=True), False
                else:
                    formed = True
                    step = self._method(outline, table, number)
                steps.append(step)
        self._choices.formed = self._case.form_finding is not BROKEN and len(steps) == len(self._case.form_finding)
        return steps, outline

    def check_part(self, structure: Structure | None, name: str, dimension: int) -> None:
        """Refuse a part that does not exist, or of another dimension, see `Choices.check_part`."""
        self._choices.check_part(structure, name, dimension, "")

    def _parts(self, materials: dict[str, Any]) -> dict[str, Part]:
        """Parts without a fault, in the numbers of the structure."""
        cells = self._cells()
        known = [rows for rows in cells.values() if rows is not BROKEN]
        self._choices.whole = self._choices.drawn and len(known) == len(self._items())
        used = np.unique(np.concatenate([rows.ravel() for rows in known])) if known else np.zeros(0, dtype=np.int64)
        self._choices.rows[used] = np.arange(len(used))
        self._used, parts = used, dict[str, Part]()
        for name, part in sound(self._case.parts):
            with self.faults.at("parts", name):
                made = part_of(self.faults, ("parts", name), part, cells[name], materials, self._choices.drawing.points)
                parts[name] = replace(made, cells=self._choices.rows[made.cells])
        return parts

    def _cells(self) -> dict[str, Any]:
        """Cells of each part as rows of the geometry, edges of membranes last; BROKEN for those with a fault."""
        split = bool(getattr(self._case.geometry, "split_quadrilaterals", None))
        cells: dict[str, Any] = {name: BROKEN for name, part in self._items() if part is BROKEN}
        for late in (False, True):
            for name, part in sound(self._case.parts):
                if (part.edges_of is not None) is late:
                    with self.faults.at("parts", name):
                        cells[name] = cells_of(name, part, cells, self._choices, split)
                    cells.setdefault(name, BROKEN)
        return cells

    def _items(self) -> Any:
        return [] if self._case.parts is BROKEN else self._case.parts.items()

    def _made(self, parts: dict[str, Part]) -> Structure | None:
        """Structure of parts, each of which is tried alone if they have a fault together."""
        made = None
        whole = len(parts) == len(self._items()) and self._choices.drawn
        points = self._choices.drawing.points[self._used]
        if self._choices.drawn and (parts or self._case.parts == {}):
            count = len(self.faults)
            for name, part in parts.items():
                with self.faults.at("parts", name):
                    Structure(points, {name: part})
            separate = self._separate(parts, points)
            if len(self.faults) == count:
                with self.faults.at("parts"):
                    made = Structure(points, parts, (), separate)
        self._choices.whole = whole and made is not None
        supports = self._supports(Outline(made), self._case.supports, "supports")
        if made is None or not whole or self._case.supports is BROKEN or len(supports) < len(self._case.supports):
            return made
        with self.faults.at("supports"):
            made = replace(made, supports=supports)
        return made

    def _separate(self, parts: dict[str, Part], points: Any) -> list[tuple[str, str]]:
        """Pairs of parts that may lie beside each other."""
        pairs = []
        for row, pair in sound(self._case.separate):
            for side, name in enumerate(pair):
                with self.faults.at("separate", row, side):
                    self._choices.check_part(None, name, 0, "")
            if set(pair) <= parts.keys():
                pairs.append(pair)
        return pairs

    def _supports(self, outline: Outline, tables: Sequence[Any], *trail: str | int) -> list[Support]:
        supports = []
        for number, table in sound(tables):
            with self.faults.at(*trail, number):
                made = support_of(self.faults, (*trail, number), self._choices, outline, table)
                outline.structure.check_nodes("It", np.asarray(made.nodes))
                supports.append(made)
        return supports

    def _loads(self, outline: Outline, tables: Sequence[Any], *trail: str | int) -> list[Any]:
        loads = []
        for number, table in sound(tables):
            with self.faults.at(*trail, "loads", number):
                load = load_of(self.faults, (*trail, "loads", number), self._choices, outline, table)
                check_load(outline.structure, "The stage", load)
                loads.append(load)
        return loads

    def _method(self, outline: Outline, table: MethodModel, number: int) -> Step:
        trail, count = ("form_finding", number), len(self.faults)
        loads = self._loads(outline, table.loads, *trail)
        with self.faults.at(*trail, "constraints"):
            check_constraints(table)
        constraints = []
        for row, entry in sound(table.constraints):
            with self.faults.at(*trail, "constraints", row):
                constraints.append(
                    constraint_of(self.faults, (*trail, "constraints", row), self._choices, outline, entry)
                )
        stress = {}
        for name, entry in sound(getattr(table, "stress", {})):
            with self.faults.at(*trail, "stress", name):
                stress[name] = stress_of(entry)
            with self.faults.at(*trail, "stress", name):
                self._choices.check_part(outline.structure, name, 2, "")
        check_options(self.faults, trail, table)
        if isinstance(table, ForceDensity):
            return self._net(outline, table, number, loads)
        axes = {
            name: RadialDirection(**given(part.warp))
            for name, part in sound(self._case.parts)
            if isinstance(getattr(part, "warp", None), AxisModel) and is_whole(part.warp)
        }
        if outline.structure is None or len(self.faults) > count:
            raise Unknown
        return method_step(table, loads, constraints, stress, axes)

    def _net(self, outline: Outline, table: ForceDensity, number: int, loads: Sequence[Any]) -> Step:
        branches, trail = list[Any](), ("form_finding", number)
        for row, entry in sound(table.net):
            with self.faults.at(*trail, "net", row):
                branches.append(self._branches(outline, entry))
        supports: Any = table.supports
        if supports is not None:
            supports = self._supports(outline, supports, *trail, "supports")
        if outline.structure is None or not is_whole((table.net, supports)) or len(branches) < len(table.net):
            raise Unknown
        supports = outline.structure.supports if supports is None else supports
        forces = np.zeros(outline.structure.points.shape)
        for load in loads:
            if not hasattr(load, "force"):
                raise ValueError("a net of force densities takes loads of kind 'point' only; give these")
            forces[load.nodes] += load.force
        return density_step(branches, supports, forces)

    def _branches(self, outline: Outline, table: Any) -> tuple[str, Nodes, Any]:
        key = one_of(table, "part", "group", "cells", "lines", needed=True)
        if key == "part":
            self._choices.check_part(outline.structure, table.part, 1)
            lines = outline.structure.parts[table.part].cells
        else:
            lines = self._choices.lines(outline, table)
        if not is_whole(table.density):
            raise Unknown
        with at_key("density"):
            return table.part or "", lines, densities_of(table.density, len(lines))

    def _masts(self, outline: Outline, table: MastsAndStays, number: int, formed: bool) -> tuple[Step, Outline]:
        """Step of masts and stays, and the structure with them, their forces unknown."""
        trail = ("form_finding", number)
        if not formed:
            words = "masts and stays need a form; put a method of form finding before them"
            self.faults.append(Fault((*trail, "method"), words))
        if table.components not in (None, BROKEN):
            with self.faults.at(*trail, "components"):
                validation.letters("components", table.components)
        known = self._choices.whole and outline.structure is not None
        n = len(outline.structure.points) if known else 0
        listed: Any = {} if table.points is BROKEN else table.points
        named: dict[Any, Any] = listed if isinstance(listed, dict) else dict(enumerate(listed))
        names = {name: n + row for row, name in enumerate(named) if isinstance(name, str)}
        bars = dict[str, Any]()
        for name, entry in sound(table.bars):
            with self.faults.at(*trail, "bars", name):
                cells: Any = BROKEN
                with self.faults.at(*trail, "bars", name):
                    one_of(entry, "cells", "lines", needed=True)
                    if outline.renumbered:
                        raise ValueError(NUMBERED)
                    if known and table.points is not BROKEN:
                        cells = self._choices.by_hand(entry, self._choices.rows, names)
                bars[name] = bar_of(self.faults, (*trail, "bars", name), entry, cells)
        if not known or table.points is BROKEN:
            raise Unknown
        points = np.array(list(named.values()), dtype=np.float64).reshape(-1, 3)
        places = np.concatenate([outline.structure.points, points])
        heads: Any = None
        with self.faults.at(*trail, "heads"):
            heads = self._heads(outline, table, names, len(places))
        if table.bars is BROKEN or len(bars) < len(table.bars):
            raise Unknown
        given_points = [tuple(point) for point in points.tolist()]
        feet = np.setdiff1d(np.arange(n, len(places)), [] if heads is None else heads)
        held = [*outline.structure.supports, *([Support(feet)] if len(feet) else [])]
        parts = {**outline.structure.parts, **bars}
        made = replace(outline.structure, points=places, parts=parts, supports=held)
        return masts_step(bars, given_points, heads, table.components), outline._replace(structure=made)

    def _heads(self, outline: Outline, table: MastsAndStays, names: Mapping[str, int], count: int) -> Nodes | None:
        """Heads of masts, which may be new points."""
        if table.heads is None or table.heads is BROKEN or table.heads.nodes is None:
            return self._choices.nodes(outline, table.heads) if table.heads else None
        one_of(table.heads, *CHOICES)
        if not is_whole(table.heads):
            raise Unknown
        found = self._choices.named(table.heads.nodes, self._choices.rows, names)
        return self._choices.numbers(found, count, "nodes")

    def _mesh(self, outline: Outline, table: NewMesh, number: int) -> Step:
        if table.size is not BROKEN:
            with self.faults.at("form_finding", number, "size"):
                validation.positive("size", table.size)
        keep = np.zeros(0, dtype=np.int64)
        if table.keep is not None:
            with self.faults.at("form_finding", number, "keep"):
                keep = self._choices.nodes(outline, table.keep)
        return mesh_step(table, keep)
