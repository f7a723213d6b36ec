"""Conformal maps of surfaces into a plane, and places in that plane."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from ..geometry.topology import boundary_edges
from .lifting import cotangent_matrix
from .plan_checks import crossing

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CANDIDATES = (12, 200)  # nearest cells in which a point is looked for
TOUCHING_DISTANCE = 1e-12  # distance over the size of a plan that counts as touching
ZERO_AREA_RATIO = 1e-6  # area in the plane over that in space that counts as none
AS_FAR = 1e-9  # difference of distances, relative to them, that rounding may make
OUTSIDE_SHARE = 0.05  # share of a cell by which a point may lie outside before more cells are tried


class Flat(NamedTuple):
    """Surface in a plane.

    Attributes:
        points: Places of the nodes, shape (n, 2) [m].
        triangles: Cells, counter-clockwise, shape (cells, 3).
        scale: Lengths in the plane over those in space, at the nodes, shape (n,) [-].
    """

    points: Array
    triangles: Integers
    scale: Array

    def locate(self, places: Array) -> tuple[Integers, Array]:
        """Cells of places, shape (k,), and their shares of its corners, shape (k, 3); outside, of a cell beside."""
        centres = cKDTree(self.points[self.triangles].mean(axis=1))
        cell, shares = np.zeros(len(places), dtype=np.int64), np.full((len(places), 3), -np.inf)
        for count in CANDIDATES:
            left = np.flatnonzero(shares.min(axis=1) < -OUTSIDE_SHARE)
            if not len(left):
                break
            near = centres.query(places[left], k=min(count, len(self.triangles)))[1].reshape(len(left), -1)
            found = self._shares(near, places[left])
            best = found.min(axis=2).argmax(axis=1)
            rows = np.arange(len(left))
            cell[left], shares[left] = near[rows, best], found[rows, best]
        return cell, shares

    def _shares(self, cells: Integers, places: Array) -> Array:
        """Barycentric coordinates of places in cells, shape (k, cells, 3)."""
        a, b, c = np.moveaxis(self.points[self.triangles[cells]], 2, 0)
        p = places[:, None, :]
        whole = _cross(b - a, c - a)
        second, third = _cross(p - a, c - a) / whole, _cross(b - a, p - a) / whole
        return np.stack([1 - second - third, second, third], axis=2)


def _cross(u: Array, v: Array) -> Array:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def flattened(points: Array, triangles: Integers) -> Flat | None:
    """Map a connected surface with a rim into a plane, with angles kept as well as possible; None where it folds.

    Source:
        B. Lévy, S. Petitjean, N. Ray, J. Maillot, Least squares conformal maps for automatic texture atlas generation,
        ACM Transactions on Graphics 21 (2002) 362-371; in the form of Dirichlet energy minus area of P. Mullen, Y.
        Tong, P. Alliez, M. Desbrun, Spectral conformal parameterization, Computer Graphics Forum 27 (2008) 1487-1494.
    """
    area = np.linalg.norm(_area_vectors(points, triangles), axis=1)
    for places in (_conformal(points, triangles), _projected(points, triangles)):
        a, b, c = np.moveaxis(places[triangles], 1, 0)
        twice = _cross(b - a, c - a)
        touching = TOUCHING_DISTANCE * float(np.ptp(places, axis=0).max())
        if (twice > ZERO_AREA_RATIO * area).all() and crossing(places, boundary_edges(triangles), touching) is None:
            factor = np.sqrt(area.sum() / twice.sum())  # the whole has its area
            stretch = np.bincount(triangles.ravel(), np.repeat(np.sqrt(twice / area), 3) * factor, len(points))
            return Flat(places * factor, triangles, stretch / np.bincount(triangles.ravel(), minlength=len(points)))
    return None


def _area_vectors(points: Array, triangles: Integers) -> Array:
    a, b, c = (points[corner] for corner in triangles.T)
    return np.cross(b - a, c - a)


def _projected(points: Array, triangles: Integers) -> Array:
    """Project on the plane of the mean normal, shape (n, 2)."""
    normal = _area_vectors(points, triangles).sum(axis=0)
    normal /= max(float(np.linalg.norm(normal)), np.finfo(float).tiny)
    first = np.linalg.svd(normal[None, :])[2][1]
    return np.asarray(points @ np.stack([first, np.cross(normal, first)], axis=1))


def _capped(points: Array, triangles: Integers) -> tuple[Array, Integers]:
    """Close the loops of the rim, but for the longest, by fans of triangles: a surface with holes could fold."""
    rim = boundary_edges(triangles)
    ends = sparse.coo_array((np.ones(len(rim)), (rim[:, 0], rim[:, 1])), shape=(len(points),) * 2)
    loop = np.unique(connected_components(ends, directed=False)[1][rim[:, 0]], return_inverse=True)[1].ravel()
    length = np.bincount(loop, np.linalg.norm(points[rim[:, 1]] - points[rim[:, 0]], axis=1))
    order = np.argsort(-length)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.arange(len(order))
    inner = number[loop] > 0
    sums = np.stack([np.bincount(loop, column) for column in points[rim[:, 0]].T], axis=1)
    centres = (sums / np.bincount(loop)[:, None])[order[1:]]
    fans = np.column_stack([rim[inner][:, ::-1], len(points) + number[loop[inner]] - 1])
    return np.vstack([points, centres]), np.vstack([triangles, fans])


def _conformal(points: Array, triangles: Integers) -> Array:
    """Least squares conformal map with two nodes of the rim held, shape (n, 2)."""
    count = len(points)
    points, triangles = _capped(points, triangles)
    n = len(points)
    laplace = cotangent_matrix(points[triangles], triangles, n)
    a, b = boundary_edges(triangles).T
    area = sparse.coo_array((np.full(2 * len(a), 0.5) * np.repeat([1, -1], len(a)), (np.r_[a, b], np.r_[b, a])), (n, n))
    matrix = sparse.csc_matrix(sparse.bmat([[laplace, -area], [area, laplace]]))
    rim = np.sort(a)
    first = _farthest(points, rim, points[rim].mean(axis=0))
    second = _farthest(points, rim, points[first])
    held = np.array([first, second, first + n, second + n])
    values = np.array([0.0, np.linalg.norm(points[second] - points[first]), 0.0, 0.0])
    free = np.setdiff1d(np.arange(2 * n), held)
    found = np.zeros(2 * n)
    found[held] = values
    found[free] = splu(matrix[free][:, free]).solve(-(matrix[free][:, held] @ values))
    return found.reshape(2, n).T[:count]


def _farthest(points: Array, nodes: Integers, place: Array) -> int:
    """Node farthest from a place; the first of several that are as far but for rounding."""
    distance = np.linalg.norm(points[nodes] - place, axis=1)
    return int(nodes[(distance > (1 - AS_FAR) * distance.max()).argmax()])
