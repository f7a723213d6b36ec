"""Lines of cables of given geometry in Newton's equations: their forces are unknowns, and their geometry equations.

With a force that stays from step to step, force and shape correct each other in turn: steep forms never settle.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...geometry.vector_columns import columns, lengths, rows
from ..constraints.cable_geometry import Target, value
from ..constraints.kinds import EdgeAngle
from .cells import BarBlock
from .equilibrium import State
from .shape_derivatives import FIRST, slopes_by_shape
from .state import NearestProblem
from .system import Steered

Array = NDArray[np.float64]


def steered_lines(problem: NearestProblem, state: State) -> Steered:
    """Compute forces and geometry of the steered lines, by the problem at a state.

    An edge whose angle is below the largest one has the force of its prestress, and is none of them.
    """
    n = len(state.points)
    cables = problem.cables
    targets: Sequence[Target] = () if cables is None else cables.balance.targets.targets
    active = [one for one in targets if not _is_slack(one, state.points)]
    none = np.zeros((3 * n, len(active)))
    found = Steered(none, none.copy(), none.copy(), np.zeros(len(active)))
    forces = problem.bar_forces(state.points, state.densities) if active else {}
    for number, target in enumerate(active):
        cells = problem.structure.parts[target.part].cells[target.line.cells]
        force = forces[target.part][target.line.cells]
        block = BarBlock(cells, force, np.full(len(cells), np.inf))
        corners, there = columns(state.points[cells]), columns(state.multipliers[cells])
        length = lengths(corners[1] - corners[0])
        pulls, slopes = np.zeros((n, 3)), np.zeros((n, 3))
        np.add.at(pulls, cells, rows(block.forces(corners, there)))
        np.add.at(slopes, cells, rows(slopes_by_shape(block, corners, there, length)[1]))
        found.pulls[:, number], found.slopes[:, number] = pulls.ravel(), slopes.ravel()
        found.gradients[:, number] = _gradient(target, state.points, FIRST * float(length.mean()))
        found.gaps[number] = _off(target, state.points)
    return found


def _off(target: Target, points: Array) -> float:
    now, goal, _ = value(target.line, target.constraint, points)
    return now / goal - 1


def _is_slack(target: Target, points: Array) -> bool:
    return isinstance(target.constraint, EdgeAngle) and _off(target, points) < -FIRST


def _gradient(target: Target, points: Array, length: float) -> Array:
    """Derive the relative difference of the geometry from the wanted one by the shape, shape (3 n,) [1/m]."""
    found, moved = np.zeros_like(points), points.copy()
    for node in np.unique(target.line.nodes):
        for component in range(3):
            ends = []
            for sense in (1, -1):
                moved[node, component] = points[node, component] + sense * length
                ends.append(_off(target, moved))
            moved[node, component] = points[node, component]
            found[node, component] = (ends[0] - ends[1]) / (2 * length)
    return found.ravel()
