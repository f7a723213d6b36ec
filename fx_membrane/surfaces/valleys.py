"""Valleys of a surface: edges that water runs into from all cells at them, and along which it goes on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import lengths, normals
from .shapes import Surface

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

# Sine of the angle between the fall of a cell and its edge, below which water runs beside the edge. Rounding of
# coordinates leaves 1e-12 at most; a mesh with an edge along the fall has 1e-6 and less by its file.
BESIDE = 1e-6


def valleys_of(surface: Surface, up: Array, outlets: Integers) -> tuple[Integers, Array]:
    """Edges along which water runs, shape (k, 2), and their slopes, rise over run, shape (k,) [-].

    An edge of a single cell is on the rim: water runs along it where its ends are no outlets.

    Args:
        surface: The surface.
        up: Upward direction, of length one, shape (3,).
        outlets: Nodes over which water leaves, shape (o,).
    """
    triangles = surface.triangles
    edges = np.concatenate([np.roll(triangles, -turn, axis=1)[:, :2] for turn in range(3)])
    into = np.concatenate([_into(surface, up, turn) for turn in range(3)])
    pairs, inverse, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    running = np.bincount(inverse.ravel(), into, len(pairs)) == count
    running &= (count > 1) | ~np.isin(pairs, outlets).any(axis=1)
    valleys = pairs[running]
    way = np.diff(surface.points[valleys], axis=1)[:, 0]
    rise = np.abs(way @ up)
    run = lengths(way - (way @ up)[:, None] * up)
    return valleys, np.divide(rise, run, where=run > 0, out=np.full(len(run), np.inf))


def _into(surface: Surface, up: Array, turn: int) -> NDArray[np.bool_]:
    """Tell of each cell if water on it runs into one of its edges, shape (cells,)."""
    normal = normals(surface.points, surface.triangles)
    fall = (normal @ up)[:, None] * normal - up
    a, b, _ = np.roll(surface.triangles, -turn, axis=1).T
    out = np.cross(surface.points[b] - surface.points[a], normal)
    return np.asarray(np.einsum("ni,ni->n", fall, out) > BESIDE * lengths(fall) * lengths(out))
