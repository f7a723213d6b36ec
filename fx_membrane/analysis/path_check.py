"""Check of the path between two of its points: a step must not jump to another branch or miss limit points.

Points and directions at both ends give a cubic. On a smooth path its error is of the fourth power of the step. Where a
cable slackens, two straight lines meet in a kink instead. One iteration with the tangent of the end, at points of these
curves, estimates distance and load factor. A step is rejected if the curve leaves the path, or the load factor turns
more often than shown. That costs residuals and solutions, but no factorization.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..solvers.bordered_newton import BorderedNewton, Point
from .path_geometry import Metric, PathState
from .step_control import StepControl

SHARES = (1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6)  # fractions of a step
SMALL_CHANGE = 1e-3  # a change of the load factor below this fraction of the step is no turn


class Between(NamedTuple):
    """Estimate of the path between two points.

    Attributes:
        drift: Largest distance of the curve from the path, as a fraction of the step.
        turns: Number of turns of the load factor.
    """

    drift: float
    turns: int


def follows(newton: BorderedNewton, metric: Metric, last: PathState, here: PathState, control: StepControl) -> bool:
    """Return True if the path between two points is as smooth as its ends show, or has one kink."""
    turned = last.turned(here)
    smooth = _beside(metric.cubic(last, here, SHARES), newton, metric, last, here)
    if smooth.turns <= turned and smooth.drift <= control.drift and here.turn <= control.sharp:
        return True
    kinked = _beside(metric.kink(last, here, SHARES), newton, metric, last, here)
    return kinked.turns <= turned and kinked.drift <= control.drift


def _beside(guesses: list[Point], newton: BorderedNewton, metric: Metric, last: PathState, here: PathState) -> Between:
    """Estimate the path between two points from guesses, with the tangent of the second, factored last."""
    if not guesses:
        return Between(np.inf, 0)
    step = here.point.since(last.point)
    length, chord = metric.length(step), metric.unit(step)
    drift, factors = 0.0, [last.point.factor]
    for guess in guesses:
        newton.residual(guess.x, guess.factor)
        move = newton.correction(guess, metric.across(chord, guess))
        if move is not None:  # the tangent at the end is regular
            drift = max(drift, metric.length(move) / length)
            factors.append(guess.factor + move.factor)
    return Between(drift, turns(np.array([*factors, here.point.factor]), SMALL_CHANGE * length / metric.psi))


def turns(values: NDArray[np.float64], small: float) -> int:
    """Count the turns of a sequence of values, ignoring small changes."""
    count, sense, extreme = 0, 0, values[0]
    for value in values[1:]:
        change = value - extreme
        if sense * change > 0 or (not sense and abs(change) > small):
            sense, extreme = sense or int(np.sign(change)), value
        elif sense * change < -small:
            count, sense, extreme = count + 1, -sense, value
    return count
