"""Equilibrium of given force densities: one symmetric system for each coordinate of the nodes."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..checks import validation
from ..model.structure import Structure

Array = NDArray[np.float64]
Cells = NDArray[np.int64]

SAME = 1e-13  # relative change of the loads that counts as none
NEAR = 1e-10  # the same, if it falls no more: it is rounding of the shape then
REPEATS = 200  # maximum number of solves for loads that depend on the shape
FAR = 1e3  # displacement over size of the start, above which loads that still change grow without bound
SINGULAR = 1e-13  # pivot over the largest entry, that counts as zero


class LinearBalance:
    """Balance K x = f of the nodes of a structure, factorized once for all loads.

    Args:
        structure: The structure; its supports hold nodes where they are.
        blocks: Cells and their matrices, shapes (cells, k) and (cells, k, k) [N/m]; zero ones tie nothing.

    Raises:
        ValueError: Nodes are tied to no held node in some component, or the system is singular up to rounding.
    """

    def __init__(self, structure: Structure, blocks: Sequence[tuple[Cells, Array]]) -> None:
        n = len(structure.points)
        self.held = structure.supported | ~structure.used[:, None]
        self.reacting = structure.supported
        self.matrix = _assembled(n, blocks)
        _check_ties(structure, self.held, blocks)
        self.solvers: dict[bytes, Callable[[Array], Array]] = {}
        for component in range(3):
            key = self.held[:, component].tobytes()
            if key not in self.solvers:
                self.solvers[key] = self._factorized(~self.held[:, component])

    def _factorized(self, free: NDArray[np.bool_]) -> Callable[[Array], Array]:
        if not free.any():
            return lambda right: right
        matrix = self.matrix[free][:, free].tocsc()
        try:
            factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            least = np.abs(factors.U.diagonal()).min()
        except RuntimeError:  # SuperLU: exactly singular
            least = 0.0
        if least <= SINGULAR * np.abs(self.matrix.diagonal()).max():
            raise ValueError(
                "The stresses and cable forces differ so much that the smaller ones are lost in rounding; give values "
                "nearer to each other."
            )
        return lambda right: np.asarray(factors.solve(right))

    def solve(self, start: Array, loads: Callable[[Array], Array]) -> tuple[Array, Array]:
        """Find the shape in balance with the loads on it, and its reactions, both of shape (n, 3).

        Args:
            start: Shape with the held nodes in place, shape (n, 3) [m].
            loads: Function of the shape, which returns forces on the nodes, shape (n, 3) [N].

        Raises:
            RuntimeError: The loads do not settle.
        """
        force, shape, change = loads(start), start, np.inf
        for _ in range(REPEATS):
            shape = self._solve(shape, force)
            before, force = force, loads(shape)
            last, change = change, np.abs(force - before).max()
            settled = change <= NEAR * np.abs(force).max() and change > last / 2
            if change <= SAME * np.abs(force).max() or settled:
                return shape, np.where(self.reacting, self.matrix @ shape - before, 0.0)
            if np.abs(shape - start).max() > FAR * np.ptp(start, axis=0).max():
                break
        raise RuntimeError(
            "Form finding found no shape for the loads: they grow with the form faster than the stress can hold. Give "
            "a larger stress or smaller loads."
        )

    def _solve(self, held_at: Array, force: Array) -> Array:
        shape = held_at.copy()
        for component in range(3):
            held = self.held[:, component]
            right = force[:, component] - self.matrix[:, held] @ held_at[held, component]
            shape[~held, component] = self.solvers[held.tobytes()](right[~held])
        return shape


def _assembled(n: int, blocks: Sequence[tuple[Cells, Array]]) -> sparse.csr_matrix:
    rows = np.concatenate([np.repeat(cells, cells.shape[1], axis=1).ravel() for cells, _ in blocks])
    columns = np.concatenate([np.tile(cells, (1, cells.shape[1])).ravel() for cells, _ in blocks])
    values = np.concatenate([matrices.ravel() for _, matrices in blocks])
    return sparse.coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()


def _check_ties(structure: Structure, held: NDArray[np.bool_], blocks: Sequence[tuple[Cells, Array]]) -> None:
    """Refuse pieces that no support holds in some component."""
    n = len(held)
    tying = [cells[matrices.any(axis=(1, 2))] for cells, matrices in blocks]
    pairs = np.concatenate([np.stack([c[:, 0], c[:, k]], axis=1) for c in tying for k in range(1, c.shape[1])])
    links = sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(n, n))
    piece = connected_components(links, directed=False)[1]
    for component in range(3):
        loose = np.flatnonzero(~np.isin(piece, piece[held[:, component]]))
        if len(loose):
            where = validation.format_point(structure.points[loose[0]])
            raise ValueError(
                f"Node {loose[0]} at {where} is tied by no stress to a held node in {'xyz'[component]}; support one of "
                "its piece, or give its parts a prestress."
            )
