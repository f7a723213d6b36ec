"""Solve for the coordinates of nodes one by one, where no constraint couples them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ...model.structure import Structure
from ..constraints.motions import Motions

Array = NDArray[np.float64]

SINGULAR = 1e-13  # pivot over the largest entry, that counts as zero


class ComponentSolve:
    """Solve K x = f for each component of the nodes, factorized once for those that are held alike.

    Args:
        structure: The structure.
        matrix: K, shape (n, n) [N/m].
        motions: Free motions of its nodes, all along axes.

    Raises:
        ValueError: The system is singular up to rounding.
    """

    def __init__(self, structure: Structure, matrix: sparse.csr_matrix, motions: Motions) -> None:
        self.matrix, self.held = matrix, motions.held
        self.solvers: dict[bytes, Callable[[Array], Array]] = {}
        for component in range(3):
            held = self.held[:, component]
            if held.tobytes() not in self.solvers:
                self.solvers[held.tobytes()] = factorized(matrix[~held][:, ~held])

    def __call__(self, held_at: Array, force: Array) -> Array:
        """Shape under forces, both of shape (n, 3), with held components as in a shape."""
        shape = held_at.copy()
        for component in range(3):
            held = self.held[:, component]
            origin = (
                held_at[held, component].mean() if held.any() else 0.0
            )  # near the shape, so that no digits are lost
            right = force[:, component] - self.matrix[:, held] @ (held_at[held, component] - origin)
            shape[~held, component] = origin + self.solvers[held.tobytes()](right[~held])
        return shape


def factorized(matrix: sparse.csr_matrix) -> Callable[[Array], Array]:
    """Return a solver with a positive definite matrix.

    Raises:
        ValueError: It is singular up to rounding.
    """
    if not matrix.shape[0]:
        return lambda right: right
    if not np.isfinite(matrix.data).all():
        raise ValueError("A cell of the shape has no size, so its stress has no stiffness; hold nodes around it.")
    try:
        factors = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
        least = np.abs(factors.U.diagonal()).min()
    except RuntimeError:  # SuperLU: exactly singular
        least = 0.0
    if least <= SINGULAR * np.abs(matrix.diagonal()).max():
        raise ValueError(
            "The stresses and cable forces differ so much that the smaller ones are lost in rounding; give values "
            "nearer to each other."
        )
    return lambda right: np.asarray(factors.solve(right))
