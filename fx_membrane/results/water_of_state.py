"""State of the water on membranes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..assembly.acting_ponds import amount_of
from ..assembly.actions import pond_of
from ..assembly.pond_cells import Water
from ..assembly.problem_under_actions import LoadedProblem
from ..assembly.water import PondEnergy
from ..model.basins import VOLUME_ROUNDING
from ..model.ponds import triangles_of
from ..model.water_events import BasinResult
from .forces_of_state import PondResult


def pond_results(problem: LoadedProblem, x: PETSc.Vec) -> tuple[PondResult, ...]:
    """State of the water of all ponds, of those that share their cells together; collective."""
    groups = _by_group(problem)
    if not groups:
        return ()
    heights = (problem.structure.points + problem.discretization.to_numpy(x))[:, 2]
    return tuple(_result(problem, number, energies, x, heights) for number, energies in enumerate(groups))


def basins_of_state(problem: LoadedProblem, x: PETSc.Vec) -> tuple[BasinResult, ...]:
    """Rain in the basins of all ponds; collective."""
    groups = enumerate(_by_group(problem))
    return tuple(
        _basin(number, energy, energy.water(x))
        for number, energies in groups
        for energy in energies
        if energy.basin is not None
    )


def _by_group(problem: LoadedProblem) -> list[list[PondEnergy]]:
    """Energies of ponds that share their cells, together."""
    groups: dict[int, list[PondEnergy]] = {}
    for energy in problem.integrals.all:
        if isinstance(energy, PondEnergy):
            groups.setdefault(id(energy.waters), []).append(energy)
    return [*groups.values()]


def _basin(number: int, energy: PondEnergy, found: Water) -> BasinResult:
    outlets = energy.outlets
    assert energy.basin is not None
    return BasinResult(
        part=energy.pond.part,
        pond=number,
        node=energy.basin.found.node,
        level=found.level,
        volume=found.volume,
        area=found.area if found.volume > 0 else 0.0,
        spill=int(outlets[0]) if len(outlets) else -1,
        is_full=found.is_capped,
    )


def _result(
    problem: LoadedProblem, number: int, energies: list[PondEnergy], x: PETSc.Vec, heights: NDArray[np.float64]
) -> PondResult:
    pond, waters = pond_of(energies[0].waters), [energy.water(x) for energy in energies]
    depth = np.zeros(len(heights))
    for energy, found in zip(energies, waters, strict=True):
        nodes = np.unique(energy.cells.triangles)
        depth[nodes] = np.maximum(depth[nodes], found.level - heights[nodes])
    volume, area = (sum(getattr(found, name) for found in waters) for name in ("volume", "area"))
    if energies[0].basin is None:
        lost = max(energies[0].amount - volume, 0.0) if waters[0].is_capped else 0.0
        basins: tuple[BasinResult, ...] = ()
    else:
        total = amount_of(problem.structure, energies[0].waters)
        lost = total - volume if total - volume > VOLUME_ROUNDING * total else 0.0
        basins = tuple(_basin(number, energy, found) for energy, found in zip(energies, waters, strict=True))
    level = max(waters, key=lambda found: found.volume).level
    pieces = _pieces(triangles_of(problem.structure, pond), depth)
    return PondResult(pond, level, volume, area, lost, depth, pieces, basins)


def _pieces(triangles: NDArray[np.int64], depth: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the number of the wet piece of each node, -1 where it is dry, shape (n,): wet nodes joined by edges."""
    wet = depth > 0
    a, b = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]).T
    joined = wet[a] & wet[b]
    count = len(depth)
    graph = sparse.coo_matrix((np.ones(joined.sum()), (a[joined], b[joined])), shape=(count, count))
    labels = connected_components(graph, directed=False)[1]
    pieces = np.full(count, -1)
    pieces[wet] = np.unique(labels[wet], return_inverse=True)[1]
    return pieces
