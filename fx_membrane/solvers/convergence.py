"""How the residuals of an iteration go on: whether they still fall, or have come to rest on rounding."""

from collections.abc import Sequence

import numpy as np

from .base import Iteration

# The numbers have no source: they were chosen by trial on tests/benchmarks/hard_cases.py.

FALL = 0.8  # from the middle of one quarter of the iterations to that of the next, which counts as coming nearer
FEW = 25  # iterations are too few to tell
REST = 20  # iterations in which nothing is gained, at rest
GAIN = 0.5  # of the least residual before


def nearer(history: Sequence[Iteration], most: int, unknown: bool) -> bool:
    """Whether residuals still fall, by the middle ones of the last quarter of so many iterations and that before.

    Where these are too few to tell, it is unknown.
    """
    quarter = max(most // 4, FEW)
    residuals = [entry.residual for entry in history[-2 * quarter :]]
    return (
        unknown
        if len(residuals) < 2 * quarter
        else bool(np.median(residuals[quarter:]) < FALL * np.median(residuals[:quarter]))
    )


def at_rest(history: Sequence[Iteration]) -> bool:
    """Whether the last iterations have brought nothing."""
    before, last = history[:-REST], history[-REST:]
    return bool(before) and min(entry.residual for entry in last) > GAIN * min(entry.residual for entry in before)
