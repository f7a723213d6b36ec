"""Stress, warp and place of a membrane on another mesh of the same surface."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..geometry.measures import normals

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FOLD = 0.5  # angle between a cell and the surface at its corners from which on there is a fold, not a curvature [rad]


def at_nodes(places: Array, triangles: Integers, values: Array) -> Array:
    """Values at nodes from those of the cells around, by a linear fit to two rings of them: exact for linear fields.

    Args:
        places: Places of the nodes in a plane, shape (n, 2) [m].
        triangles: Cells, shape (cells, 3).
        values: Values of the cells, at their centres, shape (cells, ...).

    Source:
        O. C. Zienkiewicz, J. Z. Zhu, The superconvergent patch recovery and a posteriori error estimates, Part 1,
        International Journal for Numerical Methods in Engineering 33 (1992) 1331-1364.
    """
    count, cells = len(places), np.arange(len(triangles))
    ones = np.ones(triangles.size, dtype=np.int8)
    touch = sparse.csr_array((ones, (triangles.ravel(), np.repeat(cells, 3))), shape=(count, len(cells)))
    rings = sparse.coo_array(touch @ touch.T @ touch)
    node, cell = rings.row, rings.col
    offset = places[triangles[cell]].mean(axis=1) - places[node]
    offset /= np.sqrt(np.bincount(node, np.sum(offset**2, axis=1), count) / np.bincount(node, minlength=count))[
        node, None
    ]
    base = np.column_stack([np.ones(len(node)), offset])
    table = values.reshape(len(values), -1)
    matrix = np.stack([np.bincount(node, a * b, count) for a in base.T for b in base.T], axis=1).reshape(-1, 3, 3)
    right = np.stack([np.bincount(node, a * b, count) for a in base.T for b in table.T[:, cell]], axis=1)
    fit = np.linalg.pinv(matrix, rcond=1e-8, hermitian=True) @ right.reshape(count, 3, -1)
    return np.asarray(fit[:, 0].reshape(count, *values.shape[1:]))


def between(values: Array, corners: Integers, shares: Array) -> Array:
    """Values at places in cells, from those at their corners, shape (k, ...)."""
    return np.asarray(np.einsum("kc,kc...->k...", shares, values[corners]))


def main_direction(tensors: Array) -> Array:
    """Find unit vectors along the largest principal axis of symmetric tensors, shape (k, 3), in either sense."""
    return np.asarray(np.linalg.eigh(tensors)[1][:, :, -1])


def rise_of_surface(points: Array, triangles: Integers, places: Array, cells: Integers, shares: Array) -> Array:
    """Vectors from flat cells to the curved surface that they stand for, exact for one of second order, shape (k, 3).

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Cells, shape (cells, 3).
        places: Places of the nodes in a plane, shape (n, 2) [m].
        cells: Cells of the points asked for, shape (k,).
        shares: Shares of their corners, shape (k, 3).

    Source:
        T. Boubekeur, M. Alexa, Phong tessellation, ACM Transactions on Graphics 27 (2008) 141, with half the way to the
        tangent planes, which is exact for paraboloids.
    """
    flat = normals(points, triangles)
    curved = at_nodes(places, triangles, flat)
    curved /= np.linalg.norm(curved, axis=1, keepdims=True)
    cosine = np.einsum("cki,ci->ck", curved[triangles], flat).min(axis=1)
    corners = triangles[cells]
    place = between(points, corners, shares)
    height = np.einsum("kci,kci->kc", points[corners] - place[:, None], curved[corners])
    rise = np.einsum("kc,kc,kci->ki", shares, height, curved[corners]) / 2
    return np.where((cosine > np.cos(FOLD))[cells, None], rise, 0.0)


def rise_of_line(points: Array, corners: Integers, shares: Array) -> Array:
    """Vectors from straight segments to the curved line that they stand for, exact for parabolas, shape (k, 3).

    Args:
        points: Places along the line, shape (m, 3) [m]; of a closed one the last is the first.
        corners: Ends of the segments of the points asked for, shape (k, 2).
        shares: Shares of them, shape (k, 2).
    """
    if len(points) < 3:
        return np.zeros((len(corners), 3))
    tangent = _tangents(points)
    offset = between(points, corners, shares)[:, None] - points[corners]
    along = np.einsum("kci,kci->kc", offset, tangent[corners])
    across = along[..., None] * tangent[corners] - offset
    return np.asarray(np.einsum("kc,kci->ki", shares, across) / 2)


def _tangents(points: Array) -> Array:
    """Find unit tangents of a line by parabolas through three of its points, shape (m, 3)."""
    side = np.diff(points, axis=0)
    length = np.linalg.norm(side, axis=1)[:, None]
    if np.array_equal(points[0], points[-1]):
        side, length = np.concatenate([side[-1:], side, side[:1]]), np.concatenate([length[-1:], length, length[:1]])
    slope = side / length
    inner = (slope[:-1] * length[1:] + slope[1:] * length[:-1]) / (length[1:] + length[:-1])
    if len(inner) < len(points):
        inner = np.concatenate([2 * slope[:1] - inner[:1], inner, 2 * slope[-1:] - inner[-1:]])
    return np.asarray(inner / np.linalg.norm(inner, axis=1, keepdims=True))
