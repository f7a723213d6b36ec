"""Tangents of lines at their nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

CORNER_TURN = 0.6  # difference of the unit vectors of two segments, 35 degrees, above which a line has a corner


def line_tangents(points: NDArray[np.float64], segments: NDArray[np.int64]) -> NDArray[np.float64]:
    """Tangents of lines, of unit length, at their inner nodes, shape (n, 3) [-]; zero at ends, corners and junctions.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        segments: Segments of the lines, each once, shape (k, 2).
    """
    direction = unit(points[segments[:, 1]] - points[segments[:, 0]])
    leaving, last = np.zeros_like(points), np.zeros_like(points)
    for end, away in zip(segments.T, (direction, -direction), strict=True):
        np.add.at(leaving, end, away)
        last[end] = away
    count = np.bincount(segments.ravel(), minlength=len(points))
    slides = (count == 2) & (np.linalg.norm(leaving, axis=1) < CORNER_TURN)
    return np.where(slides[:, None], unit(2 * last - leaving), 0.0)  # one direction less the other


def unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Scale vectors of shape (n, 3) to length one; zero vectors stay zero."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, length, where=length > 0, out=np.zeros_like(vectors))
