"""Areas, lengths, normals and slenderness of cells."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from . import vector_columns

# The inverse of the metric of a triangle loses digits as the square of its aspect. About 4 eps aspect^2 of its forces
# is rounding: 9e-4 at 1e6, 0.09 at 1e7, everything at 7e7.
SLIVER = 1.001e7  # aspect of the most slender triangle allowed
SLENDER = 5e5  # aspect with a rounding of 2e-4
ZERO_HEIGHT = 1e-10  # height over side that counts as zero


def lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """2-norms of vectors, shape (..., 3) to (...); several times faster than numpy's for many short ones."""
    return np.asarray(np.sqrt(np.einsum("...i,...i", vectors, vectors)))


def measures(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Areas of triangles [m2] or lengths of segments [m], shape (cells,)."""
    if cells.shape[1] == 2:
        a, b = _corners(points, cells)
        return vector_columns.lengths(b - a)
    return vector_columns.lengths(_area_vectors(points, cells)) / 2


def normals(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return unit normals of triangles, by the right-hand rule from the order of nodes, shape (cells, 3) [-]."""
    area = _area_vectors(points, triangles)
    return np.ascontiguousarray((area / vector_columns.lengths(area)).T)


def _corners(points: NDArray[np.float64], cells: NDArray[np.int64]) -> list[NDArray[np.float64]]:
    """Positions of each corner of the cells, in columns, shape (3, cells): sums over short last axes are slow [m]."""
    columns = np.ascontiguousarray(points.T)
    return [columns.take(corner, axis=1) for corner in cells.T]


def _area_vectors(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return normals of length twice the area, in columns, shape (3, cells) [m2]."""
    a, b, c = _corners(points, triangles)
    return vector_columns.cross(b - a, c - b)


def projected(vectors: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project vectors on the planes normal to unit normals and scale to length one, all of shape (n, 3) [-].

    Zero where a vector is zero, or normal to its plane up to rounding.
    """
    return np.ascontiguousarray(vector_columns.projected(vectors.T, normal.T).T)


def degenerate(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.intp]:
    """Triangles more slender than `SLIVER`, segments without length up to rounding, shape (k,)."""
    return np.flatnonzero(aspects(points, cells) > SLIVER)


def grown_slender(
    points: NDArray[np.float64], cells: NDArray[np.int64], first: NDArray[np.float64]
) -> NDArray[np.intp]:
    """Triangles more slender than `SLENDER`, and than ten times those of a first shape, shape (k,).

    A stress there has no digits for a balance; its area need not be small beside the first one.
    """
    return np.flatnonzero(aspects(points, cells) > np.clip(10 * aspects(first, cells), SLENDER, SLIVER))


def aspects(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Aspect of triangles, longest side over the height on it, shape (cells,) [-]; 1 for segments.

    Infinite if height or length are rounding.
    """
    corners = _corners(points, cells)
    largest = np.abs(corners).max(axis=(0, 1))
    scale = max(float(largest.max()), float(np.finfo(float).tiny))  # avoids overflow and underflow of squares
    round_about = corners if cells.shape[1] == 2 else [*corners, corners[0]]
    sides = [(b - a) / scale for a, b in pairwise(round_about)]
    longest = height = np.maximum.reduce([vector_columns.lengths(side) for side in sides])
    if cells.shape[1] == 3:
        area = vector_columns.lengths(vector_columns.cross(sides[0], sides[1]))
        height = np.divide(area, longest, where=longest > 0, out=np.zeros_like(area))
    rounding = np.maximum(8 * np.finfo(float).eps * largest / scale, ZERO_HEIGHT * longest)
    return np.divide(longest, height, where=height > rounding, out=np.full(len(cells), np.inf))
