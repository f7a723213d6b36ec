"""Check of the path between two of its points: a step must neither jump to another branch nor pass limit points unseen.

Points and directions at both ends give a cubic, which leaves a smooth path by the fourth power of the step; or, where
a cable slackens, two straight lines that meet in a kink. At points of them in between, one iteration with the tangent
of the end tells how far away the path is, and about its load factor there. Curves that leave the path, or a load factor
that turns more often than its ends tell, give the step away. That costs residuals and solutions, but no factorization.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..solvers.bordered_newton import BorderedNewton, Point
from .path_geometry import Arrival, Metric
from .step_control import StepControl

SHARES = (1 / 6, 2 / 6, 3 / 6, 4 / 6, 5 / 6)  # of a step
SMALL = 1e-3  # a change of the load factor below this share of the step is no turn


class Between(NamedTuple):
    """The path between two points, as far as it is known.

    Attributes:
        drift: Largest distance of the curve from the path, as a share of the step.
        turns: How often the load factor turns.
    """

    drift: float
    turns: int


def follows(newton: BorderedNewton, metric: Metric, last: Arrival, here: Arrival, control: StepControl) -> bool:
    """Whether the path between two points is as smooth as its ends tell, or has one kink."""
    turned = last.turned(here)
    smooth = _beside(metric.cubic(last, here, SHARES), newton, metric, last, here)
    if smooth.turns <= turned and smooth.drift <= control.drift and here.turn <= control.sharp:
        return True
    kinked = _beside(metric.kink(last, here, SHARES), newton, metric, last, here)
    return kinked.turns <= turned and kinked.drift <= control.drift


def _beside(guesses: list[Point], newton: BorderedNewton, metric: Metric, last: Arrival, here: Arrival) -> Between:
    """The path between two points beside guesses at it; the tangent that was factored last is that of the second."""
    if not guesses:
        return Between(np.inf, 0)
    step = here.point.since(last.point)
    length, chord = metric.length(step), metric.unit(step)
    drift, factors = 0.0, [last.point.factor]
    for guess in guesses:
        newton.residual(guess.x, guess.factor)
        move = newton.correction(guess, metric.across(chord, guess))
        if move is not None:  # the tangent at the end is not singular
            drift = max(drift, metric.length(move) / length)
            factors.append(guess.factor + move.factor)
    return Between(drift, turns(np.array([*factors, here.point.factor]), SMALL * length / metric.psi))


def turns(values: NDArray[np.float64], small: float) -> int:
    """How often values turn, by more than a small change each time."""
    count, sense, extreme = 0, 0, values[0]
    for value in values[1:]:
        change = value - extreme
        if sense * change > 0 or (not sense and abs(change) > small):
            sense, extreme = sense or int(np.sign(change)), value
        elif sense * change < -small:
            count, sense, extreme = count + 1, -sense, value
    return count
