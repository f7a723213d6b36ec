"""Trend of the residuals of an iteration: still falling, or at rest at rounding."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .base import Iteration


@dataclass(frozen=True)
class TrendControl:
    """Limits of progress, fitted on tests/benchmarks/hard_cases.py.

    Attributes:
        fall: Fraction from the median of one quarter of the iterations to that of the next, that counts as progress.
        few: Least number of iterations in a quarter that shows a trend.
        rest: Number of iterations without progress that counts as at rest.
        gain: Fraction of the earlier minimum that counts as progress.
        slow: Ratio of the last two residuals below which they no longer fall: a quadratic end gains more at once.
        small: Multiple of the tolerance below which that residual counts as small; rounding may leave as much.
    """

    fall: float = 0.8
    few: int = 25
    rest: int = 20
    gain: float = 0.5
    slow: float = 10.0
    small: float = 1e3


@dataclass(frozen=True)
class Patience:
    """Length of an attempt as part of all iterations, fitted on tests/benchmarks/hard_cases.py.

    Attributes:
        share: Fraction of all iterations after which an attempt continues only while residuals fall.
        least: Minimum of that number.
        batch: Number of iterations from one look at the residuals to the next.
    """

    share: float = 0.2
    least: int = 50
    batch: int = 50

    def usual(self, total: int) -> int:
        """Return the number of iterations of an attempt before the first look at its residuals."""
        return max(self.least, int(self.share * total))

    def due(self, taken: int, total: int) -> bool:
        """Return True if the residuals are to be looked at after so many iterations."""
        beyond = taken - self.usual(total)
        return beyond >= 0 and beyond % self.batch == 0


TREND = TrendControl()


def nearer(history: Sequence[Iteration], most: int, unknown: bool, control: TrendControl = TREND) -> bool:
    """Return True if residuals still fall, by the medians of the last quarter of `most` iterations and the one before.

    With too few iterations for a trend, return `unknown`.
    """
    quarter = max(most // 4, control.few)
    residuals = [entry.residual for entry in history[-2 * quarter :]]
    return (
        unknown
        if len(residuals) < 2 * quarter
        else bool(np.median(residuals[quarter:]) < control.fall * np.median(residuals[:quarter]))
    )


def at_rest(history: Sequence[Iteration], control: TrendControl = TREND) -> bool:
    """Return True if the last iterations made no progress."""
    before, last = history[: -control.rest], history[-control.rest :]
    return bool(before) and min(entry.residual for entry in last) > control.gain * min(
        entry.residual for entry in before
    )


def stagnant(history: Sequence[Iteration], tolerance: float, control: TrendControl = TREND) -> bool:
    """Return True if the last residual is small and no longer falls, so that rounding keeps it above the tolerance."""
    if len(history) < 3:
        return False
    before, last = history[-2].residual, history[-1].residual
    return before < control.slow * last and last < control.small * tolerance
