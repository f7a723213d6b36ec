"""Vectors in columns, shape (3, ..., n): numpy's sums and products over short last axes are slow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NORMAL = 1e-8  # tangent over vector, below which the vector counts as normal to its plane


def dot(a: Array, b: Array) -> Array:
    """Scalar products of vectors, shape (..., n)."""
    return np.asarray(np.einsum("i...,i...->...", a, b))


def lengths(vectors: Array) -> Array:
    """2-norms of vectors, shape (..., n)."""
    return np.asarray(np.sqrt(dot(vectors, vectors)))


def cross(a: Array, b: Array) -> Array:
    """Cross products of vectors; `np.cross` takes three times as long."""
    (x, y, z), (u, v, w) = a, b
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u])


def projected(vectors: Array, normal: Array) -> Array:
    """Project vectors on the planes normal to unit normals and scale to length one [-].

    Zero where a vector is zero, or normal to its plane up to rounding.
    """
    tangent = vectors - dot(vectors, normal) * normal
    length = lengths(tangent)
    there = length > NORMAL * lengths(vectors)
    return np.divide(tangent, length, where=there, out=np.zeros_like(tangent))


def columns(corners: Array) -> Array:
    """Put the cells last, shape (cells, nodes, 3) to (nodes, 3, cells)."""
    return np.ascontiguousarray(np.moveaxis(corners, 0, -1))


def rows(corners: Array) -> Array:
    """Put the cells first, shape (nodes, 3, cells) to (cells, nodes, 3)."""
    return np.moveaxis(corners, -1, 0)


def over_copies(vectors: Array, copies: Array) -> Array:
    """Let vectors of cells, shape (3, n), be those of all their copies, shape (3, ..., n)."""
    return vectors.reshape(3, *[1] * (copies.ndim - 2), vectors.shape[-1])
