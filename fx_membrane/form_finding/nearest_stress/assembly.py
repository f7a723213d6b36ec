"""Matrices of nodes from blocks of cells."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Array = NDArray[np.float64]
Cells = NDArray[np.int64]


def assembled(n: int, entries: Sequence[tuple[Cells, Array]]) -> sparse.csr_matrix:
    """Sum blocks of cells, shape (cells, 3 k, 3 k) or (cells, k, 3, k, 3), into a matrix of 3 n components."""
    rows, columns, values = [], [], []
    for cells, blocks in entries:
        numbers = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 3 * cells.shape[1])
        rows.append(np.repeat(numbers, numbers.shape[1], axis=1).ravel())
        columns.append(np.tile(numbers, (1, numbers.shape[1])).ravel())
        values.append(blocks.reshape(-1))
    entries_of = (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns)))
    return sparse.coo_matrix(entries_of, shape=(3 * n, 3 * n)).tocsr()
