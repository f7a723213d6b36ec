"""Gas that no chamber can hold: its volume, or its absolute pressure, is not positive."""

from __future__ import annotations

from collections.abc import Iterator

from .check import Check, Verdict
from .states import StageResult
from .told_states import CrushedGasWarning, Remark

ZERO_VOLUME = 1e-9  # volume over the cube of the size of the structure, of a flat chamber by rounding
REMEDY = (
    "Nothing keeps the membranes around it from passing through each other: lower what presses on it, raise its "
    "pressure, or hold them apart by supports."
)


def gas_remarks(result: StageResult) -> Iterator[Remark]:
    """Remarks on chambers with gas whose volume or absolute pressure is not positive."""
    air = result.actions.air
    for name, found in result.chambers.items():
        if name not in result.actions.gas:
            continue
        if found.volume < -ZERO_VOLUME * result.structure.size**3:
            words = f"the volume of chamber {name!r} is {found.volume:.4g}. {REMEDY}"
            yield Remark(words, CrushedGasWarning)
        if air and found.pressure + air.pressure <= 0:
            words = (
                f"the gas in chamber {name!r} is at the absolute pressure {found.pressure + air.pressure:.4g}, which "
                f"no gas has; a pressure cannot be below that around by more than {air.pressure:g}."
            )
            yield Remark(words, CrushedGasWarning)


def gas_checks(result: StageResult, length: str) -> Iterator[Check]:
    """Make checks of the volumes of chambers with gas."""
    told = [remark for remark in result.remarks if remark.category is CrushedGasWarning]
    for name, found in result.chambers.items():
        if name in result.actions.gas:
            words = "; ".join(remark for remark in told if f"chamber {name!r}" in remark)
            volume = f"{found.volume:.4g} {length}3" if length else f"{found.volume:.4g}"
            yield Check(f"volume of gas in {name!r}", volume, "> 0", Verdict.WARN if words else Verdict.PASS, words)
