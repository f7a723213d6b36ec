"""Equilibrium of given force densities: one symmetric system for each coordinate of the nodes, or for all of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.linalg import null_space
from scipy.sparse.csgraph import connected_components

from ...checks import validation
from ...model.structure import Structure
from ..constraints.motions import Motions, carried, motions_of
from .component_solve import ComponentSolve
from .coupled_solve import CoupledSolve
from .load_settling import LoadSettling

Array = NDArray[np.float64]
Cells = NDArray[np.int64]

REPEATS = 400  # maximum number of solves for loads that follow the shape: enough where each leaves 92 % of the change
MAX_DISPLACEMENT = 1e3  # displacement over size of the start, above which loads that still change grow without bound


class LinearBalance:
    """Balance K x = f of the nodes of a structure, factorized once for all loads.

    Args:
        structure: The structure; its supports hold nodes where they are.
        blocks: Cells and their matrices, shapes (cells, k) and (cells, k, k) [N/m]; zero ones tie nothing.
        motions: Free motions of the nodes of that structure; those that its supports leave, if not given.

    Raises:
        ValueError: Nodes are tied to no held node in some component, or the system is singular up to rounding.
    """

    def __init__(
        self, structure: Structure, blocks: Sequence[tuple[Cells, Array]], motions: Motions | None = None
    ) -> None:
        self.motions = motions_of(structure) if motions is None else motions
        self.matrix = _assembled(len(structure.points), blocks)
        _check_ties(structure, self.motions, blocks)
        _check_bodies(structure.points, self.motions, self.matrix)
        coupled = CoupledSolve if self.motions.couple else ComponentSolve
        self._solve = coupled(structure, self.matrix, self.motions)

    def solve(self, start: Array, loads: Callable[[Array], Array], of: str = "") -> tuple[Array, Array]:
        """Find the shape in balance with the loads on it, and its reactions, both of shape (n, 3).

        Args:
            start: Shape with the held nodes in place, shape (n, 3) [m].
            loads: Function of the shape, which returns forces on the nodes, shape (n, 3) [N].
            of: The loads in words, for messages.

        Raises:
            RuntimeError: The loads do not settle.
        """
        force, shape, have_settled = loads(start), start, LoadSettling()
        for _ in range(REPEATS):
            shape = self._solve(shape, force)
            before, force = force, loads(shape)
            if have_settled(before, force):
                return shape, self.motions.reactions(self.matrix @ shape - before)
            if np.abs(shape - start).max() > MAX_DISPLACEMENT * np.ptp(start, axis=0).max():
                break
        node = int(np.abs(shape - start).max(axis=1).argmax())
        raise RuntimeError(
            f"Form finding found no shape for the loads{f', {of}' * bool(of)}: they grow with the form faster than the "
            f"stress can hold, most at node {node}, {validation.format_point(start[node])}. Give a larger stress or "
            "smaller loads."
        )


def _assembled(n: int, blocks: Sequence[tuple[Cells, Array]]) -> sparse.csr_matrix:
    rows = np.concatenate([np.repeat(cells, cells.shape[1], axis=1).ravel() for cells, _ in blocks])
    columns = np.concatenate([np.tile(cells, (1, cells.shape[1])).ravel() for cells, _ in blocks])
    values = np.concatenate([matrices.ravel() for _, matrices in blocks])
    return sparse.coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()


def _check_ties(structure: Structure, motions: Motions, blocks: Sequence[tuple[Cells, Array]]) -> None:
    """Refuse pieces that no support holds in some component."""
    n = len(structure.points)
    tying = [cells[matrices.any(axis=(1, 2))] for cells, matrices in blocks]
    tying += [body.nodes[None] for body in motions.bodies]
    pairs = np.concatenate([np.stack([c[:, 0], c[:, k]], axis=1) for c in tying for k in range(1, c.shape[1])])
    links = sparse.coo_matrix((np.ones(len(pairs)), pairs.T), shape=(n, n))
    piece = connected_components(links, directed=False)[1]
    held = motions.held | motions.reacting
    for component in range(3):
        holding = held[:, component].copy()
        for body in motions.bodies:
            holding[body.nodes] = structure.supported[body.nodes, component]
        loose = np.flatnonzero(~np.isin(piece, piece[holding]))
        if len(loose):
            where = validation.format_point(structure.points[loose[0]])
            raise ValueError(
                f"Node {loose[0]} at {where} is tied by no stress to a held node in {'xyz'[component]}; support one of "
                "its piece, or give its parts a prestress."
            )


def _check_bodies(points: Array, motions: Motions, matrix: sparse.csr_matrix) -> None:
    """Refuse bodies that can move without any node that a stress ties, as a mast its foot on a rail.

    Raises:
        ValueError: There is one.
    """
    tied = matrix.diagonal() != 0
    for body in motions.bodies:
        moved = carried(body.coordinates[tied[body.nodes]]) @ body.ways
        loose = body.ways @ null_space(np.vstack([moved, np.zeros((1, body.ways.shape[1]))]))
        if loose.shape[1]:
            moves = np.abs(carried(body.coordinates) @ loose).max(axis=1).reshape(-1, 3)
            row, component = np.unravel_index(moves.argmax(), moves.shape)
            node, axis = body.nodes[row], "xyz"[component]
            raise ValueError(
                f"{body.label} can move node {node} at {validation.format_point(points[node])} in {axis}, where no "
                f"stress ties it; support the node in {axis}, or tie it by a cable with a prestress. For a mast on a "
                "rail, hold its head, and add mast and tie by masts_and_stays."
            )
