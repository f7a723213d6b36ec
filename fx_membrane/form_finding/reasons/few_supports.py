"""Supports too few for a form: held nodes at one place or on one line, onto which tension pulls all the rest.

Without loads and thrusts each coordinate of a free node is a mean of those around it. So a form lies within the
smallest convex region around its held nodes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...checks.values import format_point
from ...model.structure import Structure
from ..constraints.kinds import NodeConstraint

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Mask = NDArray[np.bool_]

ALL_HELD = ("All nodes are held, so the form is the first shape; take supports from the nodes to be found.",)
ZERO_EXTENT = 1e-9  # extent over that of the first shape, that counts as none


def check_supports_of_form(structure: Structure, loads: Sequence[object], constraints: Sequence[object] = ()) -> None:
    """Refuse a structure that its tension pulls onto one place or one line; not under loads, which may spread it.

    Raises:
        ValueError: The held nodes of a piece are at one place, or on one line if it has membranes or meshes.
    """
    bars = list(structure.bars.values())
    if any(not isinstance(load, np.ndarray) or load.any() for load in loads) or any(
        (bar.prestress_tensors() < 0).any() for bar in bars
    ):
        return
    held = structure.supported.copy()
    for constraint in constraints:
        if isinstance(constraint, NodeConstraint):
            held[np.asarray(constraint.nodes)] = True
    surfaces = [part.cells for part in structure.membranes.values()]
    lines = [part.cells for part in structure.bars.values()]
    check_spread(structure.points, held, surfaces, lines)


def check_spread(
    points: Array, held: Mask, surfaces: Sequence[Numbers], lines: Sequence[Numbers], what: str = "The piece"
) -> None:
    """Refuse pieces that tension pulls onto one place or one line; see `check_supports_of_form`.

    Args:
        points: The first shape, shape (n, 3) [m].
        held: Held components, shape (n, 3).
        surfaces: Cells of membranes, each of shape (cells, 3).
        lines: Cells of bars, each of shape (cells, 2).
        what: Name of a piece in messages.
    """
    sides = [cells[:, [k, (k + 1) % 3]] for cells in surfaces for k in range(3)]
    none = np.zeros((0, 2), dtype=np.int64)
    ties = np.unique(np.sort(np.concatenate([none, *sides, *lines]), axis=1), axis=0)
    links = sparse.coo_matrix((np.ones(len(ties)), ties.T), shape=(len(points), len(points)))
    piece = connected_components(links, directed=False)[1]
    for number in np.unique(piece[ties]):
        nodes = np.flatnonzero(piece == number)
        has_meshes = bool(np.count_nonzero(piece[ties[:, 0]] == number) >= len(nodes))
        words = _unspread(points[nodes], held[nodes], has_meshes)
        if words:
            raise ValueError(f"{what} with node {nodes[0]} at {format_point(points[nodes[0]])} is held {words}")


def all_held(structure: Structure) -> tuple[str, ...]:
    """Remark on a structure without a free node; empty for all others."""
    if (structure.supported | ~structure.used[:, None]).all():
        return ALL_HELD
    return ()


def _unspread(points: Array, held: Mask, has_meshes: bool) -> str:
    """Tell of the place or the line at which a piece is held, in words; empty if its held nodes spread it."""
    if not held.any(axis=0).all():  # told as a piece without hold
        return ""
    least = ZERO_EXTENT * np.ptp(points, axis=0).max()
    varies = [component for component in range(3) if np.ptp(points[held[:, component], component]) > least]
    if not varies:
        place = np.array([points[held[:, component], component].mean() for component in range(3)])
        return (
            f"at one place only, {format_point(place)}, to which its tension pulls all of it without loads; hold nodes "
            "at other places, too."
        )
    alike = all(np.array_equal(held[:, component], held[:, varies[0]]) for component in varies)
    place = points[held[:, varies[0]]]
    offset = place[:, varies] - place[:, varies].mean(axis=0)
    if not has_meshes or not alike or (len(varies) > 1 and np.linalg.svd(offset)[1][1] > least):
        return ""
    first, last = place[[offset[:, 0].argmin(), offset[:, 0].argmax()]]
    return (
        f"on one line only, from {format_point(first)} to {format_point(last)}, onto which its tension pulls all of it "
        "without loads; hold nodes beside that line, too."
    )
