"""Trend of the residuals of an iteration: still falling, or at rest at rounding."""

from collections.abc import Sequence

import numpy as np

from .base import Iteration

# The numbers have no source: they were chosen by trial on tests/benchmarks/hard_cases.py.

FALL = 0.8  # fraction from the median of one quarter of the iterations to that of the next, that counts as progress
FEW = 25  # too few iterations for a trend
REST = 20  # number of iterations without progress that counts as at rest
GAIN = 0.5  # fraction of the earlier minimum that counts as progress


def nearer(history: Sequence[Iteration], most: int, unknown: bool) -> bool:
    """Return True if residuals still fall, by the medians of the last quarter of `most` iterations and the one before.

    With too few iterations for a trend, return `unknown`.
    """
    quarter = max(most // 4, FEW)
    residuals = [entry.residual for entry in history[-2 * quarter :]]
    return (
        unknown
        if len(residuals) < 2 * quarter
        else bool(np.median(residuals[quarter:]) < FALL * np.median(residuals[:quarter]))
    )


def at_rest(history: Sequence[Iteration]) -> bool:
    """Return True if the last iterations made no progress."""
    before, last = history[:-REST], history[-REST:]
    return bool(before) and min(entry.residual for entry in last) > GAIN * min(entry.residual for entry in before)
