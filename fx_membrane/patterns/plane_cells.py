"""Triangles in the plane: gradients of maps, areas, and how far points may move before a triangle flips."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def sides(places: Array, triangles: Integers) -> Array:
    """Sides of triangles from their first corner, as columns, shape (k, d, 2) [m]."""
    corners = places[triangles]
    return np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=2)


def gradients(shapes: Array) -> Array:
    """Gradients of the linear functions that are one at a corner, shape (k, 3, 2) [1/m].

    Args:
        shapes: Sides of the triangles, as columns, shape (k, 2, 2) [m].
    """
    last = np.linalg.inv(shapes)
    return np.concatenate([-last.sum(axis=1, keepdims=True), last], axis=1)


def orientation(shapes: Array) -> Array:
    """Take determinants, in which equal shapes keep their sign, shape (k,)."""
    return np.asarray(shapes[:, 0, 0] * shapes[:, 1, 1] - shapes[:, 0, 1] * shapes[:, 1, 0])


def step_to_flip(places: Array, step: Array, triangles: Integers) -> float:
    """Largest length of a step before the first triangle has no area; infinite if none flips."""
    D, d = sides(places, triangles), sides(step, triangles)
    c, a = orientation(D), orientation(d)
    b = D[:, 0, 0] * d[:, 1, 1] + d[:, 0, 0] * D[:, 1, 1] - D[:, 0, 1] * d[:, 1, 0] - d[:, 0, 1] * D[:, 1, 0]
    root = b**2 - 4 * a * c
    with np.errstate(divide="ignore", invalid="ignore"):
        q = -(b + np.copysign(np.sqrt(np.where(root >= 0, root, np.nan)), b)) / 2
        ends = np.stack([q / a, c / q])
    ends = np.where(ends > 0, ends, np.inf)  # not a number compares as false
    return float(ends.min())
