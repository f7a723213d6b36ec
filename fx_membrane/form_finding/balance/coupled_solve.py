"""Solve for all coordinates of nodes at once, where nodes slide along no axis, or move together in bodies."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...model.structure import Structure
from ..constraints.bodies import settled
from ..constraints.motions import Motions
from .component_solve import factorized

Array = NDArray[np.float64]


class CoupledSolve:
    """Solve K x = f in the free motions x = x0 + T q of the nodes; bodies keep their shape.

    Args:
        structure: The structure in its first shape, through which nodes slide.
        matrix: K for each component, shape (n, n) [N/m].
        motions: Free motions of its nodes.

    Raises:
        ValueError: The system is singular up to rounding.
    """

    def __init__(self, structure: Structure, matrix: sparse.csr_matrix, motions: Motions) -> None:
        self.motions, self.points, self.matrix = motions, structure.points, matrix
        self.basis, columns = motions.basis()
        self.solver = factorized(self.basis.T @ sparse.kron(matrix, sparse.eye(3)) @ self.basis)
        self.columns = np.concatenate([np.zeros(0, dtype=np.int64), *columns])
        if motions.bodies:
            unit = np.zeros((self.basis.shape[1], len(self.columns)))
            unit[self.columns, np.arange(len(self.columns))] = 1
            self.response = self.solver(unit)
            self.stiffness = np.linalg.inv(self.response[self.columns])
            self.stiffness = (self.stiffness + self.stiffness.T) / 2

    def __call__(self, held_at: Array, force: Array) -> Array:
        """Shape under forces, both of shape (n, 3), with held components as in a shape.

        Raises:
            RuntimeError: A body finds no balance.
        """
        base = np.where(self.motions.held, held_at, 0.0)
        base[self.motions.slides] = self.points[self.motions.slides]
        for body in self.motions.bodies:
            base[body.nodes] = body.coordinates @ body.first
        free = self.solver(self.basis.T @ (force - self.matrix @ base).ravel())
        if self.motions.bodies:
            start = np.concatenate([body.unknowns(held_at) for body in self.motions.bodies])
            _, push = settled(self.motions.bodies, self.stiffness, free[self.columns], start)
            free = free + self.response @ push
        return np.where(self.motions.held, held_at, base + (self.basis @ free).reshape(base.shape))
