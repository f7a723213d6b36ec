"""Ends of masts that can move freely: all that could hold them is slack, or lies in one plane with them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.extremes import first_largest
from ..geometry.sizes import measures
from ..model.parts import Bar, Mast
from ..model.term_parameters import touched
from ..solvers.curvature import MODES
from .slack_forces import LIMIT, compression, rounding
from .states import StageResult

Array = NDArray[np.float64]

MANY_NODES = 300  # nodes above which they are not moved together: dense eigenvalues would take seconds


class Loose(NamedTuple):
    """An end of a mast that moves freely.

    Attributes:
        node: The node.
        direction: The direction in which it is free, shape (3,).
        slack: True if a slack cell ends there, and every member that could hold it is slack.
    """

    node: int
    direction: Array
    slack: bool


class _Ends(NamedTuple):
    """Nodes at which masts, cables, fabric in tension, slack cells and forces meet, shape (n,)."""

    mast: NDArray[np.bool_]
    cable: NDArray[np.bool_]
    fabric: NDArray[np.bool_]
    slack: NDArray[np.bool_]
    pressed: NDArray[np.bool_]


def loose_masts(result: StageResult) -> list[Loose]:
    """Find ends of masts that nothing holds in some direction.

    At a slack cell, a node counts only if it gives way while all nodes beside it stand still; where all is without
    force, as before anything is applied, cables count as holding. Other ends of cables may give way together, as two
    masts in one plane with their guys do. Joints of masts alone are none: solvers meet the missing stiffness
    themselves.
    """
    if not result.structure.parts_of(Mast):
        return []
    ends = _ends(result)
    could = ends.mast & ~ends.fabric & ~result.actions.held.all(axis=1)
    could &= ~touched(result.structure, result.structure.terms)  # an elastic bed may hold them
    blocks = np.zeros((len(could), 3, 3))
    for name, bar in result.structure.parts_of(Bar).items():
        np.add.at(blocks, bar.cells, _bar_tangent(result, name, bar)[:, None])
    nodes = np.flatnonzero(could & np.where(ends.slack, ends.pressed, ends.cable))
    own, free = blocks[nodes], ~result.actions.held[nodes]
    own = own * (free[:, :, None] & free[:, None, :])
    scale = np.abs(own).max(axis=(1, 2), initial=0.0)
    own[:, range(3), range(3)] += np.where(free, 0.0, scale[:, None])
    values, directions = np.linalg.eigh(own)
    found = [
        Loose(int(nodes[i]), directions[i, :, 0], bool(ends.slack[nodes[i]]))
        for i in np.flatnonzero(values[:, 0] <= MODES.free * scale)
    ]
    return found or _together(result, np.flatnonzero(could & ends.cable & ~ends.slack))


def _ends(result: StageResult) -> _Ends:
    ends = _Ends(*(np.zeros(len(result.structure.points), dtype=bool) for _ in _Ends._fields))
    for name, part in result.structure.parts.items():
        loose = result.parts[name].slack
        ends.slack[part.cells[loose]] = True
        ends.pressed[part.cells[compression(result, name) > rounding(result, name)]] = True
        if name in result.membranes:
            ends.fabric[part.cells[~loose]] = True
        elif part.is_strut:
            ends.mast[part.cells] = True
            ends.pressed[part.cells[result.bars[name].force < -LIMIT * rounding(result, name)]] = True
        else:
            ends.cable[part.cells] = True
    return ends


def _together(result: StageResult, nodes: NDArray[np.int64]) -> list[Loose]:
    """Find the node that moves most in a free motion of some nodes while all others stand still."""
    if not 1 < len(nodes) <= MANY_NODES:
        return []
    row = np.full(len(result.structure.points), -1)
    row[nodes] = np.arange(len(nodes))
    blocks = np.zeros((len(nodes), len(nodes), 3, 3))
    for name, bar in result.structure.parts_of(Bar).items():
        tangent, rows = _bar_tangent(result, name, bar), row[bar.cells]
        for i, j in np.ndindex(2, 2):
            here = (rows[:, [i, j]] >= 0).all(axis=1)
            np.add.at(blocks, (rows[here, i], rows[here, j]), tangent[here] if i == j else -tangent[here])
    free = np.flatnonzero(~result.actions.held[nodes])
    values, motions = np.linalg.eigh(blocks.transpose(0, 2, 1, 3).reshape(3 * len(nodes), -1)[np.ix_(free, free)])
    motion = np.zeros((len(nodes), 3))
    motion.flat[free] = motions[:, 0]
    most = first_largest(np.linalg.norm(motion, axis=1))
    if values[0] > MODES.free * np.abs(blocks[most, most]).max():
        return []
    return [Loose(int(nodes[most]), motion[most] / np.linalg.norm(motion[most]), slack=False)]


def _bar_tangent(result: StageResult, name: str, part: Bar) -> Array:
    """Stiffness of each cable or mast at one end while the other stands still, 0 if slack, (cells, 3, 3) [N/m]."""
    state = result.parts[name]
    x = result.position[part.cells]
    way = x[:, 1] - x[:, 0]
    along = part.axial_stiffness / measures(result.structure.points, part.cells) ** 3
    across = state.principal[:, 0] / np.maximum(np.linalg.norm(way, axis=1), 1e-300)
    dyads = way[:, :, None] * way[:, None, :]
    tangent = across[:, None, None] * np.eye(3) + along[:, None, None] * dyads
    return np.where(state.slack[:, None, None], 0.0, tangent)
