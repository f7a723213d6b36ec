"""Changes of a stage in a case: of natural shape and prestress, and of gas."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ...assembly.load_cases import with_change
from ...model.cable_changes import FixedLength, GivenForce, UnstressedLength
from ...model.changes import Change, LengthChange, NaturalStretch, PrestressFactor, TemperatureChange, check_change
from ...model.gas import GasChange
from ...model.structure import Structure
from .chambers import gas_change_of
from .choices import Choices, Outline
from .faults import Faults
from .making import make
from .table import BROKEN, given, sound

KINDS: dict[str, tuple[int, Any, dict[str, Any]]] = {  # dimension of the part, 0 for any; class, sound values
    "temperature": (0, TemperatureChange, {"difference": 0.0, "expansion": 0.0}),
    "length": (1, LengthChange, {"change": 0.0}),
    "stretch": (0, NaturalStretch, {"stretch": 1.0}),
    "prestress factor": (0, PrestressFactor, {"factor": 1.0}),
    "given force": (1, GivenForce, {"force": 1.0}),
    "unstressed length": (1, UnstressedLength, {"length": 1.0}),
    "fixed length": (1, FixedLength, {}),
}
Trail = tuple[str | int, ...]


def changes_of(
    faults: Faults, trail: Trail, choices: Choices, outline: Outline, tables: Any
) -> list[Change | GasChange]:
    """Make the changes of a stage, those without a fault."""
    changes = list[Change | GasChange]()
    for number, table in sound(tables):
        place = (*trail, "changes", number)
        with faults.at(*place):
            if table.kind not in KINDS:
                changes.append(gas_change_of(faults, place, choices, outline, table))
                continue
            change = _change(faults, place, choices, outline, table)
            check_change(outline.structure, "The stage", change)
            changes.append(change)
    return changes


def shapes_after(
    faults: Faults, trail: Trail, structure: Structure, changes: Sequence[Change | GasChange], start: Any
) -> Any:
    """Natural shapes after the changes of a stage, from those at its start, see `with_change`.

    BROKEN if they go beyond all sense, which is told, or if those at the start are.
    """
    shapes = start
    for number, change in enumerate(changes):
        if shapes is BROKEN:
            break
        before, shapes = shapes, BROKEN
        with faults.at(*trail, "changes", number):
            shapes = with_change(structure, before, change)
    return shapes


def _change(faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: Any) -> Change:
    """Make a change.

    Raises:
        ValueError: Its numbers do not fit together.
        Unknown: It has a fault, or its place has one.
    """
    wanted, kind, usual = KINDS[table.kind]
    cells: Any = BROKEN
    with faults.at(*trail):
        cells = choices.cells(outline, table, wanted)
    values = given(table, "kind", "where") | {"cells": cells}
    names = {"cells": "cells" if table.cells is not None else "where" if table.where is not None else "part"}
    change: Change = make(faults, trail, kind, values, {"part": "part", "cells": None, **usual}, names)
    return change
