"""Areas, lengths, normals and slenderness of cells."""

import numpy as np
from numpy.typing import NDArray

# The inverse of the metric of a triangle loses digits as the square of its aspect. About 4 eps aspect^2 of its forces
# is rounding: 9e-4 at 1e6, 0.09 at 1e7, everything at 7e7.
SLIVER = 1.001e7  # aspect of the most slender triangle allowed
SLENDER = 5e5  # aspect with a rounding of 2e-4
FLAT = 1e-10  # height over side that counts as zero


def lengths(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """2-norms of vectors, shape (..., 3) to (...); several times faster than numpy's for many short ones."""
    return np.asarray(np.sqrt(np.einsum("...i,...i", vectors, vectors)))


def measures(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Areas of triangles [m2] or lengths of segments [m], shape (cells,)."""
    if cells.shape[1] == 2:
        return lengths(points[cells[:, 1]] - points[cells[:, 0]])
    return lengths(_area_vectors(points, cells)) / 2


def normals(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return unit normals of triangles, by the right-hand rule from the order of nodes, shape (cells, 3) [-]."""
    area = _area_vectors(points, triangles)
    return area / lengths(area)[:, None]


def _area_vectors(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return normals of length twice the area, shape (cells, 3) [m2]."""
    a, b, c = (points[corner].T for corner in triangles.T)
    return _cross(b - a, c - b).T.copy()


def _cross(a: NDArray[np.float64], b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Cross products of vectors in columns, all of shape (3, n); `np.cross` takes three times as long."""
    (x, y, z), (u, v, w) = a, b
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u])


def projected(vectors: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project vectors on the planes normal to unit normals and scale to length one, all of shape (n, 3) [-].

    Zero where a vector is zero, or normal to its plane up to rounding.
    """
    tangent = vectors - np.sum(vectors * normal, axis=1, keepdims=True) * normal
    length = lengths(tangent)[:, None]
    there = length > 1e-8 * lengths(vectors)[..., None]
    return np.divide(tangent, length, where=there, out=np.zeros_like(tangent))


def degenerate(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.intp]:
    """Triangles more slender than `SLIVER`, segments without length up to rounding, shape (k,)."""
    return np.flatnonzero(aspects(points, cells) > SLIVER)


def aspects(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Aspect of triangles, longest side over the height on it, shape (cells,) [-]; 1 for segments.

    Infinite if height or length are rounding.
    """
    corners = points.T[:, cells.T]  # (component, corner, cell): sums over short last axes are slow
    side = np.roll(corners, -1, axis=1) - corners
    span = np.maximum(np.abs(side).max(axis=(0, 1)), np.finfo(float).tiny)
    side /= span  # avoids overflow and underflow of squares
    longest = height = np.sqrt((side**2).sum(axis=0)).max(axis=0)
    if cells.shape[1] == 3:
        height = np.sqrt((_cross(side[:, 0], side[:, 1]) ** 2).sum(axis=0)) / longest
    rounding = np.maximum(8 * np.finfo(float).eps * np.abs(corners).max(axis=(0, 1)) / span, FLAT)
    return np.divide(longest, height, where=height > rounding, out=np.full(len(cells), np.inf))
