"""Linear systems with borders, by the factorization of their sparse part and one more solve for each border.

    K dx + B q = b,    B^T dx - C q = r

By the capacitance matrix S = C + B^T K^-1 B,

    dx = K^-1 b - Z q,    Z = K^-1 B,    S q = B^T K^-1 b - r.

Without given integrals, dx solves (K + B C^-1 B^T) dx = b. One-sided borders have other rows in the place of B^T.

By Haynsworth's formula, the matrix without one-sided borders has more negative eigenvalues than K. The difference is
the number of positive eigenvalues of S less that of C. A given integral has C = 0, which counts as positive: the number
is that of K on motions that keep the integral.

A one-sided border multiplies the determinant by the ratio of that of S with it to that without it, over C. A negative
ratio changes the number of negative eigenvalues by an odd number. Of these changes the smallest one is taken: one
eigenvalue turns positive; it turns negative if none was.

Sources: W. W. Hager, Updating the inverse of a matrix, SIAM Review 31 (1989) 221-239; E. V. Haynsworth, Determination
of the inertia of a partitioned Hermitian matrix, Linear Algebra Appl. 1 (1968) 73-81.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.integral_energies import NO_BORDERS, Borders
from . import petsc_options

Array = NDArray[np.float64]


class BorderedSystem:
    """Borders of a sparse matrix with a factorization.

    Attributes:
        borders: The borders.
        capacitance: S, shape (m, m).
    """

    def __init__(self, borders: Borders = NO_BORDERS):
        self.borders, self._solved = borders, False
        self._Z: list[PETSc.Vec] = []
        self.capacitance = np.zeros((0, 0))

    def factor(self, ksp: PETSc.KSP) -> None:
        """Solve for the borders with the present factorization; collective."""
        self._drop()
        columns = self.borders.vectors
        for column in columns:
            solution = column.duplicate()
            ksp.solve(column, solution)
            self._Z.append(solution)
        products = [[row.dot(solution) for solution in self._Z] for row in self.borders.rows]
        self.capacitance = np.diag(self.borders.compliances) + np.reshape(products, (len(columns),) * 2)

    def correct(self, dx: PETSc.Vec, rest: Array | None = None) -> Array:
        """Make dx = K^-1 b the solution of the system; return q, shape (m,).

        Args:
            dx: Solution of the sparse system.
            rest: Right-hand side r of the borders; that of Newton's method if None.
        """
        columns = self.borders.vectors
        if not columns:
            return np.zeros(0)
        rest = self.borders.rest if rest is None else rest
        q = _solution(self.capacitance, np.array([row.dot(dx) for row in self.borders.rows]) - rest)
        for factor, solution in zip(q, self._Z, strict=True):
            dx.axpy(-factor, solution)
        return q

    def negative(self, of_sparse: int) -> int:
        """Count of negative eigenvalues of the whole, from that of the sparse part."""
        if not len(self.capacitance) or not np.isfinite(self.capacitance).all():
            return of_sparse
        compliances, count = self.borders.compliances, int(self.borders.two_sided.sum())  # one-sided ones are the last
        capacitance = self.capacitance[:count, :count]
        signs = np.linalg.eigvalsh((capacitance + capacitance.T) / 2) > 0
        negative = of_sparse + int(signs.sum()) - int((compliances[:count] >= 0).sum())
        before = np.linalg.slogdet(capacitance)[0]
        for number, compliance in enumerate(compliances[count:], count + 1):
            after = np.linalg.slogdet(self.capacitance[:number, :number])[0]
            if before * after * compliance < 0:
                negative += -1 if negative else 1
            before = after
        return negative

    def solves(
        self, A: PETSc.Mat, dx: PETSc.Vec, q: Array, b: PETSc.Vec, work: PETSc.Vec, most: float = petsc_options.SOLVED
    ) -> bool:
        """Return True if K dx + B q = b up to a tolerance of b and the forces of given integrals; False for NaN."""
        A.mult(dx, work)
        scale = float(b.norm())
        for factor, column, given in zip(q, self.borders.vectors, self.borders.given, strict=True):
            work.axpy(factor, column)
            scale += abs(factor) * float(column.norm()) if given else 0.0
        work.axpy(-1.0, b)
        return bool(work.norm() <= most * scale)

    def multiply(self, A: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to (K + B C^-1 B^T) x; given integrals are left out."""
        A.mult(x, y)
        borders = self.borders
        for column, row, compliance in zip(borders.vectors, borders.rows, borders.compliances, strict=True):
            if compliance:
                y.axpy(row.dot(x) / compliance, column)

    def curvature(self, b: PETSc.Vec, dx: PETSc.Vec, q: Array) -> float:
        """Curvature dx^T (K + B C^-1 B^T) dx of a solution; given integrals are left out."""
        whole = float(b.dot(dx))
        for factor, column, given in zip(q, self.borders.vectors, self.borders.given, strict=True):
            whole -= factor * column.dot(dx) if given else 0.0
        return whole

    def penalties(self) -> Array:
        """Twice the stiffness of the structure against each given integral, shape (given,), an upper bound."""
        given = self.borders.given
        if not given.any():
            return np.zeros(0)
        inverse = np.linalg.pinv(self.capacitance, hermitian=False)
        return np.full(int(given.sum()), 2 * float(np.linalg.norm(inverse, 2)))

    def free(self) -> None:
        """Free all vectors; collective."""
        self._drop()
        self.borders.free()

    def _drop(self) -> None:
        for solution in self._Z:
            solution.destroy()
        self._Z = []


def _solution(S: Array, right: Array) -> Array:
    """Solution of a small system; NaN if it is singular."""
    try:
        return np.asarray(np.linalg.solve(S, right))
    except np.linalg.LinAlgError:
        return np.full(len(right), np.nan)
