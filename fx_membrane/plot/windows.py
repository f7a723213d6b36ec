"""Windows of pictures: the part of the plane of the screen that is seen, at a scale that is known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

LONGER = 1200  # [pixels]
MIN_SIDE_RATIO = 0.25  # least ratio of the sides
WINDOW_MARGIN = 0.02  # over the longer side


class Window(NamedTuple):
    """A rectangle of the plane across a view, without perspective.

    Attributes:
        view: Unit vector to the eye, shape (3,).
        axes: Right and up, shape (2, 3).
        low: Left and lower bound along these, shape (2,) [m].
        high: Right and upper bound, shape (2,) [m].
        depth: Least and largest extent along the view, shape (2,) [m].
        longer: Longer side [pixels].
    """

    view: Array
    axes: Array
    low: Array
    high: Array
    depth: Array
    longer: int

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, lower and upper bound [m]."""
        return float(self.low[0]), float(self.high[0]), float(self.low[1]), float(self.high[1])

    @property
    def size(self) -> float:
        """Longer side [m]."""
        return float((self.high - self.low).max())

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height."""
        sides = np.round(self.longer * (self.high - self.low) / self.size).astype(int)
        return int(sides[0]), int(sides[1])

    def seen(self, points: Array) -> Array:
        """Places of points on the screen, shape (k, 2) [m]."""
        return np.asarray(points @ self.axes.T)


def window_of(shapes: Sequence[Array], view: ArrayLike) -> Window:
    """Window with some sets of points, each of shape (n, 3), seen from a direction."""
    eye = np.asarray(view, dtype=np.float64)
    eye = eye / np.linalg.norm(eye)
    axes = screen_axes(eye)
    seen = np.concatenate(shapes) @ np.vstack([axes, eye]).T
    low, high = seen.min(axis=0), seen.max(axis=0)
    longer = float((high - low).max())
    half = np.maximum((high - low)[:2] / 2 + WINDOW_MARGIN * longer, MIN_SIDE_RATIO * longer / 2)
    middle = (low + high)[:2] / 2
    return Window(eye, axes, middle - half, middle + half, np.array([low[2], high[2]]), LONGER)


def mirrored(points: Array, mirror: str | None) -> list[Array]:
    """Points, and their mirror image about zero of a coordinate if there is one."""
    if mirror is None:
        return [points]
    return [points, points * np.where(np.arange(3) == "xyz".index(mirror), -1.0, 1.0)]


def screen_axes(view: ArrayLike) -> NDArray[np.float64]:
    """Right and up of a picture seen from a direction, shape (2, 3): z points up; from straight above or below, y."""
    eye = np.asarray(view, dtype=np.float64)
    eye = eye / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0] if np.hypot(eye[0], eye[1]) > 1e-9 else [0.0, 1.0, 0.0], eye)
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right)])
