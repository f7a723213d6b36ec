"""Ownership and order of the nodes: one numbering joins all parts of a structure."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import reverse_cuthill_mckee


def bisect(points: NDArray[np.float64], size: int) -> NDArray[np.int32]:
    """Callbacks of each point by recursive coordinate bisection, shape (n,): equal shares, short seams.

    Args:
        points: Positions, shape (n, 3) [m].
        size: Number of owners.
    """
    owner = np.zeros(len(points), dtype=np.int32)

    def split(rows: NDArray[np.intp], first: int, count: int) -> None:
        if count == 1 or not len(rows):
            owner[rows] = first
            return
        axis = np.argmax(np.ptp(points[rows], axis=0))
        rows = rows[np.argsort(points[rows, axis], kind="stable")]
        half = count // 2
        cut = len(rows) * half // count
        split(rows[:cut], first, half)
        split(rows[cut:], first + half, count - half)

    split(np.arange(len(points)), 0, size)
    return owner


def number_nodes(owner: NDArray[np.int32], graph: sparse.csr_array) -> NDArray[np.int64]:
    """Position of each node in the system, shape (n,): consecutive for an owner, close together for neighbours."""
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    order = order[np.argsort(owner[order], kind="stable")]
    number = np.empty(len(owner), dtype=np.int64)
    number[order] = np.arange(len(owner))
    return number
