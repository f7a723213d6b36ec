"""Shortest lines between two points of a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks import validation
from ..geometry.topology import with_one_sense
from .nearest_points import nearest, on_surface
from .shapes import Surface
from .walking import Way

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def shortest(surface: Surface, start: object, end: object) -> Way:
    """Find a line between two points that no line beside it shortens.

    Raises:
        ValueError: A point is not on the surface; both are the same, or on pieces apart; it has one side only.
        ImportError: potpourri3d is not installed.

    Source:
        N. Sharp, K. Crane, You can find geodesic paths in triangle meshes by just flipping edges, ACM Transactions on
        Graphics 39 (2020) 249.
    """
    cell, shares = on_surface("end", surface, end)
    goal = shares @ surface.points[surface.triangles[cell]]
    with_start, first = _with_node(surface, *on_surface("start", surface, start))
    full, last = _with_node(with_start, *on_surface("end", with_start, goal))
    if first == last:
        raise ValueError(f"start and end are the same point, {validation.format_point(goal)}; give two.")
    used, cells = np.unique(full.triangles, return_inverse=True)
    cells, reason = with_one_sense(cells.reshape(-1, 3))
    if reason:
        raise ValueError(f"The surface {reason}")
    a, b = np.searchsorted(used, [first, last])
    links = sparse.coo_array(
        (np.ones(2 * len(cells)), (cells[:, [0, 0]].T.ravel(), cells[:, 1:].T.ravel())), (len(used),) * 2
    )
    piece = connected_components(links, directed=False)[1]
    if piece[a] != piece[b]:
        raise ValueError(
            f"start and end, {validation.format_point(full.points[first])} and {validation.format_point(goal)}, are on "
            "pieces of the surface that share no node; give points of one piece."
        )
    within = piece[cells[:, 0]] == piece[a]
    (points,) = flipped(full.points[used], cells[within], [[a, b]])
    middles = (points[1:] + points[:-1]) / 2
    return Way(points, nearest(surface, middles)[0])


def flipped(points: Array, cells: Integers, pairs: ArrayLike) -> list[Array]:
    """Find geodesics between pairs of nodes, each a line of shape (m, 3) [m].

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        cells: Triangles of one sense that connect the nodes of each pair, shape (cells, 3).
        pairs: First and last nodes, shape (k, 2).

    Raises:
        ImportError: potpourri3d is not installed.
    """
    try:
        from potpourri3d import EdgeFlipGeodesicSolver  # noqa: PLC0415  (its absence has a remedy)
    except ImportError as error:
        raise ImportError(f"potpourri3d does not load ({error}); install it: pip install potpourri3d.") from None
    nodes, local = np.unique(cells, return_inverse=True)
    middle = (points[nodes].min(axis=0) + points[nodes].max(axis=0)) / 2  # the solver has places in single precision
    solver = EdgeFlipGeodesicSolver(points[nodes] - middle, local.reshape(-1, 3))
    least, paths = 1e-12 * np.ptp(points, axis=0).max(), []
    for start, end in np.asarray(pairs).tolist():
        a, b = np.searchsorted(nodes, [start, end])
        found = middle + np.asarray(solver.find_geodesic_path(int(a), int(b)), dtype=np.float64)
        apart = np.linalg.norm(np.diff(found, axis=0), axis=1) > least
        found = found[np.append(True, apart)]
        found[0], found[-1] = points[start], points[end]
        paths.append(found)
    return paths


def _with_node(surface: Surface, cell: int, shares: Array) -> tuple[Surface, int]:
    """Add a node at a point, unless there is one; split the cells that it is in."""
    there = np.flatnonzero(shares > 0)
    corners = surface.triangles[cell]
    if len(there) == 1:
        return surface, int(corners[there[0]])
    node = len(surface.points)
    points = np.vstack([surface.points, shares @ surface.points[corners]])
    split = (np.isin(surface.triangles, corners[there]).sum(axis=1) == len(there)).nonzero()[0]
    pieces = []
    for old in surface.triangles[split]:
        for corner in corners[there]:
            pieces.append(np.where(old == corner, node, old))
    return Surface(points, np.vstack([np.delete(surface.triangles, split, axis=0), *pieces])), node
