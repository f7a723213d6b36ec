"""Views of a scene: shapes with their fields, from stages, forms and structures alike."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...form_finding.form import Form
from ...model.structure import Structure
from ...results.chamber_tables import chamber_lines
from ...results.initial_stress import built_stress
from ...results.part_results import SHEAR
from ...results.states import StageResult, StageResults
from ...results.tables import Columns, cell_columns

Array = NDArray[np.float64]
Shown = StageResults | StageResult | Form | Structure


class View(NamedTuple):
    """Shape of a structure, and the fields on it.

    Attributes:
        name: Name of the stage, or of the kind of shape.
        displacement: Displacement of the nodes, shape (n, 3); None for a shape without one.
        columns: By part, values of its cells by name with unit, each of shape (cells,).
        loads: Loads on the nodes, shape (n, 3).
        reactions: Reactions, shape (n, 3).
        remarks: Sentences to be read before the numbers.
        notes: Sentences beside the picture.
    """

    name: str
    displacement: Array | None
    columns: dict[str, Columns]
    loads: Array
    reactions: Array
    remarks: Sequence[str] = ()
    notes: Sequence[str] = ()


def views(shown: Shown, force: str, length: str) -> tuple[Structure, list[View]]:
    """Structure of a scene and its views.

    Raises:
        ValueError: There is no stage; stages are of different structures; the form is that of a net.
    """
    if isinstance(shown, StageResult):
        shown = StageResults({shown.name: shown})
    if isinstance(shown, StageResults):
        found = [_stage(state, name, force, length) for name, state in shown.states.items()]
        if shown.failure:
            told = *found[-1].remarks, shown.failure.message
            found[-1] = found[-1]._replace(remarks=told)
        return _structure(shown.states), found
    structure = shown if isinstance(shown, Structure) else shown.structure
    zero = np.zeros_like(structure.points)
    if isinstance(shown, Form):
        columns = dict(_as_built(structure, force, length))
        for name, differences in shown.differences.items():
            columns[name]["difference from the wish [-]"] = differences
        return structure, [View("form", None, columns, zero, shown.reactions, shown.remarks)]
    return structure, [View("structure", None, dict(_as_built(structure, force, length)), zero, zero)]


def _structure(results: Mapping[str, StageResult]) -> Structure:
    if not results:
        raise ValueError("write_scene results have no stage; run at least one.")
    name, first = next(iter(results.items()))
    for other, state in results.items():
        if state.structure is not first.structure and not _same(state.structure, first.structure):
            raise ValueError(f"Stages {name!r} and {other!r} are of different structures; write a scene of each.")
    return first.structure


def _same(one: Structure, other: Structure) -> bool:
    return (
        list(one.parts) == list(other.parts)
        and np.array_equal(one.points, other.points)
        and all(np.array_equal(part.cells, other.parts[name].cells) for name, part in one.parts.items())
    )


def _stage(state: StageResult, name: str, force: str, length: str) -> View:
    columns = {part: cell_columns(state, part, force, length) for part in state.parts}
    geometry = {"cell", *(f"{axis} [{length}]" for axis in "xyz"), f"length [{length}]", f"area [{length}2]"}
    for part in state.parts:
        if not state.structure.has_sides(part):
            del columns[part][SHEAR]  # no numbers
    fields = {part: {head: table[head] for head in table if head not in geometry} for part, table in columns.items()}
    notes = [f"{line.strip().replace('chamber', 'Chamber', 1)}." for line in chamber_lines(state, force, length)]
    return View(name, state.displacement, fields, state.loads, state.reactions, state.remarks, notes)


def _as_built(structure: Structure, force: str, length: str) -> Iterator[tuple[str, Columns]]:
    """List the initial stress of each part under the names that results have: a form is at rest with it."""
    for name, tensors in built_stress(structure).items():
        if name in structure.bars:
            yield name, {f"force [{force}]": tensors[:, 0, 0]}
        else:
            unit = f"[{force}/{length}]"
            second, first = np.linalg.eigvalsh(tensors).T
            yield (
                name,
                {
                    f"principal stress I {unit}": first,
                    f"principal stress II {unit}": second,
                    f"stress along warp {unit}": tensors[:, 0, 0],
                    f"stress along weft {unit}": tensors[:, 1, 1],
                },
            )
