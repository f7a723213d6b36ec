"""Stress, warp and place of a membrane on another mesh of the same surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ..geometry.sizes import normals

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FOLD = 0.5  # angle between a cell and the surface at its corners, from which on it is a fold [rad]


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
    count, touch = len(places), _touch(len(places), triangles)
    rings = sparse.coo_array(touch @ touch.T @ touch)
    node, cell = rings.row, rings.col
    offset = _scaled(places[triangles[cell]].mean(axis=1) - places[node], node, count)
    base = np.column_stack([np.ones(len(node)), offset])
    fit = _fitted(node, base, values.reshape(len(values), -1)[cell], count)
    return np.asarray(fit[:, 0].reshape(count, *values.shape[1:]))


def normals_at_nodes(points: Array, triangles: Integers) -> Array:
    """Find unit normals at nodes, of second order, rims included, by paraboloids nearest to two rings of nodes.

    Normals of flat cells are off those of the surface, to first order, which does not cancel at a rim.

    Source:
        F. Cazals, M. Pouget, Estimating differential quantities using polynomial fitting of osculating jets, Computer
        Aided Geometric Design 22 (2005) 121-146.
    """
    count, touch = len(points), _touch(len(points), triangles)
    mean = touch @ normals(points, triangles)
    first = np.linalg.svd(mean[:, None, :])[2]  # normal, and two tangents
    first[:, 0] *= np.where(np.sum(first[:, 0] * mean, axis=1) < 0, -1.0, 1.0)[:, None]
    beside = touch @ touch.T
    rings = sparse.coo_array(beside @ beside)
    node, other = (index[rings.row != rings.col] for index in (rings.row, rings.col))
    offset = _scaled(points[other] - points[node], node, count)
    height, s, t = np.einsum("kxi,ki->xk", first[node], offset)
    slope = _fitted(node, np.column_stack([s, t, s * s, s * t, t * t]), height[:, None], count)[:, :2, 0]
    found = first[:, 0] - np.einsum("ka,kai->ki", slope, first[:, 1:])
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _touch(count: int, triangles: Integers) -> sparse.csr_array:
    """Matrix of ones where a node is a corner of a cell, sparse (count, cells)."""
    ones = np.ones(triangles.size)
    cells = np.repeat(np.arange(len(triangles)), 3)
    return sparse.csr_array((ones, (triangles.ravel(), cells)), shape=(count, len(triangles)))


def _scaled(offset: Array, node: Integers, count: int) -> Array:
    """Offsets from nodes over their root mean square there, shape (k, ...)."""
    square = np.bincount(node, np.sum(offset**2, axis=1), count) / np.maximum(np.bincount(node, minlength=count), 1)
    return np.asarray(offset / np.sqrt(square)[node, None])


def _fitted(node: Integers, base: Array, values: Array, count: int) -> Array:
    """Coefficients of bases nearest to values around each node, shapes (k, b) and (k, v) to (count, b, v)."""
    size = base.shape[1]
    matrix = np.stack([np.bincount(node, a * b, count) for a in base.T for b in base.T], axis=1)
    right = np.stack([np.bincount(node, a * b, count) for a in base.T for b in values.T], axis=1)
    inverse = np.linalg.pinv(matrix.reshape(-1, size, size), rcond=1e-8, hermitian=True)
    return np.asarray(inverse @ right.reshape(count, size, -1))


def between(values: Array, corners: Integers, shares: Array) -> Array:
    """Values at places in cells, from those at their corners, shape (k, ...)."""
    return np.asarray(np.einsum("kc,kc...->k...", shares, values[corners]))


def main_direction(tensors: Array) -> Array:
    """Find unit vectors along the largest principal axis of symmetric tensors, shape (k, 3), in either sense."""
    return np.asarray(np.linalg.eigh(tensors)[1][:, :, -1])


def rise_of_surface(points: Array, triangles: Integers, cells: Integers, shares: Array) -> Array:
    """Vectors from flat cells to the curved surface that they stand for, exact for one of second order, shape (k, 3).

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Cells, shape (cells, 3).
        cells: Cells of the points asked for, shape (k,).
        shares: Shares of their corners, shape (k, 3).

    Source:
        T. Boubekeur, M. Alexa, Phong tessellation, ACM Transactions on Graphics 27 (2008) 141, with half the way to the
        tangent planes, which is exact for paraboloids.
    """
    flat = normals(points, triangles)
    curved = normals_at_nodes(points, triangles)
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
