"""Balance of membranes of given stress in a reference, bars of given force densities, and loads on their shape."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import grown_slender, measures
from ...model.loads import PointLoad, per_size
from ...model.parts import Part
from ...model.structure import Structure
from ..constraints.motions import Motions
from ..form_loads import words_of_loads
from ..plan import Plan, cauchy, place
from .linear_balance import LinearBalance

Array = NDArray[np.float64]


def balanced(
    structure: Structure,
    loads: Sequence[Any],
    start: Array,
    plans: Mapping[str, Plan],
    densities: Mapping[str, Array],
    motions: Motions | None = None,
) -> tuple[Array, Array]:
    """Shape in equilibrium with stress and force densities, and its reactions, both of shape (n, 3)."""
    line = np.array([[1.0, -1.0], [-1.0, 1.0]])
    blocks = [(plan.cells, plan.stiffness()) for plan in plans.values()]
    blocks += [(structure.parts[name].cells, q[:, None, None] * line) for name, q in densities.items()]
    balance = LinearBalance(structure, blocks, motions)
    return balance.solve(start, lambda points: nodal_loads(structure, loads, points), words_of_loads(loads))


def nodal_loads(structure: Structure, loads: Sequence[Any], points: Array) -> Array:
    """Spread loads on the nodes of a shape, shape (n, 3) [N]; an array is that of forces on all nodes."""
    total = np.zeros(points.shape)
    for load in loads:
        if isinstance(load, np.ndarray):
            total += load
            continue
        if isinstance(load, PointLoad):
            total[np.asarray(load.nodes)] += np.asarray(load.force)
            continue
        cells = loaded_cells(structure, load)
        force = cell_loads(load, points, cells)
        for corner in cells.T:
            np.add.at(total, corner, force / cells.shape[1])
    return total


def loaded_cells(structure: Structure, load: Any) -> NDArray[np.int64]:
    """Nodes of the cells under a distributed load, shape (cells, nodes of a cell)."""
    cells = structure.parts[load.part].cells
    return cells if load.cells is None else cells[np.asarray(load.cells)]


def cell_loads(load: Any, points: Array, cells: NDArray[np.int64]) -> Array:
    """Spread a distributed load on the cells of a shape, shape (cells, 3) [N]."""
    return np.asarray(measures(points, cells)[:, None] * per_size(load, points, cells))


def collapse_of(structure: Structure, points: Array, only_bars: bool = False) -> str:
    """Tell of a cell that has shrunk to nothing, in words; empty without one."""
    for name, part in (structure.bars if only_bars else structure.parts).items():
        gone = grown_slender(points, part.cells, structure.points)
        if len(gone):
            return (
                f"part {name!r}, cell {gone[0]} shrinks to nothing at {place(points, part.cells, gone[0])}: the forces "
                "around it pull its nodes together; hold one of them, or change the forces there."
            )
    return ""


def stressed(
    structure: Structure,
    points: Array,
    plans: Mapping[str, Plan],
    densities: Mapping[str, Array],
    warps: Mapping[str, Array] | None = None,
) -> tuple[dict[str, Part], dict[str, Array]]:
    """Parts with the forces in a shape as prestress, and these forces; warps are unit tangents in it, by membrane."""
    parts: dict[str, Part] = {}
    forces: dict[str, Array] = {}
    membranes, bars = structure.membranes, structure.bars
    for name in structure.parts:
        if name in membranes:
            forces[name], warp = cauchy(plans[name], points, (warps or {}).get(name))
            parts[name] = replace(membranes[name], prestress=forces[name], warp=warp)
        else:
            forces[name] = densities[name] * measures(points, bars[name].cells)
            parts[name] = replace(bars[name], prestress=forces[name])
    return parts, forces
