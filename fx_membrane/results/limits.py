"""Limits of a user's own on displacements, stresses and forces, and their checks."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..checks import validation
from ..geometry.extremes import first_largest
from .check import Check, Verdict
from .places import cell_place, node_place
from .plain_numbers import plain
from .states import StageResult


@dataclass(frozen=True)
class Limits:
    """Limits that states are checked against; a state beyond one fails its check.

    Args:
        displacement: Largest displacement of a node [m]; none if not given.
        stress: By membrane, the largest principal stress, strength over safety [N/m].
        force: By cable or mast, the largest force in tension or compression, strength over safety [N].

    Raises:
        ValueError: A limit is not positive.
    """

    displacement: float | None = None
    stress: Mapping[str, float] = field(default_factory=dict)
    force: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.displacement is not None:
            validation.store(self, validation.positive, "displacement")
        for kind in ("stress", "force"):
            values = {
                name: validation.positive(f"{kind} of {name!r}", value) for name, value in getattr(self, kind).items()
            }
            validation.keep(self, **{kind: values})


def limit_checks(result: StageResult, limits: Limits, length: str = "") -> Iterator[Check]:
    """Check a state against limits of the design: displacement, in a unit of length, and utilisation of parts."""
    if limits.displacement is not None:
        size = np.linalg.norm(result.displacement, axis=1)
        node = first_largest(size)
        remedy = "Raise the prestress or the stiffness, or hold it by more cables."
        place = node_place(result.structure, node)
        yield _judged("displacement", size[node], limits.displacement, remedy, place, length)
    for name, limit in {**limits.stress, **limits.force}.items():
        if name in result.parts:
            values = np.abs(result.parts[name].principal).max(axis=1) / limit
            cell = first_largest(values)
            remedy = "Take a stronger material, or relieve it by more curvature or more cables."
            place = cell_place(result.structure, name, cell)
            yield _judged(f"utilisation of {name!r}", values[cell], 1.0, remedy, place)


def _judged(name: str, number: float, limit: float, remedy: str, place: str, unit: str = "") -> Check:
    found, most = f"{plain(number, 3)} {unit}".rstrip(), f"{plain(limit, 4)} {unit}".rstrip()
    if number <= limit:
        return Check(name, found, most, Verdict.PASS, design=True)
    return Check(name, found, most, Verdict.FAIL, remedy, place, design=True)
