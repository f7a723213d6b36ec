"""Areas, lengths, normals and slenderness of cells."""

import numpy as np
from numpy.typing import NDArray

# The inverse of the metric of a triangle loses digits as the square of its aspect. About 4 eps aspect^2 of its forces
# is
# rounding: 9e-4 at 1e6, 0.09 at 1e7, everything at 7e7.
SLIVER = 1.001e7  # aspect of the most slender triangle allowed
SLENDER = 5e5  # aspect with a rounding of 2e-4
FLAT = 1e-10  # height over side that counts as zero


def measures(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Areas of triangles [m2] or lengths of segments [m], shape (cells,)."""
    if cells.shape[1] == 2:
        return np.asarray(np.linalg.norm(points[cells[:, 1]] - points[cells[:, 0]], axis=1))
    return np.asarray(np.linalg.norm(_area_vectors(points, cells), axis=1) / 2)


def normals(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return unit normals of triangles, by the right-hand rule from the order of nodes, shape (cells, 3) [-]."""
    area = _area_vectors(points, triangles)
    return np.asarray(area / np.linalg.norm(area, axis=1, keepdims=True))


def _area_vectors(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return normals of length twice the area, shape (cells, 3) [m2]; `np.cross` takes three times as long."""
    a, b, c = (points[corner].T for corner in triangles.T)
    (x, y, z), (u, v, w) = b - a, c - b
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=1)


def projected(vectors: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project vectors on the planes normal to unit normals and scale to length one, all of shape (n, 3) [-].

    Zero where a vector is zero, or normal to its plane up to rounding.
    """
    tangent = vectors - np.sum(vectors * normal, axis=1, keepdims=True) * normal
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    there = length > 1e-8 * np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(tangent, length, where=there, out=np.zeros_like(tangent))


def degenerate(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.intp]:
    """Triangles more slender than `SLIVER`, segments without length up to rounding, shape (k,)."""
    return np.flatnonzero(aspects(points, cells) > SLIVER)


def aspects(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Aspect of triangles, longest side over the height on it, shape (cells,) [-]; 1 for segments.

    Infinite if height or length are rounding.
    """
    corners = points[cells]
    side = np.roll(corners, -1, axis=1) - corners
    span = np.maximum(np.abs(side).max(axis=(1, 2)), np.finfo(float).tiny)
    side = side / span[:, None, None]  # avoids overflow and underflow of squares
    longest = np.linalg.norm(side, axis=2).max(axis=1)
    height = longest if cells.shape[1] == 2 else np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1) / longest
    rounding = np.maximum(8 * np.finfo(float).eps * np.abs(corners).max(axis=(1, 2)) / span, FLAT)
    return np.divide(longest, height, where=height > rounding, out=np.full(len(cells), np.inf))
