"""Cutting pattern that a case asks for: checked with the other tables, then made of the form."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ...checks import validation
from ...form_finding.form import Form
from ...model.parts import Membrane
from ...model.structure import Structure
from ...patterns.allowances import Allowances
from ...patterns.compensated_cloth import cutting_pattern
from ...patterns.cutting import cut_strips
from ...patterns.flat_strips import CuttingPattern
from ...patterns.proof_remarks import strength_missed, stress_missed
from ...patterns.proofs import PatternProof
from ...patterns.seam_families import seams_between
from ...patterns.strip_copies import with_copies
from ...results.limits import Limits
from ...surfaces.planar_cuts import planar_cut
from ...surfaces.surface_lines import geodesic
from ..patterns.paper import paper_of
from .changes import changes_of
from .choices import NUMBERED, Choices, Outline
from .compensation_tables import check_compensation, compensation_from
from .decompensated import decompensated_of, on_strips
from .faults import Faults, Unknown, Wrong, at_key
from .loads import loads_of
from .making import make
from .structure_schema import NodeChoice
from .table import BROKEN, is_whole, sound

POSITIVE = ("size", "transition", "roll_width", "mark_spacing", "stress_error")
TRAIL = ("patterns",)


@dataclass(frozen=True, eq=False)
class PatternPlan:
    """Cutting pattern that a case asks for.

    Attributes:
        part: Name of the membrane that is cut; None for all.
        geodesics: Ends of seams, each a node or a place.
        planes: Points and normals of planes.
        families: Borders between which there are seams, and the number of strips; None for as many as the roll needs.
        cables: Names of cables along which the membrane is cut.
        loads: Loads that act in the designed shape.
        changes: Changes that act with them, as of gas.
        allowances: Widths beyond the sewing lines.
        copies: Cut strips of equal shape once.
        nearest_stress: Move outlines until the stress after assembly is nearest to that of the design.
        strips: Further arguments of `cut_strips`.
        cloth: Further arguments of `cutting_pattern`.
        files: Further arguments of `write_patterns`.
        proof: Further arguments of `prove_pattern`.
    """

    part: str | None
    geodesics: Sequence[tuple[Any, Any]]
    planes: Sequence[tuple[Any, Any]]
    families: Sequence[tuple[Any, Any, int | None]]
    cables: Sequence[str]
    loads: Sequence[Any]
    changes: Sequence[Any]
    allowances: Allowances
    copies: bool = False
    nearest_stress: bool = False
    strips: dict[str, Any] = field(default_factory=dict)
    cloth: dict[str, Any] = field(default_factory=dict)
    files: dict[str, Any] = field(default_factory=dict)
    proof: dict[str, Any] = field(default_factory=dict)

    @property
    def sewn_width(self) -> float | None:
        """Width of the roll without allowances for welds; None without a roll."""
        roll = self.files.get("roll_width")
        return None if roll is None else roll - 2 * self.allowances.seam

    def pattern(self, shape: Structure | Form) -> CuttingPattern:
        """Cut a shape, and flatten and compensate its strips.

        Raises:
            ValueError, RuntimeError, ImportError: As of `geodesic`, `planar_cut`, `cut_strips` and `cutting_pattern`.
        """
        seams: list[Any] = list(self.cables)
        for number, ends in enumerate(self.geodesics):
            with _entry("geodesics", number):
                seams.append(geodesic(shape, *ends, part=self.part))
        for number, (point, normal) in enumerate(self.planes):
            with _entry("planes", number):
                seams += planar_cut(shape, point, normal, self.part)
        for number, (first, last, count) in enumerate(self.families):
            roll = None if count else self.sewn_width
            with _entry("between", number):
                seams += seams_between(shape, first, last, count, self.part, roll_width=roll)
        strips = cut_strips(shape, seams, self.part, **self.strips)
        return cutting_pattern(with_copies(strips) if self.copies else strips, **on_strips(strips, self.cloth))

    def strength_of(self, pattern: CuttingPattern, limits: Limits) -> dict[str, float]:
        """Find the strengths of strips among the limits, by their names or those of the membranes they are cut from."""
        strips = pattern.strips
        return {name: most for name, most in limits.stress.items() if name in strips.names or strips.cut_from(name)}

    def missed(self, proof: PatternProof) -> tuple[str, ...]:
        """Clauses on what a proof has beyond limits of the case: strengths, and a stress error if it asks for one."""
        return (*(stress_missed(proof) if "stress_error" in self.proof else ()), *strength_missed(proof))


@contextmanager
def _entry(key: str, number: int) -> Iterator[None]:
    """Name the entry of the table that seams are made of in errors."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{key}.{number}: {error}") from None


