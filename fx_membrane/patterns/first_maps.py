"""First flat shape of strips: conformal or by Tutte's embedding, then brought near to isometry without a flipped cell.

Source: M. Rabinovich, R. Poranne, D. Panozzo, O. Sorkine-Hornung, Scalable locally injective mappings, ACM Transactions
on Graphics 36 (2017) 16:1-16:16, with the symmetric Dirichlet energy; W. T. Tutte, How to draw a graph, Proceedings of
the London Mathematical Society 13 (1963) 743-767.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ..surfaces.flattening import flattened
from .pieces import Pieces, _around
from .plane_cells import gradients, orientation, step_to_flip

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_STEPS = 60
SETTLED_DECREASE = 1e-4  # relative decrease of the energy that ends the steps
ISOMETRY = 4.0  # symmetric Dirichlet energy of an isometry per area


def first_map(points: Array, shapes: Array, pieces: Pieces) -> Array:
    """Places in the plane of all points of all strips, no cell of them flipped, shape (n, 2) [m].

    Args:
        points: Points on the surface, shape (n, 3) [m].
        shapes: Sides of the cells in their frames, as columns, shape (k, 2, 2) [m].
        pieces: The strips.
    """
    places = np.empty((len(points), 2))
    for strip in range(len(pieces.names)):
        rows, cells = pieces.points_of(strip), pieces.cells_of(strip)
        triangles = pieces.triangles[cells] - rows.start
        flat = flattened(points[rows], triangles)
        mine = (pieces.border[:, 0] >= rows.start) & (pieces.border[:, 0] < rows.stop)
        places[rows] = (
            _embedded(points[rows], triangles, pieces.border[mine] - rows.start) if flat is None else flat.points
        )
    return _nearly_isometric(places, shapes, pieces.triangles)


def _embedded(points: Array, triangles: Integers, border: Integers) -> Array:
    """Tutte's embedding in a circle of the same area, shape (n, 2)."""
    ring = _around(border)
    length = np.linalg.norm(points[np.roll(ring, -1)] - points[ring], axis=1)
    angle = 2 * np.pi * (np.cumsum(length) - length) / length.sum()
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    radius = np.sqrt(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 / np.pi)
    places = np.zeros((len(points), 2))
    places[ring] = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    pairs = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    graph = sparse.coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(len(points),) * 2).tocsr()
    graph = graph + graph.T
    graph.data[:] = 1.0
    laplace = sparse.csc_matrix(sparse.diags(np.asarray(graph.sum(axis=1)).ravel()) - graph)
    free = np.setdiff1d(np.arange(len(points)), ring)
    if len(free):
        places[free] = splu(laplace[free][:, free]).solve(-(laplace[free][:, ring] @ places[ring]))
    return places


def _nearly_isometric(places: Array, shapes: Array, triangles: Integers) -> Array:
    """Lower the symmetric Dirichlet energy by reweighted least squares, each step short of the first flip."""
    slopes, area = gradients(shapes), np.linalg.det(shapes) / 2
    energy = _energy(places, slopes, area, triangles)
    for _ in range(MOST_STEPS):
        before = energy
        step = _towards_rotations(places, slopes, area, triangles) - places
        length = min(1.0, 0.8 * step_to_flip(places, step, triangles))
        while length > 1e-8 and not _energy(places + length * step, slopes, area, triangles) < energy:
            length /= 2
        if length <= 1e-8:
            break
        places = places + length * step
        energy = _energy(places, slopes, area, triangles)
        excess = energy - ISOMETRY * area.sum()
        if before - energy < SETTLED_DECREASE * excess or excess < 1e-13 * energy:
            break
    return places


def _energy(places: Array, slopes: Array, area: Array, triangles: Integers) -> float:
    J = np.einsum("kvi,kvj->kij", places[triangles], slopes)
    det = orientation(J)
    if not (det > 0).all():
        return np.inf
    return float((area * (J**2).sum(axis=(1, 2)) * (1 + 1 / det**2)).sum())


def _towards_rotations(places: Array, slopes: Array, area: Array, triangles: Integers) -> Array:
    """Least squares of the proxy: cells near to their rotations, weighted by the slope of the energy."""
    J = np.einsum("kvi,kvj->kij", places[triangles], slopes)
    U, s, Vt = np.linalg.svd(J)
    weights = (s + 1) * (s**2 + 1) / s**3
    W = np.einsum("kia,ka,kja->kij", U, weights, U) * area[:, None, None]
    local = np.einsum("kij,kvg,kwg->kviwj", W, slopes, slopes)
    pull = np.einsum("kij,kjg,kvg->kvi", W, U @ Vt, slopes)
    dofs = (2 * triangles[:, :, None] + np.arange(2)).reshape(len(triangles), 6)
    rows, columns = np.repeat(dofs, 6, axis=1).ravel(), np.tile(dofs, (1, 6)).ravel()
    size = places.size
    matrix = sparse.coo_array((local.ravel(), (rows, columns)), shape=(size, size)).tocsc()
    drag = 1e-6 * matrix.diagonal().mean()  # holds the place of the strips
    right = np.bincount(dofs.ravel(), pull.ravel(), size) + drag * places.ravel()
    solved = splu(sparse.csc_matrix(matrix + drag * sparse.identity(size)), permc_spec="MMD_AT_PLUS_A")
    return np.asarray(solved.solve(right).reshape(-1, 2))
