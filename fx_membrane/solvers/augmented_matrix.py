"""A tangent with its borders as one sparse matrix, for eigenvalues.

    [K    B] phi = lambda [M  0] phi
    [B^T -C]              [0  0]

has the finite eigenvalues of K + B C^-1 B^T and M; of given integrals, C = 0, those of K on the motions that keep them.
A factorization of the matrix less a shift has one negative pivot for each border with C >= 0, and those of the whole.
One-sided borders have other rows in the place of B^T; then pivots tell nothing.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.integral_energies import Borders

Array = NDArray[np.float64]


class Augmented(NamedTuple):
    """Matrices with borders.

    Attributes:
        K: The tangent and its borders.
        M: The mass matrix, zero in the borders, with the pattern of K; None for the identity, without borders.
        negative: Number of negative pivots that belong to the borders.
    """

    K: PETSc.Mat
    M: PETSc.Mat | None
    negative: int

    def free(self) -> None:
        """Free the matrices; collective."""
        for matrix in (self.K, self.M):
            if matrix is not None:
                matrix.destroy()


def augmented(
    K: PETSc.Mat, M: PETSc.Mat | None, borders: Borders, rows: NDArray[np.signedinteger[Any]] | slice = slice(None)
) -> Augmented:
    """Join matrices and borders; without borders, they are returned as they are; else they are freed, as the borders.

    Args:
        K: Sparse part of the tangent, "aij".
        M: Mass matrix of the same pattern; the identity if None.
        borders: The borders.
        rows: Rows of the matrices among those of this process's part of a border.
    """
    if not borders.vectors:
        return Augmented(K, M, 0)
    size = K.norm(PETSc.NormType.INFINITY)
    columns, scales = _scaled(K, borders.vectors, size, rows)
    across, across_scales = _scaled(K, borders.rows, size, rows)
    tangent = _joined(K, columns, across, -borders.compliances * scales * across_scales)
    if M is None:
        M = K.duplicate(copy=False)
        M.zeroEntries()
        M.shift(1.0)
    mass = _joined(M, columns * 0.0, columns * 0.0, borders.compliances * 0.0)
    negative = int((borders.compliances >= 0).sum())
    for matrix in (K, M):
        matrix.destroy()
    borders.free()
    return Augmented(tangent, mass, negative)


def _scaled(
    K: PETSc.Mat, vectors: list[PETSc.Vec], size: float, rows: NDArray[np.signedinteger[Any]] | slice
) -> tuple[Array, Array]:
    """Borders of a norm, shape (rows, m), and the factors that they are scaled by, shape (m,)."""
    columns = np.column_stack([vector.array_r[rows] for vector in vectors])
    lengths = np.sqrt(K.comm.tompi4py().allreduce((columns**2).sum(axis=0)))
    scales = size / np.where(lengths > 0, lengths, 1.0)
    return columns * scales, scales


def _joined(A: PETSc.Mat, columns: Array, across: Array, corner: Array) -> PETSc.Mat:
    """Matrix with borders, whose rows the last process has; its pattern does not depend on their values."""
    comm = A.comm.tompi4py()
    count, own, total = len(corner), A.getLocalSize()[0], A.getSize()[0]
    pointers, places, values = A.getValuesCSR()
    ends = pointers.astype(np.int64) + count * np.arange(own + 1)
    last = (ends[1:, None] - count + np.arange(count)).ravel()
    inside = np.ones(len(values) + own * count, dtype=bool)
    inside[last] = False
    positions, entries = np.empty(len(inside), dtype=np.int64), np.empty(len(inside))
    positions[inside], entries[inside] = places, values
    positions[last], entries[last] = np.tile(total + np.arange(count), own), columns.ravel()
    below = comm.gather(across, root=comm.size - 1)
    if below is not None:
        width = total + count
        ends = np.append(ends, ends[-1] + width * np.arange(1, count + 1))
        positions = np.append(positions, np.tile(np.arange(width), count))
        entries = np.append(entries, np.hstack([np.vstack(below).T, np.diag(corner)]).ravel())
        own += count
    size = (own, total + count)
    csr = (ends.astype(PETSc.IntType), positions.astype(PETSc.IntType), entries)
    return PETSc.Mat().createAIJ((size, size), csr=csr, comm=A.comm)
