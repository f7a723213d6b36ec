"""Steps along an equilibrium path: to the next point, and to a limit point between two."""

from __future__ import annotations

from contextlib import suppress

from scipy.optimize import brentq

from ..solvers.bordered_newton import BorderedNewton, Point, Step
from . import path_check
from .path_geometry import Metric, PathState
from .step_control import StepControl


class _LostError(ArithmeticError):
    """Failure to find a point of the path at a length."""


class Walk:
    """Steps along a path."""

    def __init__(self, newton: BorderedNewton, metric: Metric, control: StepControl):
        self.newton, self.metric, self.control = newton, metric, control

    def find(self, last: PathState, length: float) -> Point | None:
        """Find the point at a length from another, or None."""
        guess = last.point.moved(last.direction, length)
        return self.newton.find(guess, self.metric.across(last.direction, last.point, length))

    def arrive(self, last: PathState, point: Point) -> PathState:
        """Continue the path at a point that follows another."""
        step = point.since(last.point)
        onward = self.direction(step) if self.newton.linearize(point.x, point.factor) else self.metric.unit(step)
        return PathState(point, onward, self.metric.angle(step, onward), self.newton.negative_pivots())

    def direction(self, step: Step) -> Step:
        """Tangent of the path, of unit length, in the sense of a step."""
        tangent = Step(self.newton.du_load, 1.0)
        return self.metric.unit(tangent, backwards=self.metric.product(tangent, step) < 0)

    def limit_point(self, last: PathState, here: PathState) -> PathState | None:
        """Find the point between two at which the load factor turns, or None.

        At a kink of the path, it is the point with the most extreme load factor.
        """
        steepest = max(abs(last.direction.factor), abs(here.direction.factor))
        end = self.metric.product(last.direction, here.point.since(last.point))
        found: list[PathState] = []

        def slope(length: float) -> float:
            if length in (0.0, end):
                return (here if length else last).direction.factor
            point = self.find(last, length)
            if point is None:
                raise _LostError
            found.append(self.arrive(last, point))
            factor = found[-1].direction.factor
            return 0.0 if self.metric.psi * abs(factor) <= self.control.flat else factor

        near = self.control.exact * max(abs(last.point.factor), abs(here.point.factor)) / steepest
        near = min(max(near, 1e-12 * end), 1e-2 * end)
        with suppress(_LostError):
            brentq(slope, 0.0, end, xtol=near, rtol=1e-12, maxiter=self.control.search, disp=False)
        return _farthest(found, last)

    def without_compression(self, last: PathState, limit: PathState, here: PathState) -> PathState | None:
        """Find a limit point between two points again, with almost no stiffness of wrinkled and slack cells.

        None if there are none, or if no point was found.
        """
        newton = self.newton.without_compression_stiffness(self.control.compression_stiffness)
        walk = Walk(newton, self.metric, self.control)
        if newton.residual(limit.point.x, limit.point.factor):
            return None
        point = walk.find(limit, 0.0)
        if point is None:
            return None
        beside = walk.arrive(limit, point)
        if last.turned(beside):  # it lies before
            beside = beside._replace(direction=self.metric.unit(beside.direction, backwards=True))
        length = self.metric.length(here.point.since(last.point)) / 4
        for _ in range(self.control.search):
            point = walk.find(beside, length)
            onward = point and walk.arrive(beside, point)
            if not onward or not path_check.follows(newton, self.metric, beside, onward, self.control):
                length /= 2
                continue
            if beside.turned(onward):
                return walk.limit_point(beside, onward)
            beside = onward
        return None


def _farthest(found: list[PathState], last: PathState) -> PathState | None:
    """Point with the farthest load factor in its sense at an earlier point; None of an empty list."""
    sense = 1 if last.direction.factor > 0 else -1
    return max(found, key=lambda arrival: sense * arrival.point.factor, default=None)
