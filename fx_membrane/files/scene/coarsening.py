"""Coarser triangles to draw: nodes in one box of a grid become one."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures

Triangles = NDArray[np.int64]


def coarser(
    points: NDArray[np.float64], membranes: Mapping[str, Triangles], most: int
) -> dict[str, tuple[NDArray[np.int64], Triangles]]:
    """Cells to draw of each membrane, and their corners, at most so many in all; all of them if they are no more.

    Args:
        points: Positions of the nodes, shape (n, 3).
        membranes: Triangles of the membranes by name, each of shape (cells, 3).
        most: Largest number of triangles.

    Returns:
        For each name the numbers of the kept cells, shape (k,), and their corners, shape (k, 3).
    """
    if sum(map(len, membranes.values())) <= most:
        return {name: (np.arange(len(cells)), cells) for name, cells in membranes.items()}
    area = sum(measures(points, cells).sum() for cells in membranes.values())
    box = np.sqrt(2 * area / most)
    while True:
        corner = _in_boxes(points, box)
        kept = {name: _kept(corner[cells]) for name, cells in membranes.items()}
        if sum(len(numbers) for numbers, _ in kept.values()) <= most:
            return kept
        box *= 1.1


def _in_boxes(points: NDArray[np.float64], box: float) -> NDArray[np.int64]:
    """For each node the first node in its box, shape (n,)."""
    rows = np.floor((points - points.min(axis=0)) / box).astype(np.int64)
    counts = rows.max(axis=0) + 1
    _, first, inverse = np.unique(np.ravel_multi_index(rows.T, counts), return_index=True, return_inverse=True)
    return first[inverse.ravel()]


def _kept(corners: Triangles) -> tuple[NDArray[np.int64], Triangles]:
    """Triangles that still have three corners, each once."""
    rows = np.sort(corners, axis=1)
    numbers = np.flatnonzero((rows[:, 0] != rows[:, 1]) & (rows[:, 1] != rows[:, 2]))
    _, first = np.unique(rows[numbers], axis=0, return_index=True)
    numbers = numbers[np.sort(first)]
    return numbers, corners[numbers]
