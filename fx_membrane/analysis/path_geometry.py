"""Lengths and angles along an equilibrium path, and the curve between two of its points.

Displacement and load factor are one vector, with the product a_u . b_u + psi^2 a_f b_f.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from ..solvers.bordered_newton import Plane, Point, Step


class PathState(NamedTuple):
    """Point of a path with the information of its tangent.

    Attributes:
        point: The point.
        direction: Unit direction of the path there, onward.
        turn: Angle between the step from the last point and the direction [rad].
        negative_pivots: Number for the tangent; None if it is not symmetric.
    """

    point: Point
    direction: Step
    turn: float
    negative_pivots: int | None

    def turned(self, here: PathState) -> bool:
        """Return True if the load factor turns between this and another point, by their directions."""
        return self.direction.factor * here.direction.factor < 0


class Metric(NamedTuple):
    """Inner product of steps.

    Attributes:
        psi: Weight of the load factor.
    """

    psi: float

    def product(self, a: Step, b: Step) -> float:
        """Inner product of two steps."""
        return float(a.x.dot(b.x)) + self.psi**2 * a.factor * b.factor

    def length(self, step: Step) -> float:
        """Length of a step."""
        return math.sqrt(self.product(step, step))

    def unit(self, step: Step, backwards: bool = False) -> Step:
        """Scale a step to unit length, or to its negative."""
        scale = (-1 if backwards else 1) / self.length(step)
        x = step.x.copy()
        x.scale(scale)
        return Step(x, scale * step.factor)

    def angle(self, step: Step, direction: Step) -> float:
        """Angle between a step and a direction of unit length [rad]."""
        cosine = self.product(step, direction) / self.length(step)
        return math.acos(min(max(cosine, -1.0), 1.0))

    def across(self, direction: Step, point: Point, length: float = 0.0) -> Plane:
        """Plane across a direction, at a length beyond a point."""
        plane = Plane(direction.x, self.psi**2 * direction.factor, 0.0)
        return plane._replace(distance=plane.signed_distance(point) + length)

    def cubic(self, last: PathState, here: PathState, shares: Iterable[float]) -> list[Point]:
        """Points on the cubic with the directions of the path at both ends (Hermite), at fractions of the step."""
        step = here.point.since(last.point)
        length = self.length(step)
        return [
            last.point.moved(step, share**2 * (3 - 2 * share))
            .moved(last.direction, share * (1 - share) ** 2 * length)
            .moved(here.direction, -(share**2) * (1 - share) * length)
            for share in shares
        ]

    def kink(self, last: PathState, here: PathState, shares: Iterable[float]) -> list[Point]:
        """Points on two straight lines along the directions at both ends, at fractions of each, up to where they meet.

        None if they are parallel or meet elsewhere.
        """
        step = here.point.since(last.point)
        along, back = self.product(step, last.direction), self.product(step, here.direction)
        cosine = self.product(last.direction, here.direction)
        square = max(1 - cosine**2, 1e-12)
        before, after = (along - cosine * back) / square, (back - cosine * along) / square
        if before <= 0 or after <= 0:
            return []
        first = [last.point.moved(last.direction, share * before) for share in shares]
        second = [here.point.moved(here.direction, (share - 1) * after) for share in shares]
        return first + second
