"""Forces of cables that balance the stress of membranes along them in plan.

A stress N in plan pulls at an edge of unit normal v and tangent t. Its cable of the force T and the radius R balances
T / R = v N v and dT/ds = -t N v. Only where N is equal in all directions is T constant and the edge an arc. A constant
N makes it part of an ellipse.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import lengths
from ...model.parts import Cable, Part
from ...model.structure import Structure
from ..constraints.cable_lines import Line, lines_of
from ..plan import Plan, place

Array = NDArray[np.float64]


def with_balanced_forces(structure: Structure, plans: Mapping[str, Plan], axes: Array) -> Structure:
    """Structure with horizontal forces of cables that balance the stress along them; each line keeps its mean.

    Args:
        structure: The structure in plan.
        plans: Its membranes in plan.
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].

    Raises:
        ValueError: The force of a cable would not be a tension everywhere.
    """
    parts: dict[str, Part] = dict(structure.parts)
    for name, given, forces, line in _lines(structure, plans, axes):
        cell = int(forces.argmin())
        if forces[cell] <= 0:
            where = place(structure.points, structure.parts[name].cells, line.cells[cell])
            raise ValueError(
                f"Cable {name!r} has no tension in cell {line.cells[cell]} at {where} with forces of the mean "
                f"{given:.4g} that balance the stress along it; give more than {given - forces[cell]:.4g}."
            )
        bar = parts[name]
        all_forces = bar.prestress_tensors().ravel().copy()
        all_forces[line.cells] = forces
        parts[name] = replace(bar, prestress=all_forces)
    return replace(structure, parts=parts)


def unbalanced_edge(structure: Structure, plans: Mapping[str, Plan], axes: Array) -> tuple[float, str]:
    """Largest range of the force in balance with the stress along a cable, over its mean [-], and its place."""
    worst, words = 0.0, ""
    for name, given, forces, line in _lines(structure, plans, axes):
        if np.ptp(forces) > worst * given:
            middle = line.cells[len(line.cells) // 2]
            where = place(structure.points, structure.parts[name].cells, middle)
            worst, words = float(np.ptp(forces) / given), f"cable {name!r} around {where}"
    return worst, words


def _lines(structure: Structure, plans: Mapping[str, Plan], axes: Array) -> list[tuple[str, float, Array, Line]]:
    """Lines of cables with their part, their mean force [N] and their forces in balance, shape (cells,) [N]."""
    flat, pull = structure.points @ axes[:, :2], np.zeros((len(structure.points), 2))
    for plan in plans.values():
        np.subtract.at(pull, plan.cells, plan.stiffness() @ flat[plan.cells])
    bars = list(structure.bars.values())
    count = sum(
        (np.bincount(bar.cells[bar.prestress_tensors().ravel() != 0].ravel(), minlength=len(flat)) for bar in bars),
        start=np.zeros(len(flat), dtype=np.int64),
    )
    stops, found = structure.supported.any(axis=1) | (count != 2), []
    for name, bar in structure.parts_of(Cable).items():
        given = bar.prestress_tensors().ravel()
        for line in lines_of(bar.cells, np.flatnonzero(given > 0), stops) if given.any() else []:
            way = np.diff(flat[line.nodes], axis=0)
            length = lengths(way)
            twice = way[1:] / length[1:, None] + way[:-1] / length[:-1, None]  # along the bisector of two segments
            change = -2 * np.sum(pull[line.nodes[1:-1]] * twice, axis=1) / np.sum(twice**2, axis=1)
            forces = np.concatenate([[0.0], np.cumsum(change)])
            mean = float(given[line.cells] @ length / length.sum())
            found.append((name, mean, forces + mean - forces @ length / length.sum(), line))
    return found