def plan_of(faults: Faults, choices: Choices, outline: Outline, table: Any) -> PatternPlan:
    """Check the table of a cutting pattern.

    Raises:
        ValueError: It asks for no seam.
        Unknown: Some of it, or of what it depends on, has a fault.
    """
    count = len(faults)
    _check_numbers(faults, table)
    _check_compensation(faults, table)
    allowances = Allowances()
    if table.allowances is not None and table.allowances is not BROKEN:
        with faults.at(*TRAIL, "allowances"):
            given = {key: getattr(table.allowances, key) for key in table.allowances.model_fields_set}
            allowances = make(faults, (*TRAIL, "allowances"), Allowances, given, {})
    _check_roll(faults, table.roll_width, allowances)
    if table.part is not None:
        with faults.at(*TRAIL):
            choices.check_part(outline.structure, table.part, 2)
    with faults.at(*TRAIL, "cables"):
        for number, name in enumerate([] if table.cables is BROKEN else table.cables):
            with at_key(number):
                choices.check_part(outline.structure, name, 1, "")
    geodesics: list[tuple[Any, Any]] = []
    with faults.at(*TRAIL):
        geodesics = _geodesics(choices, outline, table)
    families = _families(faults, choices, outline, table)
    kept: dict[str, Any] = {}
    with faults.at(*TRAIL, "decompensate"):
        kept = decompensated_of(choices, outline, table)
    loads, changes = _acting(faults, choices, outline, table)
    if len(faults) > count or not is_whole(table):
        raise Unknown
    if not (geodesics or table.planes or table.between or table.cables):
        raise ValueError("there are no seams; give geodesics, planes, between or cables")
    return PatternPlan(
        table.part,
        geodesics,
        [(plane.point, plane.normal) for plane in table.planes],
        families,
        table.cables,
        loads,
        changes,
        allowances,
        table.copies,
        table.nearest_stress,
        _given(table, "size", "names", "warp"),
        _given(table, "transition") | kept | {"compensation": compensation_from(table.compensation)},
        _given(table, "roll_width", "mark_spacing", "material", "date", "paper", "scale"),
        _given(table, "stress_error"),
    )


def _check_numbers(faults: Faults, table: Any) -> None:
    """Check the lengths, the paper and the scale."""
    for key in POSITIVE:
        value = getattr(table, key)
        if value is not None and value is not BROKEN:
            with faults.at(*TRAIL, key):
                validation.positive(key, value)
    if table.paper not in (None, BROKEN):
        with faults.at(*TRAIL, "paper"):
            paper_of(table.paper)
    if table.scale not in (None, BROKEN):
        with faults.at(*TRAIL, "scale"):
            validation.positive_integer("scale", table.scale)


def _check_roll(faults: Faults, roll: Any, allowances: Allowances) -> None:
    """Refuse a roll that is no wider than two welds."""
    if roll not in (None, BROKEN) and 0 < roll <= 2 * allowances.seam:
        with faults.at(*TRAIL, "roll_width"):
            raise ValueError(f"roll_width is {roll:g}, no more than two allowances of seams; give a wider roll")


def _check_compensation(faults: Faults, table: Any) -> None:
    """Check compensation, and the transition beside decompensated edges."""
    if table.compensation is not BROKEN:
        check_compensation(faults, table.compensation)
    if table.decompensate not in ([], BROKEN) and table.transition is None:
        with faults.at(*TRAIL, "decompensate"):
            raise ValueError("the width over which compensation begins beside them is missing; give transition as well")
    if table.decompensate == [] and table.transition not in (None, BROKEN):
        with faults.at(*TRAIL, "transition"):
            raise ValueError("nothing is decompensated; give decompensate as well, or leave it out")


