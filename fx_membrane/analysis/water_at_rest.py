"""Rain water at the end of a load increment: basins are found anew, and water runs until shape and water rest.

Within an increment the set of basins is given: cells, outlets, and the basin behind each outlet. Levels and volumes of
that set follow from the shape within Newton's method: levels at outlets that move, and water of full basins that spills
into others (`assembly.cascade`).

At the end of an increment the set is found anew, as an active set: basins merge and part, and outlets change. Where
that moves water, the same load factor is solved again from the shape found, at most `ROUNDS` times. Most increments
take one solution, and one more for each merger after another. All of them share the iterations that the solver allows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.acting_ponds import amount_of, pond_groups, water_of
from ..assembly.actions import Actions, pond_of
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..assembly.water import PondEnergy
from ..checks.values import counted
from ..model.basins import StandingWater, restored
from ..model.standing_water import Solved, renewed
from ..model.water_events import BasinResult, WaterEvent
from ..results.water_of_state import basins_of_state
from ..solvers.base import Solution, joined
from ..solvers.outcome import Outcome
from .course import Course

ROUNDS = 60  # most solutions of one load factor, between which water runs

Solve = Callable[[LoadedProblem, int], Solution]  # from the problem and the number of iterations in earlier rounds


class Rest(NamedTuple):
    """Water at the end of an increment.

    Attributes:
        course: The stage with the water in its basins at the last end.
        solution: The solution, with the iterates of all rounds.
        loaded: The problem that was solved last.
        basins: Water in the basins.
        events: Events since the last increment.
    """

    course: Course
    solution: Solution
    loaded: LoadedProblem
    basins: tuple[BasinResult, ...] = ()
    events: tuple[WaterEvent, ...] = ()


def at_rest(problem: Problem, course: Course, factor: Fraction, x: PETSc.Vec, solve: Solve) -> Rest:
    """Solve a load factor, and let the water of rain run until it rests.

    Args:
        problem: The problem.
        course: The stage, with the water in its basins at the last converged increment.
        factor: The load factor.
        x: The start; replaced by the solution.
        solve: The solver, which starts from x.
    """
    events: list[WaterEvent] = []
    before: Solution | None = None
    for _ in range(ROUNDS):
        loaded = problem.under(course.actions(factor))
        taken = 0 if before is None else before.total_iterations
        solution = solve(loaded, taken)
        total = solution if before is None else _joined(before, solution)
        if not solution.converged:
            words = f" Before that, water ran on in rounds, which took {counted(taken, 'iteration')}." * (taken > 0)
            return Rest(course, replace(total, reason=total.reason + words), loaded)
        waters, found, moved = _renewed(loaded, problem.to_numpy(x), x, float(factor))
        if not waters:
            return Rest(course, total, loaded)
        events += found
        course = course.with_water(waters)
        if not moved:
            loaded = problem.under(course.actions(factor))
            return Rest(course, total, loaded, basins_of_state(loaded, x), _summed(events))
        before = total
    words = "water goes on running from basin to basin, and the shape with it; give more increments or less rain"
    return Rest(course, replace(total, outcome=Outcome.MAX_ITERATIONS, reason=words), loaded)


def _renewed(
    loaded: LoadedProblem, displacement: NDArray[np.float64], x: PETSc.Vec, factor: float
) -> tuple[list[StandingWater | None], list[WaterEvent], bool]:
    """Water of each group of ponds in the present shape, events, and True if it has moved."""
    structure = loaded.structure
    waters: list[StandingWater | None] = []
    events: list[WaterEvent] = []
    moved = False
    position = structure.points + displacement
    for group in pond_groups(loaded.actions.ponds):
        old = water_of(group)
        if old is None:
            waters.append(None)
            continue
        mine = [one for one in loaded.integrals.all if isinstance(one, PondEnergy) and one.waters == group]
        pond, total = pond_of(group), amount_of(structure, group)
        new = renewed(structure, pond, old, position, _solved(mine, x, old, total), total)
        waters.append(new.water)
        moved |= new.moved
        for kind, basin, other, node, volume in new.events:
            place = tuple(position[node].tolist())
            events.append(WaterEvent(pond.part, kind, factor, basin, other, node, place, volume))
    return (waters if any(waters) else []), events, moved


def _solved(energies: Sequence[PondEnergy], x: PETSc.Vec, old: StandingWater, total: float) -> Solved:
    """Water that the solver has found in the basins of a group of ponds."""
    if not energies:  # before the first water
        return Solved([-np.inf] * len(old.basins), old.volumes(total).tolist(), [0.0] * len(old.basins))
    assert energies[0].basin
    cascade = energies[0].basin.cascade
    spilt = [cascade.spilt(number, x).volume for number in range(len(energies))]
    return Solved([one.water(x).level for one in energies], cascade.amounts(x), spilt)


def _joined(before: Solution, after: Solution) -> Solution:
    """Solution of several rounds as one."""
    return replace(
        after,
        outcome=before.outcome if after.outcome is Outcome.CONVERGED else after.outcome,
        iterations=joined(before, after),
        extra_iterations=before.extra_iterations + after.extra_iterations,
        lost_stability=before.lost_stability or after.lost_stability,
    )


def _summed(events: Sequence[WaterEvent]) -> tuple[WaterEvent, ...]:
    """Events of one increment, those over the same node from the same basin together."""
    sums: dict[tuple[str, str, int, int, int], WaterEvent] = {}
    for event in events:
        key = event.part, event.kind, event.basin, event.other, event.node
        known = sums.get(key)
        sums[key] = event if known is None else event._replace(volume=known.volume + event.volume)
    return tuple(sums.values())


def resumed(
    course: Course, factor: Fraction, displacement: NDArray[np.float64], basins: Sequence[BasinResult]
) -> Course:
    """Stage with the water that its last increment had, as of a checkpoint."""
    actions: Actions = course.actions(factor)
    waters: list[StandingWater | None] = []
    structure = course.structure
    for number, group in enumerate(pond_groups(actions.ponds)):
        volumes = {basin.node: basin.volume for basin in basins if basin.pond == number}
        if water_of(group) is None or not volumes:
            waters.append(water_of(group))
            continue
        position = structure.points + displacement
        waters.append(restored(structure, pond_of(group), volumes, position, amount_of(structure, group)))
    return course.with_water(waters)
