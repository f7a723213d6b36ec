"""Backtracking line search by polynomial interpolation, the step length in (0, 1], for Gil (72).

A full step is kept if it lowers the energy enough and does not end on a steep rise. Otherwise the length is found
between zero and one, first by a parabola, then by cubics through energies and slopes.

Source: J. Nocedal, S. J. Wright, Numerical optimization (2006), algorithm 3.6, (3.57)-(3.59). Near the solution
energies differ by rounding only, and slopes decide, as in W. W. Hager, H. Zhang, A new conjugate gradient method with
guaranteed descent and an efficient line search, SIAM J. Optimization 16 (2005) 170-192.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from .base import LIMITS


@dataclass(frozen=True)
class SearchControl:
    """Constants of the search; `decrease` is that of Nocedal and Wright, chapter 3.1.

    Attributes:
        decrease: Minimum fraction of the linearly predicted decrease.
        flatness: Accepted slope at the end, as a fraction of that at the start. It has no source: it was chosen by
            trial on tests/benchmarks/hard_cases.py.
        margin: Fraction of an interval, at both ends, without trials.
        rounding: Rounding of an energy, over that of one sum: cells, loads and prestress are summed one by one.
        shortest: Length of an interval at which the search ends.
    """

    decrease: float = 1e-4
    flatness: float = 0.1
    margin: float = 0.05
    rounding: float = 10.0
    shortest: float = 1e-10


SEARCH = SearchControl()


class Point(NamedTuple):
    """Energy [J] and its derivative by the length [J], at a step length."""

    length: float
    energy: float
    slope: float


def search(along: Callable[[float], Point], rounding: float, flatness: float = SEARCH.flatness) -> float | None:
    """Length of a step along which an energy decreases, Gil (72).

    Args:
        along: Point at a step length; at zero the slope is negative. Energies that are not numbers count as too high.
        rounding: Rounding of energy differences [J].
        flatness: Accepted slope at the end, as a fraction of that at zero; a full step may also end on a descent.

    Returns:
        The length; None if no length lowers the energy.
    """
    start = low = along(0.0)
    trial = high = along(1.0)
    interpolate = _parabola
    while True:
        limit = min(low.energy, start.energy + SEARCH.decrease * trial.length * start.slope) + rounding
        # Written so that an energy that is NaN is too high.
        if not trial.energy <= limit:
            high = trial
        elif abs(trial.slope) <= -flatness * start.slope or (trial.length == 1 and trial.slope < 0):
            return trial.length
        else:  # the minimum lies downhill from the lower end
            high = low if trial.slope * (high.length - low.length) >= 0 else high
            low = trial
        if abs(high.length - low.length) < SEARCH.shortest:
            return low.length or None
        share = (interpolate(low, high) - low.length) / (high.length - low.length)
        share = min(max(share, SEARCH.margin), 1 - SEARCH.margin) if math.isfinite(share) else 0.5
        trial = along(low.length + share * (high.length - low.length))
        interpolate = _cubic


def line(
    problem: LoadedProblem, start: PETSc.Vec, step: PETSc.Vec, first: Point | None = None
) -> Callable[[float], Point]:
    """Energy and slope along a step from a start; first, if known, is the point at the start.

    The slope is the residual along the step. For a pressure without a potential the search finds a zero of the slope,
    as in H. Matthies, G. Strang, Int. J. Numer. Methods Eng. 14 (1979) 1613-1626. The energy, with the work of the
    pressure since the start, is its integral.
    """
    without_potential = problem.work_along(start, step)

    @cache
    def along(length: float) -> Point:
        if first is not None and length == first.length:
            return first
        with problem.discretization.work(2) as (x, b):
            x.waxpy(length, step, start)
            energy = problem.energy_and_residual(x, b)
            slope = float(b.dot(step))
        return Point(length, energy - without_potential(length), slope)

    return along


def rounding(problem: LoadedProblem, first: Point, start: PETSc.Vec, step: PETSc.Vec) -> float:
    """Error of energy differences by rounding along a step [J]: the prestress works over the whole displacement."""
    way = float(start.norm() + step.norm())
    size = abs(first.energy) + problem.integrals.size(start)
    return SEARCH.rounding * LIMITS.rounding * (size + problem.magnitudes.prestress_forces * way)


def step_back(
    problem: LoadedProblem,
    b: PETSc.Vec,
    energy: float | None,
    start: PETSc.Vec,
    dx: PETSc.Vec,
    moved: bool,
) -> float | None:
    """Length of the step -dx from a start that meets the constraints; None if no length is accepted.

    After imposing displacements the step may not descend; then length 0 is allowed.

    Args:
        problem: The problem.
        b: Residual at the start.
        energy: Energy at the start [J]; None if energy and residual there are not those of the problem.
        start: The start.
        dx: The step, reversed.
        moved: True if displacements were imposed at the start; residual and energy are those before.
    """
    with problem.discretization.work(1) as (downhill,):
        dx.copy(downhill)
        downhill.scale(-1.0)
        here = None if moved or energy is None else Point(0.0, energy, float(b.dot(downhill)))
        along = line(problem, start, downhill, here)
        first = along(0.0)
        if moved and first.slope >= 0:
            return 1.0 if along(1.0).energy <= first.energy else 0.0
        length = search(along, rounding(problem, first, start, downhill))
    return 0.0 if length is None and moved else length


def halves(problem: LoadedProblem, b: PETSc.Vec, start: PETSc.Vec, dx: PETSc.Vec) -> bool:
    """Return True if the full step -dx from a start halves the residual, as near the solution; False for NaN.

    Without a potential, a step to the solution need not go down any energy.

    Args:
        problem: The problem.
        b: Residual at the start.
        start: The start, which meets the constraints.
        dx: The step, reversed.
    """
    with problem.discretization.work(2) as (x, rest):
        x.waxpy(-1.0, dx, start)
        problem.residual(x, rest)
        problem.constraints.constrain_residual(x, rest)
        return bool(2 * rest.norm() <= b.norm())


def _parabola(low: Point, high: Point) -> float:
    """Length at the minimum of the parabola through two energies and the slope at the lower end."""
    span = high.length - low.length
    curvature = (high.energy - low.energy - low.slope * span) / span**2
    return low.length - low.slope / (2 * curvature) if curvature > 0 else math.nan


def _cubic(low: Point, high: Point) -> float:
    """Length at the minimum of the cubic through two energies and two slopes, N&W (3.59)."""
    span = high.length - low.length
    d1 = low.slope + high.slope - 3 * (high.energy - low.energy) / span
    radicand = d1 * d1 - low.slope * high.slope  # d1**2 would raise OverflowError
    if not radicand >= 0:
        return _parabola(low, high)
    d2 = math.copysign(math.sqrt(radicand), span)
    divisor = high.slope - low.slope + 2 * d2
    return high.length - span * (high.slope + d2 - d1) / divisor if divisor else math.nan
