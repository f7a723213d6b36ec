"""Straight lines, arcs and circles in a plan."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Path(NamedTuple):
    """Straight line, or part of a circle, with a parameter from 0 to 1 in proportion to its length.

    Attributes:
        start: Its first point, shape (2,) [m].
        end: Its last point, shape (2,) [m].
        centre: Centre of its circle, shape (2,) [m]; of no use for a straight line.
        first: Angle of its first point about the centre [rad].
        sweep: Angle from there to the last one, counter-clockwise [rad]; zero for a straight line.
    """

    start: Array
    end: Array
    centre: Array
    first: float = 0.0
    sweep: float = 0.0

    @property
    def radius(self) -> float:
        """Radius of the circle [m]."""
        return float(np.linalg.norm(self.start - self.centre))

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(abs(self.sweep) * self.radius if self.sweep else np.linalg.norm(self.end - self.start))

    def at(self, t: Array) -> Array:
        """Points at some parameters, shape (k, 2) [m]."""
        if not self.sweep:
            return np.asarray(self.start + t[:, None] * (self.end - self.start))
        angle = self.first + t * self.sweep
        found = self.centre + self.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        found[t == 0], found[t == 1] = self.start, self.end
        return found

    def nearest(self, points: Array) -> tuple[Array, Array]:
        """Parameters of points on the path, or on its continuation, and distances from it, both of shape (n,)."""
        if not self.sweep:
            along = self.end - self.start
            offset = points - self.start
            t = offset @ along / (along @ along)
            return t, np.linalg.norm(offset - t[:, None] * along, axis=1)
        offset = points - self.centre
        middle = self.first + self.sweep / 2
        angle = np.arctan2(offset[:, 1], offset[:, 0]) - middle
        angle = (angle + np.pi) % (2 * np.pi) - np.pi  # from the middle, so that the jump is opposite
        return angle / self.sweep + 0.5, np.abs(np.linalg.norm(offset, axis=1) - self.radius)


def straight(start: Array, end: Array) -> Path:
    """Straight line."""
    return Path(start, end, start)


def arc(start: Array, end: Array, sag: float) -> Path:
    """Arc to the left of its chord.

    Args:
        start: Its first point, shape (2,) [m].
        end: Its last point, shape (2,) [m].
        sag: Its rise over its chord, to the right if negative [-].
    """
    if not sag:
        return straight(start, end)
    chord = end - start
    left = np.array([-chord[1], chord[0]])
    centre = (start + end) / 2 + left * (sag - (0.25 + sag**2) / (2 * sag))
    offset = start - centre
    return Path(start, end, centre, float(np.arctan2(offset[1], offset[0])), -4.0 * float(np.arctan(2 * sag)))


def circle(centre: Array, radius: float) -> Path:
    """Circle, counter-clockwise from the direction x."""
    start = centre + np.array([radius, 0.0])
    return Path(start, start, centre, 0.0, 2 * np.pi)
