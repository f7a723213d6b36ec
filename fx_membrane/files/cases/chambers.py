"""Chambers of a case, and the changes of their gas and of the air around."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ...analysis.stage_check import refuse_given_volumes
from ...model.chambers import Chamber
from ...model.gas import Ambient, GasAmount, GasChange, GasPressure, GasVolume, Seal, air_after, gas_after
from ...model.stages import Stage
from ...model.structure import Structure
from ...solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from .choices import Choices, Outline
from .faults import Faults, Unknown, Wrong, nearest
from .making import make
from .table import given, sound

Trail = tuple[str | int, ...]

KINDS: dict[str, tuple[Any, dict[str, Any]]] = {  # class, sound values
    "air": (Ambient, {"pressure": 1.0, "temperature": 300.0}),
    "gas pressure": (GasPressure, {"pressure": 1.0, "chamber": "chamber"}),
    "gas volume": (GasVolume, {"volume": 1.0, "chamber": "chamber"}),
    "gas amount": (GasAmount, {"pressure": 1.0, "volume": 1.0, "chamber": "chamber"}),
    "seal": (Seal, {"chamber": "chamber"}),
}


def with_chambers(faults: Faults, structure: Structure, tables: Any) -> Structure:
    """Structure with the chambers of a file, those without a fault."""
    found = dict[str, Chamber]()
    for name, table in sound(tables):
        with faults.at("chambers", name):
            chamber = make(faults, ("chambers", name), Chamber, given(table), {"parts": "part"})
            replace(structure, chambers={name: chamber})
            found[name] = chamber
    with faults.at("chambers"):
        return replace(structure, chambers=found)
    return structure


def tell_chambers(faults: Faults, choices: Choices, tables: Any) -> None:
    """Tell the faults of chambers that show without a structure: names of parts, and numbers."""
    for name, table in sound(tables):
        with faults.at("chambers", name):
            make(faults, ("chambers", name), Chamber, given(table), {"parts": "part"})
        for part in [table.parts] if isinstance(table.parts, str) else table.parts:
            with faults.at("chambers", name, "parts"):
                choices.check_part(None, part, 2, "")


def tell_gas(faults: Faults, stages: Sequence[Stage], solver: Any) -> None:
    """Tell the first stage whose gas does not follow from that before it, and a solver that keeps no volume."""
    airs, gases = dict[str | None, Any]({None: None}), dict[str | None, Any]({None: {}})
    for number, stage in enumerate(stages):
        count = len(faults)
        with faults.at("stages", number):
            air = airs[stage.name] = air_after(stage, airs[stage.after])
            gases[stage.name] = gas_after(stage, gases[stage.after], airs[stage.after], air)
        if len(faults) > count:
            return
    if isinstance(solver, ConjugateGradient | SteepestDescent):
        with faults.at("solver", "method"):
            refuse_given_volumes(stages, type(solver).__name__)


def gas_change_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: Any) -> GasChange:
    """Make a change of gas, or of the air around.

    Raises:
        ValueError: Its numbers do not fit together; the chamber does not exist.
        Unknown: It has a fault, or its chamber has one.
    """
    kind, usual = KINDS[table.kind]
    change: GasChange = make(faults, trail, kind, given(table, "kind"), usual)
    chamber = getattr(change, "chamber", None)
    if chamber is not None and choices.chambers is not None and chamber not in choices.chambers:
        raise Wrong(f"there is no chamber {chamber!r}{nearest(chamber, choices.chambers)}", "chamber")
    if chamber is not None and (outline.structure is None or chamber not in outline.structure.chambers):
        raise Unknown
    return change
