"""Shear of membranes without two sides, whose sign in warp/weft axes is that of each cell."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .states import StageResult
from .told_states import Remark

SHEAR_ROUNDING = 1e-9  # shear strain below which it is rounding


class ShearSignWarning(UserWarning):
    """State with shear in the warp/weft axes of a membrane without two sides: its sign is that of each cell."""


def shear_remarks(result: StageResult) -> Iterator[Remark]:
    """Remarks on membranes whose shear has no sign of its own."""
    for name, found in result.membranes.items():
        if result.structure.has_sides(name):
            continue
        largest = float(np.abs(found.strain[:, 0, 1]).max())
        if largest > SHEAR_ROUNDING:
            yield Remark(
                f"part {name!r} has no two sides, and shear strains up to {largest:.3g} along warp and weft, in "
                "`strain` and `second_piola_kirchhoff`. Their sign is that of each cell, by the order of its nodes; "
                "take `cauchy`, `principal` and `warp_weft_stress`, or make each sheet a part of its own.",
                ShearSignWarning,
            )
