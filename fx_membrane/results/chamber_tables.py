"""Gas in the chambers of a state: lines of reports, and plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..assembly.gas import ChamberResult
from .states import StageResult


def chamber_lines(result: StageResult, force: str, length: str) -> list[str]:
    """Line on each chamber: volume, pressure above that of the air around, and its derivative by the volume."""
    return [
        f"  chamber {name!r}: {found.state}, pressure {found.pressure:.6g} {force}/{length}2, volume "
        f"{found.volume:.6g} {length}3{_slope(found, force, length)}"
        for name, found in result.chambers.items()
    ]


def _slope(found: ChamberResult, force: str, length: str) -> str:
    return f", dp/dV {found.dp_dV:.6g} {force}/{length}5" if found.dp_dV and math.isfinite(found.dp_dV) else ""


def chambers_summary(chambers: Mapping[str, ChamberResult]) -> dict[str, dict[str, Any]]:
    """Gas in chambers as plain data; dp/dV is None for a given volume, where it has no number."""
    return {
        name: {
            "state": found.state,
            "pressure": found.pressure,
            "volume": found.volume,
            "dp/dV": found.dp_dV if math.isfinite(found.dp_dV) else None,
        }
        for name, found in chambers.items()
    }
