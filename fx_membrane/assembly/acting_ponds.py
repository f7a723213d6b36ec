"""Ponds that act on the same cells: their groups, the water of their basins, and all that has come."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..model.basins import StandingWater
from ..model.ponds import amount
from ..model.structure import Structure
from .actions import ActingPond


def amount_of(structure: Structure, waters: Sequence[ActingPond]) -> float:
    """Volume of all water of ponds on the same cells that has come [m3]."""
    return sum(entry.factor * amount(structure, entry.pond) for entry in waters)


def water_of(waters: Sequence[ActingPond]) -> StandingWater | None:
    """Water in the basins of ponds on the same cells; None for one level on all of them."""
    return next((entry.water for entry in waters if entry.water is not None), None)


def pond_groups(ponds: Sequence[ActingPond]) -> list[tuple[ActingPond, ...]]:
    """Ponds that share their cells, together."""
    groups: dict[Any, list[ActingPond]] = {}
    for entry in ponds:
        cells = None if entry.pond.cells is None else np.asarray(entry.pond.cells).tobytes()
        groups.setdefault((entry.pond.part, cells), []).append(entry)
    return [*map(tuple, groups.values())]
