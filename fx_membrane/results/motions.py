"""Nodes that have moved far and masts that have tilted since the start of a stage, in words.

Prescribed motion is meant: only motion beyond it counts.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.extremes import first_largest
from ..geometry.sizes import lengths
from ..model.parts import Mast
from ..model.structure import Structure
from ..solvers.base import LIMITS
from .pieces import Pieces
from .states import StageResult

Array = NDArray[np.float64]

TILTED = 15.0  # angle [degrees] by which no mast leans that its stays hold: a quarter of its length
SHOWN = 3  # masts that are named


class Motion(NamedTuple):
    """Motion that no structure makes which is held, in words; empty where there is none.

    Attributes:
        moved: The node that moved by more than `LIMITS.fallen` of the size of the piece that is connected with it.
        tilted: The masts whose axes have turned by more than `TILTED`.
    """

    moved: str = ""
    tilted: str = ""

    def __str__(self) -> str:
        return " and ".join(filter(None, self))


def motion_of(result: StageResult, start: Array | None) -> Motion:
    """Find nodes and masts that moved far since the start of a stage.

    Args:
        result: A state.
        start: Displacements at the start of its stage, shape (n, 3) [m]; None where motion is not to be judged.
    """
    return Motion() if start is None else Motion(_moved(result, start), _tilted(result, start))


def _moved(result: StageResult, start: Array) -> str:
    """Name the node that moved further than prescribed displacements in the same piece."""
    structure, held, motion = result.structure, result.actions.held, result.displacement - start
    moved, given = (lengths(np.where(where, motion, 0.0)) for where in (~held, held))
    pieces = Pieces(structure, held.all(axis=1))
    far = (LIMITS.fallen * _sizes(structure, pieces) + _largest(given, structure, pieces))[pieces.nodes]
    beyond = np.where(structure.used & ~held.all(axis=1), moved - far, -np.inf)
    node = first_largest(beyond)
    return f"node {node} moved by {moved[node]:.3g}" if beyond[node] > 0 else ""


def _sizes(structure: Structure, pieces: Pieces) -> Array:
    """Largest extent of each piece along an axis, with the held nodes that it reaches, shape (pieces,) [m]."""
    high = _largest(structure.points, structure, pieces)
    low = -_largest(-structure.points, structure, pieces)
    return np.where(np.isfinite(high), high - low, 0.0).max(axis=1)


def _largest(values: Array, structure: Structure, pieces: Pieces) -> Array:
    """Largest of nodal values, shape (n, ...), among the nodes of the cells of each piece, shape (pieces, ...)."""
    columns = values.reshape(len(values), -1).T
    largest = np.full((len(columns), pieces.count), -np.inf)
    for name, part in structure.parts.items():
        for column, found in zip(columns, largest, strict=True):  # of one column, a maximum is many times faster
            of_cells = np.maximum.reduce([column.take(corner) for corner in part.cells.T])
            np.maximum.at(found, pieces.cells[name], of_cells)
    return largest.T.reshape(pieces.count, *values.shape[1:])


def _tilted(result: StageResult, start: Array) -> str:
    """Name masts that tilted: the first of each part, the node that moved more, its angle and its distance."""
    motion = result.displacement - start
    given, said = np.where(result.actions.held, motion, 0.0), []
    for name, part in result.structure.parts_of(Mast).items():
        before = np.diff((result.structure.points + start)[part.cells], axis=1)[:, 0]
        turned, prescribed = (_angles(before, before + np.diff(u[part.cells], axis=1)[:, 0]) for u in (motion, given))
        beyond = turned - prescribed
        if beyond.max() > TILTED:
            cell = first_largest(beyond)
            node = part.cells[cell, first_largest(lengths(motion[part.cells[cell]]))]
            said.append(
                f"mast {name!r} (cell {cell}) has tilted by {turned[cell]:.0f} degrees, its node {node} moved by "
                f"{np.linalg.norm(motion[node]):.3g}"
            )
    return " and ".join(said[:SHOWN])


def _angles(a: Array, b: Array) -> Array:
    """Angles between the rows of two arrays of shape (n, 3), shape (n,) [degrees]."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1)))
