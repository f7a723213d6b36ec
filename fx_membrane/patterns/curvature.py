"""Gauss curvature of surfaces of triangles, by angle defects."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures
from ..geometry.topology import boundary_edges

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def gauss_curvature(points: Array, triangles: Integers) -> Array:
    """Gauss curvature of cells, shape (k,) [1/m2].

    Curvature is the sum of the angle defects of corners and their neighbours, over the area around them. Nodes on
    borders add neither. A cell without an inner node nearby has the curvature zero.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Cells, shape (k, 3).

    Source:
        M. Meyer, M. Desbrun, P. Schroeder, A. H. Barr, Discrete differential-geometry operators for triangulated
        2-manifolds, in Visualization and Mathematics III (2003), section 4.
    """
    count = len(points)
    angles = _angles(points, triangles)
    defect = np.asarray(2 * np.pi - np.bincount(triangles.ravel(), angles.ravel(), count))
    around = np.asarray(
        np.bincount(triangles.ravel(), _shares(points, triangles, angles).ravel(), count), dtype=np.float64
    )
    border = np.unique(boundary_edges(triangles))
    defect[border] = around[border] = 0.0
    for _ in range(2):  # sums over neighbours: the defect of one node alone depends on the shape of its cells
        defect, around = (_spread(values, triangles, count) for values in (defect, around))
    area = around[triangles].sum(axis=1)
    return np.asarray(defect[triangles].sum(axis=1) / np.where(area > 0, area, 1.0))


def _shares(points: Array, triangles: Integers, angles: Array) -> Array:
    """Areas of cells nearest to their corners, in obtuse cells half and quarters, shape (k, 3) [m2]."""
    corners = points[triangles]
    opposite = ((np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2)
    part = opposite / np.tan(angles)  # at its corner the side opposite, shared by the other two
    nearest = (np.roll(part, -1, axis=1) + np.roll(part, 1, axis=1)) / 8
    obtuse = angles > np.pi / 2
    area = measures(points, triangles)[:, None]
    return np.where(obtuse.any(axis=1, keepdims=True), np.where(obtuse, area / 2, area / 4), nearest)


def _angles(points: Array, triangles: Integers) -> Array:
    corners = points[triangles]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    across = np.linalg.norm(np.cross(ahead, back), axis=2)
    return np.asarray(np.arctan2(across, (ahead * back).sum(axis=2)))


def _spread(values: Array, triangles: Integers, count: int) -> Array:
    """Sum over the corners of all cells around each node."""
    return np.asarray(
        np.bincount(triangles.ravel(), np.repeat(values[triangles].sum(axis=1), 3), count), dtype=np.float64
    )
