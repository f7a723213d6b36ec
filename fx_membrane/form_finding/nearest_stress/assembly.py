"""Matrices of nodes from blocks of cells."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]
Cells = NDArray[np.int64]


def assembled(n: int, entries: Sequence[tuple[Cells, Array]]) -> sparse.csr_matrix:
    """Sum blocks of cells, shape (cells, 3 k, 3 k) or (cells, k, 3, k, 3), into a matrix of 3 n components."""
    places = [_places(cells) for cells, _ in entries]
    rows, columns = (np.concatenate(numbers) for numbers in zip(*places, strict=True))
    values = np.concatenate([blocks.reshape(-1) for _, blocks in entries])
    return sparse.coo_matrix((values, (rows, columns)), shape=(3 * n, 3 * n)).tocsr()


class Pattern:
    """Places of the blocks of cells in a matrix that is summed often, sorted once.

    Args:
        n: Number of nodes.
        cells: Their nodes, shape (cells, k).
    """

    def __init__(self, n: int, cells: Cells) -> None:
        rows, columns = _places(cells)
        self._order = np.lexsort((columns, rows))
        rows, columns = rows[self._order], columns[self._order]
        self._starts = np.flatnonzero(np.diff(rows, prepend=-1) | np.diff(columns, prepend=-1))
        self._indices = columns[self._starts]
        self._pointers = np.searchsorted(rows[self._starts], np.arange(3 * n + 1))

    def summed(self, blocks: Array) -> sparse.csr_matrix:
        """Sum blocks of the cells, shape (cells, 3 k, 3 k) or (cells, k, 3, k, 3), into a matrix of 3 n components."""
        count = len(self._pointers) - 1
        if not len(self._starts):
            return sparse.csr_matrix((count, count))
        values = np.add.reduceat(blocks.reshape(-1)[self._order], self._starts)
        return sparse.csr_matrix((values, self._indices, self._pointers), shape=(count, count))


def _places(cells: Cells) -> tuple[Cells, Cells]:
    """Rows and columns of the entries of the blocks of cells, block by block."""
    numbers = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 3 * cells.shape[1])
    return np.repeat(numbers, numbers.shape[1], axis=1).ravel(), np.tile(numbers, (1, numbers.shape[1])).ravel()
