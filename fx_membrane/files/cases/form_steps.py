"""Steps of form finding from the tables of a case; faults are collected, each with the path of its table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ... import GeodesicDirection, RadialDirection
from ...checks import validation
from ...model.structure import Structure
from ...model.supports import Support
from .choices import CHOICES, NUMBERED, Choices, Nodes, Outline
from .faults import Fault, Faults, Unknown, at_key
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
from .loads import constraint_of, loads_of, supports_of
from .parts import bar_of
from .schema import CaseModel
from .structure_schema import AxisModel
from .table import BROKEN, given, is_whole, one_of, sound


class FormSteps:
    """Maker of the steps of form finding.

    Args:
        faults: Faults found so far, to which those of the steps are added.
        case: The validated tables; those with faults of their own are BROKEN.
        choices: Choices in the geometry.
    """

    def __init__(self, faults: Faults, case: CaseModel, choices: Choices):
        self.faults, self._case, self._choices = faults, case, choices

    def prepared(self, structure: Structure | None) -> tuple[list[Step], Outline]:
        """Prepare the steps; return them, and the structure with the bars that they add."""
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

    def _method(self, outline: Outline, table: MethodModel, number: int) -> Step:
        trail, count = ("form_finding", number), len(self.faults)
        loads = loads_of(self.faults, trail, self._choices, outline, table.loads)
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
        directions: dict[str, Any] = dict(axes)
        for name, pairs in sound(getattr(table, "geodesics", {})):
            with self.faults.at(*trail, "geodesics", name):
                directions[name] = self._geodesics(outline, name, pairs)
        if outline.structure is None or len(self.faults) > count:
            raise Unknown
        return method_step(table, loads, constraints, stress, directions)

    def _geodesics(self, outline: Outline, name: str, pairs: list[list[int | str]]) -> GeodesicDirection:
        """Direction along geodesics between pairs of nodes of a membrane."""
        self._choices.check_part(outline.structure, name, 2, "")
        if outline.renumbered:
            raise ValueError(NUMBERED)
        if not (self._choices.whole and is_whole(pairs)):
            raise Unknown
        return GeodesicDirection([[self._choices.node(end, self._choices.rows) for end in pair] for pair in pairs])

    def _net(self, outline: Outline, table: ForceDensity, number: int, loads: Sequence[Any]) -> Step:
        branches, trail = list[Any](), ("form_finding", number)
        for row, entry in sound(table.net):
            with self.faults.at(*trail, "net", row):
                branches.append(self._branches(outline, entry))
        supports: Any = table.supports
        if supports is not None:
            supports = supports_of(self.faults, (*trail, "supports"), self._choices, outline, supports)
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
                    if table.points is not BROKEN:
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
