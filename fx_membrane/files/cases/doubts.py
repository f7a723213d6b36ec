"""Values of a case that are no faults, but hardly meant: units that are mixed up, changes without an effect."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ...geometry.sizes import measures
from ...model import laws
from ...model.changes import PrestressFactor
from ...model.loads import SpreadLoad
from ...model.stages import Stage
from ...model.structure import Structure
from .faults import Fault
from .units import NUMBER

MILLI = re.compile(r"(?<![A-Za-z])m(N|Pa)(?![A-Za-z])")
LARGE_STRAIN = 0.5  # estimated strain under a load
GAIN = 2.0  # factor of a prestress


def doubts_of(data: Mapping[str, Any], structure: Structure, stages: list[Stage]) -> list[Fault]:
    """Doubts on a case, each with the path of its value.

    Args:
        data: The tables of the file.
        structure: The structure, before form finding.
        stages: The stages.
    """
    own = str((data.get("units") or {}).get("force", ""))
    found = [] if MILLI.search(own) else list(_milli(data, ()))
    for number, stage in enumerate(stages):
        found += _loads(structure, stage, ("stages", number, "loads"))
        found += _changes(structure, stage, ("stages", number, "changes"))
    return found


def _milli(value: Any, path: tuple[str | int, ...]) -> Iterator[Fault]:
    """Texts in millinewtons or millipascals, which a capital letter makes a thousand million times as large."""
    if isinstance(value, dict | list):
        for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _milli(entry, (*path, key))
    elif isinstance(value, str) and (number := NUMBER.fullmatch(value)) and (unit := MILLI.search(number[2])):
        yield Fault(path, f"{value!r} is in thousandths of {unit[1]}; 'M{unit[1]}', a million of them, may be meant")


def _loads(structure: Structure, stage: Stage, path: tuple[str | int, ...]) -> Iterator[Fault]:
    """Find loads that stretch a flat strip between edges, of the size of the part, by more than half."""
    for number, load in enumerate(stage.loads):
        if not isinstance(load, SpreadLoad) or load.part not in structure.membranes:
            continue  # some parts are made with the form
        part = structure.membranes[load.part]
        if not laws.strain_limit(part.material) < 1:  # foils are made for it
            continue
        size = float(np.sqrt(measures(structure.points, part.cells).sum()))
        most = float(np.linalg.norm(np.asarray(load.load).reshape(-1, 3), axis=1).max())
        strain = ((most * size / part.material.stiffness) ** 2 / 24) ** (1 / 3)
        if strain > LARGE_STRAIN:
            yield Fault(
                (*path, number),
                f"this load stretches part {load.part!r}, of about {size:.3g} by {size:.3g}, by some "
                f"{100 * strain:.0f} %; check the units of load, lengths and stiffness",
            )


def _changes(structure: Structure, stage: Stage, path: tuple[str | int, ...]) -> Iterator[Fault]:
    """Factors of a prestress that is not there, or that grows by them beyond all practice."""
    for number, change in enumerate(stage.changes):
        if not isinstance(change, PrestressFactor):
            continue
        if not np.any(np.asarray(structure.parts[change.part].prestress)):
            words = (
                f"part {change.part!r} has no prestress, so the factor has no effect; of a natural shape give a stretch"
            )
            yield Fault((*path, number), words)
        elif change.factor > GAIN:
            words = f"{change.factor:g} times the prestress is much; a loss of 20 % is the factor 0.8"
            yield Fault((*path, number, "factor"), words)
