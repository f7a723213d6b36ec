"""Objects of the package from the tables of a case file; faults are collected, each with the path of its table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ...assembly.actions import unloaded
from ...model.parts import Part
from ...model.stages import Stage, check_stages
from ...model.structure import Structure
from .chambers import tell_chambers, with_chambers
from .changes import changes_of, shapes_after
from .choices import Choices, Outline
from .faults import Fault, Faults
from .form_steps import FormSteps
from .forms import Step
from .geometry import drawing_from, groups_of
from .loads import displacement_of, loads_of, supports_of
from .making import make
from .names import kinds_of, no_stage_before
from .parts import cells_of, material_of, part_of
from .patterns import PatternPlan, plan_of
from .schema import CaseModel
from .structure_schema import UnitNames
from .table import BROKEN, given, is_whole, sound


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
            self._choices.groups = groups_of(self._case.geometry)
        self._choices.chambers = None if self._case.chambers is BROKEN else self._case.chambers.keys()
        return self._made(self._parts(materials))

    def stages(self, outline: Outline) -> list[Stage]:
        """Make the stages of a structure."""
        stages, earlier = list[Stage](), list[Any]()
        known = outline.structure is not None and not self._case.form_finding  # a form has lengths of its own
        shapes = {None: unloaded(outline.structure).natural} if known else {}
        for number, table in sound(self._case.stages):
            trail = ("stages", number)
            loads = loads_of(self.faults, trail, self._choices, outline, table.loads)
            changes = changes_of(self.faults, trail, self._choices, outline, table.changes)
            if known and is_whole((table.name, table.after)) and len(changes) == len(table.changes):
                start = shapes.get(table.after, BROKEN)
                shapes[table.name] = shapes_after(self.faults, trail, outline.structure, changes, start)
            moves = []
            for row, entry in sound(table.displacements):
                with self.faults.at(*trail, "displacements", row):
                    moves.append(
                        displacement_of(self.faults, (*trail, "displacements", row), self._choices, outline, entry)
                    )
            with self.faults.at(*trail):
                values = given(table, "loads", "displacements", "changes")
                head = self._head(trail, values, earlier)
                stages.append(Stage(loads=loads, displacements=moves, changes=changes, **head))
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
        return FormSteps(self.faults, self._case, self._choices).prepared(structure)

    def patterns(self, outline: Outline) -> PatternPlan | None:
        """Check the cutting pattern; None if there is none, or with a fault."""
        plan = None
        if self._case.patterns is not None and self._case.patterns is not BROKEN:
            names = self._case.units or UnitNames()
            with self.faults.at("patterns"):
                plan = plan_of(self.faults, self._choices, outline, self._case.patterns, names.length)
        return plan

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
                parts[name] = _renumbered(made, self._choices.rows)
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
        supports = supports_of(self.faults, ("supports",), self._choices, Outline(made), self._case.supports)
        if made is None or not whole or self._case.supports is BROKEN or len(supports) < len(self._case.supports):
            tell_chambers(self.faults, self._choices, self._case.chambers)
            return made
        with self.faults.at("supports"):
            made = replace(made, supports=supports)
        return with_chambers(self.faults, made, self._case.chambers)

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


def _renumbered(part: Part, rows: Any) -> Part:
    """Part with other numbers of its nodes, those at the old ones in `rows`."""
    return replace(part, nodes=rows[part.nodes]) if part.shares_tension else replace(part, cells=rows[part.cells])