def _given(table: Any, *keys: str) -> dict[str, Any]:
    return {key: getattr(table, key) for key in keys if key in table.model_fields_set}


def _geodesics(choices: Choices, outline: Outline, table: Any) -> list[tuple[Any, Any]]:
    """Find the ends of seams: numbers of nodes, or places."""
    if table.geodesics is BROKEN:
        raise Unknown
    found, wrong = list[Any](), list[Wrong]()
    for row, ends in enumerate(table.geodesics):
        if len(ends) != 2:
            wrong.append(
                Wrong("a geodesic has two ends; give a pair as [3, 7] or [[0, 0, 5], [4, 2, 0]]", "geodesics", row)
            )
            continue
        nodes = [entry for entry in ends if not isinstance(entry, list)]
        if nodes and outline.renumbered:
            wrong.append(Wrong("after a new mesh there are other numbers; give places", "geodesics", row))
            continue
        if nodes and not (choices.whole and outline.structure is not None):
            raise Unknown
        named = iter(choices.named(nodes, choices.rows, None, "geodesics", row))
        if nodes:
            with at_key("geodesics", row):
                numbers = iter(choices.numbers(list(named), len(outline.structure.points), "nodes").tolist())
        found.append(tuple(np.array(entry) if isinstance(entry, list) else next(numbers) for entry in ends))
    if wrong:
        raise wrong[0].beside(wrong[1:])
    return found


def _families(faults: Faults, choices: Choices, outline: Outline, table: Any) -> list[tuple[Any, Any, int | None]]:
    """Borders of families of seams, names of cables or nodes, and their numbers of strips."""
    found = []
    for row, entry in sound(table.between):
        trail = (*TRAIL, "between", row)
        ends = []
        for key in ("first", "last"):
            with faults.at(*trail):
                ends.append(_border(choices, outline, getattr(entry, key), key))
        if entry.strips not in (None, BROKEN):
            with faults.at(*trail, "strips"):
                validation.positive_integer("strips", entry.strips)
        elif entry.strips is None and table.roll_width is None:
            with faults.at(*trail):
                raise ValueError("neither strips nor a roll_width of the patterns is given; give one of them")
        if len(ends) == 2:
            found.append((*ends, entry.strips))
    return found


def _border(choices: Choices, outline: Outline, border: Any, key: str) -> Any:
    """Find a border: the name of a cable, the nodes of a group, or nodes."""
    if border is BROKEN:
        raise Unknown
    if isinstance(border, str):
        if choices.kinds is not None and border not in choices.kinds:  # a part with a fault is no group
            with at_key(key):
                return choices.nodes(outline, NodeChoice(group=border)).tolist()
        choices.check_part(outline.structure, border, 1, key)
        return border
    if outline.renumbered:
        raise Wrong(NUMBERED, key)
    if not (choices.whole and outline.structure is not None):
        raise Unknown
    named = choices.named(border, choices.rows, None, key)
    return choices.numbers(named, len(outline.structure.points), key).tolist()


def _acting(faults: Faults, choices: Choices, outline: Outline, table: Any) -> tuple[list[Any], list[Any]]:
    """Make the loads and changes of the proof."""
    loads = loads_of(faults, TRAIL, choices, outline, table.loads)
    changes = changes_of(faults, TRAIL, choices, outline, table.changes)
    for key, entries in (("loads", loads), ("changes", changes)):
        with faults.at(*TRAIL, key):
            _check_cells(outline.structure, table.part, entries)
    if changes and table.nearest_stress is True:
        with faults.at(*TRAIL, "changes"):
            raise ValueError("nearest_stress takes loads only; give a pressure as one, or leave nearest_stress out")
    return loads, changes


def _check_cells(structure: Structure | None, part: str | None, entries: Sequence[Any]) -> None:
    """Refuse loads and changes on some cells of a membrane that is cut."""
    cut = [part] if part else list(structure.parts_of(Membrane) if structure else ())
    for number, entry in enumerate(entries):
        if getattr(entry, "part", None) in cut and getattr(entry, "cells", None) is not None:
            raise Wrong("the membrane is cut, and its cells get other numbers; leave cells and where out", number)
