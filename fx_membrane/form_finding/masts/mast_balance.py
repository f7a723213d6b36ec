"""Shapes in which the forces of free masts balance, where the steps of form finding find none."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ...assembly.problem import Problem
from ...model.loads import PointLoad
from ...model.stages import Stage
from ...model.structure import Structure
from ...model.supports import Support
from ...results.states import StageResult
from ...runtime.processes import together
from ...solvers.progress import Pulse
from .bar_balance import balanced_points, has_free_masts
from .mast_heads import balanced_heads, free_heads, with_thrusts

Array = NDArray[np.float64]
Step = Callable[[Array, int], StageResult]  # state by a shape, shape (n, 3) [m], and the number of the step


class Balance(NamedTuple):
    """A shape in balance, and how form finding goes on from there.

    Attributes:
        points: The shape, shape (n, 3) [m].
        structure: The structure whose steps go on.
        steps: Limit of their number.
    """

    points: Array
    structure: Structure
    steps: int


def balance_masts(
    structure: Structure,
    stage: Stage,
    stepper: Callable[[Structure], Step],
    fits: Callable[[Array, StageResult], bool],
    pulse: Pulse,
    comm: MPI.Intracomm,
    max_iterations: int,
    collapse: str,
) -> Balance | None:
    """Find a shape in which the forces of free masts balance; None without these masts, or for bars alone.

    Args:
        structure: The first shape, with the forces prescribed.
        stage: The loads.
        stepper: Makes steps of form finding of a structure.
        fits: Tells if the state of a step from a shape is accepted.
        pulse: Told how far the search is.
        comm: The processes that share the work.
        max_iterations: Limit of steps from a balance of bars, or of moves of the heads.
        collapse: Sentences on the collapse without a search.

    Raises:
        RuntimeError: None was found; see `balanced_heads`.
    """
    if has_free_masts(structure) and all(isinstance(load, PointLoad) for load in stage.loads):
        loads = Problem(structure, comm, elastic=False).actions_of(stage).loads
        with together(comm):
            found = balanced_points(structure, loads, pulse) if comm.rank == 0 else None
        points: Array | None = comm.bcast(found)
        return None if points is None else Balance(points, structure, max_iterations)
    heads = free_heads(structure)
    if not len(heads):
        return None
    step = stepper(replace(structure, supports=[*structure.supports, Support(heads)]))
    thrusting, numbers = with_thrusts(structure), count(1)
    free_step = stepper(thrusting)

    def held(points: Array) -> tuple[Array, Array]:
        state = step(points, next(numbers))
        return points + state.displacement, state.reactions

    def stays(points: Array) -> bool:
        try:
            return fits(points, free_step(points, 1))
        except RuntimeError:
            return False

    shape = balanced_heads(structure, held, stays, pulse, max_iterations, collapse)
    return Balance(shape, thrusting, 1)
