"""Rigid-body motions that supports leave free."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..geometry.topology import connected
from . import term_parameters
from .energy_terms import Term
from .parts import Mast
from .structure import Structure

MOTIONS = ("move along x", "move along y", "move along z", "turn about x", "turn about y", "turn about z")


def check_supports(structure: Structure, held: NDArray[np.bool_], terms: Sequence[Term] = ()) -> None:
    """Refuse a structure with a connected piece that can move as a rigid body.

    One free turn is allowed, as of a cable or a banner about the line between its two anchors. Loads and prestress can
    hold it, and the solver reports if they do not.

    Args:
        structure: The structure.
        held: Constrained components of the nodes, shape (n, 3).
        terms: Energy terms that act beside those of the structure. They may hold a piece, as an elastic bed does: the
            solver reports if they do not.

    Raises:
        ValueError: A piece is free; the message names a node, the parts of the piece and the motion, or the free end of
            a mast.
    """
    on_terms = term_parameters.touched(structure, [*structure.terms, *terms])
    _check_masts(structure, held | on_terms[:, None])
    pieces = _pieces(structure)
    for nodes in pieces:
        if on_terms[nodes].any():
            continue
        motions = free_motions(structure.points[nodes], held[nodes])
        translates = np.linalg.norm(motions[:, 3:], axis=1) < 1e-6
        if len(motions) > 1 or translates.any():
            named = motions[translates] if translates.any() else motions * ([0, 0, 0, 1, 1, 1])
            freest = MOTIONS[int(np.argmax(np.sum(named**2, axis=0)))]
            join = ", or join it to the rest, with which it shares no node" if len(pieces) > 1 else ""
            raise ValueError(
                f"The structure is not supported enough: the piece with node {nodes[0]} ({counted(len(nodes), 'node')}"
                f": {_named(structure, nodes)}) can {freest} as a rigid body. Add supports or prescribed displacements "
                f"there{join}."
            )


def _pieces(structure: Structure) -> list[NDArray[np.intp]]:
    """Nodes of each connected piece, ascending."""
    used = np.flatnonzero(structure.used)
    piece = connected([part.cells for part in structure.parts.values()], np.ones(len(structure.points), dtype=bool))
    label = piece.nodes[used]
    order = np.argsort(label, kind="stable")
    return np.split(used[order], np.flatnonzero(np.diff(label[order])) + 1)


def _named(structure: Structure, nodes: NDArray[np.intp]) -> str:
    """List the parts of a connected piece, with the first cells of those that are only partly in it."""
    found = []
    for name, part in structure.parts.items():
        cells = np.flatnonzero(np.isin(part.cells[:, 0], nodes))
        if len(cells):
            some = ", ".join(map(str, cells[:3])) + (", ..." if len(cells) > 3 else "")
            which = "" if len(cells) == len(part.cells) else f" (cells {some})"
            found.append(f"{type(part).__name__} {name!r}{which}")
    return ", ".join(found)


def _check_masts(structure: Structure, held: NDArray[np.bool_]) -> None:
    for name in structure.parts_of(Mast):
        for cell, node in loose_ends(structure, name, held)[:1]:
            raise ValueError(
                f"Mast {cell} of {name!r} ends nowhere: no other part and no support is at node {node}. "
                "Support the node, or join it to a part."
            )


def loose_ends(structure: Structure, name: str, held: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Cells of masts or cables with a free, unconnected end, and the nodes there.

    A mast cannot stand on one node. A cable can hang from its other end, by a weight; without one it carries nothing.
    """
    meeting = sum(np.bincount(part.cells.ravel(), minlength=len(structure.points)) for part in structure.parts.values())
    cells = structure.parts[name].cells
    loose = (np.asarray(meeting)[cells] == 1) & ~held[cells].any(axis=2)
    return [(int(cell), int(cells[cell, end])) for cell, end in np.argwhere(loose)]


def free_motions(points: NDArray[np.float64], held: NDArray[np.bool_]) -> NDArray[np.float64]:
    """Free rigid motions, orthonormal, shape (motions, 6).

    Each row is three translations and three rotations about the centre of the points. Lengths are scaled to the largest
    distance from it. A motion that moves no point, as the turn of a straight cable about itself, is left out.

    Args:
        points: Positions, shape (n, 3) [m].
        held: Constrained components, shape (n, 3).
    """
    arm = points - points.mean(axis=0)
    arm = arm / max(np.abs(arm).max(), np.finfo(float).tiny)
    some = held.any(axis=1)
    moves = np.broadcast_to(np.eye(3), (int(np.count_nonzero(some)), 3, 3))
    resisted = np.concatenate([moves, _turns(arm[some])], axis=2)[held[some]]
    stiffness, directions = np.linalg.eigh(resisted.T @ resisted)
    free = directions[:, stiffness <= 1e-12 * max(len(resisted), 1)]
    amount, combinations = np.linalg.eigh(free.T @ _squares(arm) @ free)
    return np.asarray((free @ combinations[:, amount > 1e-10 * len(points)]).T)


def _turns(arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Displacements of points by turns about the axes, one in each column, shape (n, 3, 3)."""
    return np.cross(np.eye(3), arm[:, None, :]).swapaxes(1, 2)


def _squares(arm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Products of the displacements of all points in two motions, summed, shape (6, 6); from moments, in one pass."""
    products, sums = arm.T @ arm, _turns(arm.sum(axis=0)[None])[0]
    return np.block([[len(arm) * np.eye(3), sums], [sums.T, np.trace(products) * np.eye(3) - products]])
