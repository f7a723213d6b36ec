"""Lines on changes of gas and of the air around, and rows of the gas in chambers, for the report."""

from __future__ import annotations

import math

from ...model.gas import Ambient, GasAmount, GasChange, GasPressure, GasVolume
from ...results.plain_numbers import plain
from ...results.states import StageResult


def gas_rows(state: StageResult, force: str, length: str) -> list[dict[str, str]]:
    """Gas in the chambers of a state, with units."""
    return [
        {
            "name": name,
            "state": found.state,
            "pressure": f"{plain(found.pressure)} {force}/{length}2",
            "volume": f"{plain(found.volume)} {length}3",
            "slope": f"{plain(found.dp_dV)} {force}/{length}5" if found.dp_dV and math.isfinite(found.dp_dV) else "",
        }
        for name, found in state.chambers.items()
    ]


def gas_action(change: GasChange, force: str, length: str) -> str:
    """Kind of a change, its value with units, and its chamber."""
    pressure = f"{force}/{length}2"
    if isinstance(change, Ambient):
        values = [] if change.pressure is None else [f"{change.pressure:.6g} {pressure}"]
        values += [] if change.temperature is None else [f"{change.temperature:.6g} K"]
        return f"Air around at {', '.join(values)}"
    if isinstance(change, GasPressure):
        return f"Pressure {change.pressure:.6g} {pressure} in {change.chamber}, open"
    if isinstance(change, GasVolume):
        return f"Volume {change.volume:.6g} {length}3 of {change.chamber}"
    if isinstance(change, GasAmount):
        return (
            f"Gas of {change.volume:.6g} {length}3 at {change.pressure:.6g} {pressure} absolute in {change.chamber}, "
            "closed"
        )
    return f"{change.chamber} closed"
