"""Lines along a field, spread evenly over a surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from ..checks import validation
from ..geometry.sizes import measures
from .spread import START, Spread
from .tracing import Ends, Field, Track
from .walking import Terrain

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Truths = NDArray[np.bool_]

PARTS = 20  # spacings of a surface by default
MAX_SEGMENTS = 200_000  # segments of all lines; more are no picture


def even_lines(
    terrain: Terrain, along: Field, allowed: Truths, spacing: float, shortest: float, sheets: Integers
) -> list[Track]:
    """Lines along a field over all of its cells, no two nearer than about the spacing; see `Spread`."""
    spread = Spread(terrain, along, allowed, spacing, shortest, sheets)
    centres = terrain.points[terrain.triangles].mean(axis=1)
    keys = spread.key(np.arange(len(centres)), centres)
    pieces = _pieces(terrain, allowed)
    left = allowed.copy()
    while True:
        while (seeds := spread.next_seeds()) is not None:
            spread.add(seeds)
        left[left] = spread.free(keys[left], START)
        cells = _middles(centres, pieces, left, None if not spread.tracks else cKDTree(spread.keys), keys)
        if not len(cells):
            return spread.tracks
        shares = np.full((len(cells), 3), 1 / 3)
        spread.add(Ends(cells, shares, along.axes[cells, 0], np.zeros(len(cells))))
        near = cKDTree(keys[cells]).query(keys[left], distance_upper_bound=spacing / 2)[0]
        left[np.flatnonzero(left)[np.isfinite(near)]] = False


def checked_spacing(name: str, terrain: Terrain, spacing: float | None, parts: int = PARTS) -> float:
    """Distance between lines [m].

    Raises:
        ValueError: It is not positive, or so small that lines would have too many segments.
    """
    size = float(np.ptp(terrain.points[terrain.triangles.ravel()], axis=0).max())
    if spacing is None:
        return size / parts
    spacing = validation.positive(name, spacing)
    least = least_spacing(terrain)
    if spacing < least:
        count = MAX_SEGMENTS * (least / spacing) ** 2
        raise ValueError(
            f"{name} is {spacing:g}, with which lines would have {count:.1g} segments; give at least {least:.2g}."
        )
    return spacing


def least_spacing(terrain: Terrain) -> float:
    """Distance between lines below which they would have too many segments [m]."""
    return float(np.sqrt(4 * measures(terrain.points, terrain.triangles).sum() / MAX_SEGMENTS)) * (1 + 1e-9)


def _pieces(terrain: Terrain, allowed: Truths) -> Integers:
    """Count the connected pieces of the allowed cells, and give each cell that of its own, shape (cells,)."""
    cell, corner = np.nonzero(terrain.beside >= 0)
    other = terrain.beside[cell, corner]
    both = allowed[cell] & allowed[other]
    n = len(allowed)
    graph = sparse.coo_array((np.ones(both.sum()), (cell[both], other[both])), shape=(n, n))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _middles(centres: Array, pieces: Integers, left: Truths, lines: cKDTree | None, keys: Array) -> Integers:
    """In each piece, the cell that is farthest from all lines; of a piece without one, that nearest to its middle."""
    cells = np.flatnonzero(left)
    if not len(cells):
        return cells
    piece = np.unique(pieces[cells], return_inverse=True)[1].ravel()
    weight = np.bincount(piece)
    middle = np.stack([np.bincount(piece, entry) / weight for entry in centres[cells].T], axis=1)
    rank = np.linalg.norm(centres[cells] - middle[piece], axis=1)
    if lines is not None:
        far = lines.query(keys[cells])[0]
        rank = rank - 1e3 * np.minimum(far, 1e3 * (rank.max() + 1e-300))
    order = np.lexsort((rank, piece))
    return np.asarray(cells[order[np.unique(piece[order], return_index=True)[1]]])
