"""Warp along lines on a surface."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..checks import validation
from ..geometry.sizes import lengths, projected
from .shapes import Shape, Surface, surface_of
from .surface_lines import SurfaceLine
from .transfer import main_direction
from .walking import Terrain

Array = NDArray[np.float64]

NONE = 1e-6  # difference of principal values of the mean of directions that leaves no direction


def warp_along(shape: Shape, lines: Sequence[SurfaceLine], part: str | None = None) -> Array:
    """Warp for `Membrane` along some lines, as geodesics: unit vectors, one per cell, shape (cells, 3) [-].

    Cells that lines cross have their direction; in all others the direction changes as little from cell to cell as
    these allow. The sense of the lines does not matter; that of the warp is the same in neighbouring cells where
    possible.

    Args:
        shape: Surface of the lines: a `Structure`, a `Form`, a `StageResult`, or points and triangles as a pair.
        lines: The lines, of this surface and part.
        part: Name of the membrane; None for all, with cells in the order of the parts.

    Raises:
        ValueError: A line is of another surface; a connected piece of the surface has no line; lines leave a cell
            without a direction, as between lines at right angles.

    Example:
        >>> points, triangles = rectangle(4.0, 4.0, 8, 8)
        >>> lines = [geodesic((points, triangles), (0, y, 0), direction=(2, 1, 0)) for y in (-1, 1)]
        >>> warp = warp_along((points, triangles), lines)
        >>> bool(np.allclose(np.abs(warp @ [2, 1, 0]), np.sqrt(5)))
        True
    """
    surface = surface_of("warp_along", shape, part)
    given = validation.instances("lines", lines, SurfaceLine)
    terrain = Terrain(surface)
    tensors, known = _of_lines(surface, given)
    _check_pieces(surface, terrain, known)
    a, b = links(terrain)
    n = len(known)
    graph = sparse.coo_array((np.ones(2 * len(a)), (np.r_[a, b], np.r_[b, a])), shape=(n, n)).tocsr()
    laplace = sparse.csr_array(sparse.diags(graph.sum(axis=1)) - graph)
    free = ~known
    if free.any():
        solve = splu(sparse.csc_matrix(laplace[free][:, free])).solve
        tensors[free] = solve(-(laplace[free][:, known] @ tensors[known]))
    normal = terrain.normals
    flat = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    within = flat @ tensors.reshape(-1, 3, 3) @ flat
    values = np.linalg.eigvalsh(within)
    vague = np.flatnonzero(values[:, 2] - values[:, 1] <= NONE)
    if len(vague):
        where = validation.format_point(surface.points[surface.triangles[vague[0]]].mean(axis=0))
        raise ValueError(f"The lines leave cell {vague[0]} at {where} without a direction; give one more line there.")
    return in_one_sense(projected(main_direction(within), normal), a, b)


def _of_lines(surface: Surface, lines: Sequence[SurfaceLine]) -> tuple[Array, NDArray[np.bool_]]:
    """Means of the products of directions in the cells of lines, shape (cells, 9), and the mask of these cells."""
    count = len(surface.triangles)
    total, weight = np.zeros((count, 9)), np.zeros(count)
    for number, line in enumerate(lines):
        stray = bool(len(line.cells) == 0 or line.cells.max() >= count)
        if not stray:
            centre = surface.points[surface.triangles[line.cells]].mean(axis=1)
            middle = (line.points[1:] + line.points[:-1]) / 2
            reach = lengths(surface.points[surface.triangles[line.cells, 0]] - centre)
            others = (lengths(surface.points[surface.triangles[line.cells, corner]] - centre) for corner in (1, 2))
            stray = bool((lengths(middle - centre) > 1.01 * np.maximum.reduce([reach, *others])).any())
        if stray:
            raise ValueError(f"lines, entry {number}, {line!r}, is of another surface; make the lines on this one.")
        side = np.diff(line.points, axis=0)
        length = lengths(side)
        if not length.any():
            where = validation.format_point(line.points[0])
            raise ValueError(f"lines, entry {number}, at {where}, has no length, and so no direction; leave it out.")
        divisor = np.maximum(length, np.finfo(float).tiny)[:, None, None]  # a piece without length adds nothing
        np.add.at(total, line.cells, (side[:, :, None] * side[:, None, :] / divisor).reshape(-1, 9))
        np.add.at(weight, line.cells, length)
    known = weight > 0
    total[known] /= weight[known, None]
    return total, known


def links(terrain: Terrain) -> tuple[NDArray[Any], NDArray[Any]]:
    """Pairs of cells that share an edge."""
    cell, corner = np.nonzero(terrain.beside > np.arange(len(terrain.beside))[:, None])
    return cell, terrain.beside[cell, corner]


def _check_pieces(surface: Surface, terrain: Terrain, known: NDArray[np.bool_]) -> None:
    a, b = links(terrain)
    n = len(known)
    piece = connected_components(sparse.coo_array((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)[1]
    bare = np.setdiff1d(piece, piece[known])
    if len(bare):
        cell = int(np.flatnonzero(piece == bare[0])[0])
        where = validation.format_point(surface.points[surface.triangles[cell]].mean(axis=0))
        raise ValueError(f"The piece of the surface with cell {cell}, at {where}, has no line; give it one.")


def in_one_sense(warp: Array, a: NDArray[Any], b: NDArray[Any]) -> Array:
    """Turn directions along a tree of neighbours so that neighbours agree."""
    n = len(warp)
    agree = np.sum(warp[a] * warp[b], axis=1)
    cost = 1 + 1e-9 - np.abs(agree)
    tree = sparse.csgraph.minimum_spanning_tree(sparse.coo_array((cost, (a, b)), shape=(n, n)).tocsr()).tocoo()
    same = np.sum(warp[tree.row] * warp[tree.col], axis=1) >= 0
    # Two copies of each cell, one for each sense; of a tree, each copy of a piece is connected.
    rows = np.r_[tree.row, tree.row + n]
    columns = np.where(np.r_[same, same], np.r_[tree.col, tree.col + n], np.r_[tree.col + n, tree.col])
    links = sparse.coo_array((np.ones(len(rows)), (rows, columns)), shape=(2 * n, 2 * n))
    label = connected_components(links, directed=False)[1].reshape(2, n)
    _, first = np.unique(np.minimum(*label), return_index=True)
    sense = np.isin(label[0], label[0, first])
    return np.asarray(np.where(sense[:, None], warp, -warp))
