"""Heights of free nodes of a plan, from those of the others."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]


def cotangent_matrix(corners: Array, triangles: NDArray[np.int64], count: int) -> sparse.csc_array:
    """Matrix of the Laplace operator on triangles in the plane or in space, shape (count, count) [-].

    Args:
        corners: Positions of the corners of each triangle, shape (cells, 3, 2 or 3).
        triangles: Their nodes, shape (cells, 3).
        count: Number of nodes.

    Source:
        U. Pinkall, K. Polthier, Computing discrete minimal surfaces and their conjugates, Experimental Mathematics 2
        (1993) 15-36.
    """
    sides = np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1)  # opposite to each corner
    products = np.einsum("cix,cjx->cij", sides, sides)
    twice = np.sqrt(np.maximum(products[:, 0, 0] * products[:, 1, 1] - products[:, 0, 1] ** 2, np.finfo(float).tiny))
    rows, columns = np.repeat(triangles, 3, axis=1).ravel(), np.tile(triangles, (1, 3)).ravel()
    values = (products / (2 * twice[:, None, None])).ravel()
    return sparse.csc_array(sparse.coo_matrix((values, (rows, columns)), shape=(count, count)))


def harmonic(points: Array, triangles: NDArray[np.int64], values: Array) -> Array:
    """Fill nodal values that are NaN: the flattest surface over the plan that the others allow.

    Args:
        points: Positions, shape (n, 2 or 3) [m].
        triangles: Cells, shape (cells, 3).
        values: Values at the nodes, shape (n,) or (n, k).
    """
    table = values.reshape(len(values), -1).copy()
    free = np.isnan(table).any(axis=1)
    if free.any():
        matrix = cotangent_matrix(points[triangles], triangles, len(points))
        right = -(matrix[free][:, ~free] @ table[~free])
        table[free] = splu(sparse.csc_matrix(matrix[free][:, free])).solve(right)
    return table.reshape(values.shape)
