"""Steps of the updated reference on all processes, and the search for places of free mast heads between them.

Each solves for the displacement to equilibrium of the prestress with respect to the shape before it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..geometry.sizes import measures, normals, projected
from ..model.loads import PlanLoad
from ..model.parts import Membrane, Part
from ..model.stages import Stage
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from ..results.states import StageResult
from ..solvers.base import Iteration, Solution
from ..solvers.newton import Newton
from ..solvers.progress import Pulse
from .after_collapse import MAX_SHAPES, last_good
from .balance.load_settling import LoadSettling
from .balance.membrane_balance import nodal_loads
from .density_steps import abandoned, wish_of
from .form import Form, FormStep
from .form_loads import words_of_loads
from .masts.bar_balance import fallen_mast
from .masts.mast_balance import Balance, Step, balance_masts
from .reasons.few_supports import all_held
from .reasons.no_form import established
from .shape_change import change_of_shape, check_collapse, collapse

REPEATS = 200  # maximum number of solves of a step: enough where each leaves 84 % of the change of the loads


class _Shape(NamedTuple):
    """Shape after steps, with the stress found as prestress of its parts, their forces, and the reactions."""

    points: NDArray[np.float64]
    parts: dict[str, Part]
    forces: dict[str, NDArray[np.float64]]
    reactions: NDArray[np.float64]
    steps: tuple[FormStep, ...]


class Course:
    """Course of the steps: the present shape, and the searches for places of free mast heads on the way.

    Attributes:
        points: The present shape, shape (n, 3) [m].
        steps: Steps from the present start on.
        limit: Maximum number of steps from there.
        searched: True once places of mast heads were searched for.
        nearest: Shapes of least error of the stress so far, the nearest first.
    """

    def __init__(
        self,
        structure: Structure,
        stage: Stage,
        is_settled: Callable[[FormStep], bool],
        most: int,
        pulse: Pulse,
        comm: MPI.Intracomm,
    ):
        self.structure, self.stage, self.is_settled = structure, stage, is_settled
        self.pulse, self.comm, self.limit = pulse, comm, most
        self.points, self.searched = structure.points, False
        self.steps: tuple[FormStep, ...] = ()
        self.nearest: list[_Shape] = []
        self._step = self.stepper(structure)

    def form(self) -> tuple[Form, str]:
        """Form with places of free mast heads searched for where needed, and the collapse that ended it in words.

        Raises:
            RuntimeError: There is no form after the first step.
        """
        shape, told, converged = self._run()
        wish = wish_of(self.structure.parts)
        form = Form(shape.points, shape.forces, shape.reactions, shape.steps, converged, self._made(shape), wish)
        return replace(form, remarks=all_held(self.structure)), told

    def _run(self) -> tuple[_Shape, str, bool]:
        """Return the last shape, the collapse or the fallen mast that ended the steps in words, and convergence."""
        shape, told, converged = None, "", False
        fallen: tuple[_Shape, str] | None = None
        while len(self.steps) < self.limit and not converged:
            try:
                shape = self.advance()
            except RuntimeError as failure:
                words = self.begin_anew_after(failure)
                if not words:
                    continue
                if not self.nearest:
                    raise RuntimeError(words) from failure
                good = last_good([self._made(each) for each in self.nearest], self.stage.loads, self.comm)
                shape, told = self.nearest[good], abandoned(len(self.nearest[good].steps), words)
                break
            converged = self.is_settled(shape.steps[-1])
            if converged and (words := fallen_mast(self.structure, self.points)):
                fallen = shape, f"The form is in equilibrium with the forces prescribed, but {words}"
                if not self.begin_with_standing_masts():
                    break
                converged = False
        if fallen is not None and (not converged or shape is fallen[0]):
            return *fallen, False
        assert shape is not None
        return shape, told, converged

    def advance(self) -> _Shape:
        """Advance by one step; return the shape after it.

        Raises:
            RuntimeError: There is no equilibrium, or the shape collapses.
        """
        state = self._step(self.points, len(self.steps) + 1)
        parts, forces, entry = _stressed(self.structure, self.points, state)
        self.points, self.steps = self.points + state.displacement, (*self.steps, entry)
        shape = _Shape(self.points, parts, forces, state.reactions, self.steps)
        self.nearest = sorted([*self.nearest, shape], key=lambda each: each.steps[-1].stress_error)[:MAX_SHAPES]
        return shape

    def _made(self, shape: _Shape) -> Structure:
        """Structure of a shape, with the stress found as prestress."""
        return replace(self.structure, points=shape.points, parts=shape.parts)

    def begin_anew_after(self, failure: RuntimeError) -> str:
        """Begin anew where free masts balance, after a step that failed; else return the reason in words."""
        words = str(failure)
        if self.searched:
            return words
        try:
            return "" if self.begin(self.balance(words)) else words
        except RuntimeError as missing:
            return str(missing)

    def begin_with_standing_masts(self) -> bool:
        """Begin anew near the first shape, where free masts stand; return False where they do not."""
        if self.searched:
            return False
        try:
            return self.begin(self.balance(""))
        except RuntimeError:
            return False

    def balance(self, words: str) -> Balance | None:
        """Search for places of free mast heads where their forces balance.

        Raises:
            RuntimeError: There are none.
        """
        return balance_masts(
            self.structure, self.stage, self.stepper, self.fits, self.pulse, self.comm, self.limit, words
        )

    def begin(self, found: Balance | None) -> bool:
        """Begin anew from what a search has found; return False if that is nothing."""
        if found is None:
            return False
        self.searched, self.points, self.steps = True, found.points, ()
        self._step, self.limit = self.stepper(found.structure), found.steps
        return True

    def stepper(self, of: Structure) -> Step:
        """Return the function that takes a step of a structure, with a problem and a solver of its own."""
        problem = Problem(of, self.comm, elastic=False)
        solve, record = Newton(line_search=False).prepare(problem), StateEvaluator(problem)
        # Without `self`, which keeps the function: a circle of them would keep the meshes.
        pulse, stage = self.pulse, self.stage

        def step(points: NDArray[np.float64], number: int) -> StageResult:
            def monitor(iteration: int, entry: Iteration) -> None:
                pulse(f"step {number}, iteration {iteration}, residual {entry.residual:.1e}")

            return _step(record, lambda loaded, x: solve(loaded, x, monitor), stage, points, number)

        return step

    def fits(self, points: NDArray[np.float64], state: StageResult) -> bool:
        """Return True if the stress of a state is that prescribed."""
        return self.is_settled(_stressed(self.structure, points, state)[2])


def _step(
    record: StateEvaluator,
    solve: Callable[[LoadedProblem, PETSc.Vec], Solution],
    stage: Stage,
    points: NDArray[np.float64],
    number: int,
) -> StageResult:
    """State in which the prestress with respect to a shape is in equilibrium.

    Raises:
        RuntimeError: There is none, or the shape collapses.
    """
    structure = record.problem.structure
    found = _equilibrium(record.problem, solve, stage, points)
    if found is None:
        loads = words_of_loads(stage.loads)
        heavy = f"It bears {loads}: give a larger prestress or smaller loads if that is more than its stress holds."
        raise RuntimeError(f"{collapse(structure, number)} {heavy if loads else ''}".strip())
    state = record(stage.name, *found, ())
    check_collapse(structure, points + state.displacement, number)
    return state


def _equilibrium(
    problem: Problem,
    solve: Callable[[LoadedProblem, PETSc.Vec], Solution],
    stage: Stage,
    reference: NDArray[np.float64],
) -> tuple[LoadedProblem, PETSc.Vec] | None:
    """Displacement from a reference shape to equilibrium of the prestress with the loads on it; None without one.

    Raises:
        RuntimeError: The loads do not settle.
    """
    x, shape, before, have_settled = problem.create_vector(), reference, None, LoadSettling()
    in_plan = [load for load in stage.loads if isinstance(load, PlanLoad)]  # of an analysis: per area of the first plan
    others = replace(stage, loads=[load for load in stage.loads if not isinstance(load, PlanLoad)])
    for _ in range(REPEATS):
        problem.discretization.move(shape)
        actions = problem.actions_of(others)
        problem.discretization.move(reference)
        actions = replace(actions, loads=actions.loads + nodal_loads(problem.structure, in_plan, shape))
        loaded = problem.under(actions)
        if before is not None and have_settled(before, actions.loads):
            return loaded, x
        if not solve(loaded, x).converged:
            if before is None:
                return None
            break
        shape, before = reference + problem.to_numpy(x), actions.loads
    reason = established(problem.structure, problem.structure.points)
    raise RuntimeError(
        f"Form finding found no shape for the loads, {words_of_loads(stage.loads)}: they grow with the form faster "
        f"than the prestress can hold. {reason} Give a larger prestress or smaller loads.".replace("  ", " ")
    )


def _stressed(
    structure: Structure, before: NDArray[np.float64], state: StageResult
) -> tuple[dict[str, Part], dict[str, NDArray[np.float64]], FormStep]:
    """Parts with the stress of a state as prestress, in the shape after a step, their forces, and the step."""
    points = before + state.displacement
    parts: dict[str, Part] = {}
    forces: dict[str, NDArray[np.float64]] = {}
    error = 0.0
    for name in structure.parts:
        parts[name], forces[name], deviation = _stressed_part(structure, name, points, state)
        error = max(error, deviation)
    area = sum(float(measures(points, part.cells).sum()) for part in structure.membranes.values())
    return parts, forces, FormStep(area, change_of_shape(structure, before, state.displacement), error)


def _stressed_part(
    structure: Structure, name: str, points: NDArray[np.float64], state: StageResult
) -> tuple[Part, NDArray[np.float64], float]:
    """Replace the prestress of a part by the stress of a state, in a new shape; return that, and its relative error."""
    part = structure.parts[name]
    wanted = part.prestress_tensors()
    if name in state.membranes:
        warp = structure.warp(name)
        normal = normals(points, part.cells)
        first = projected(warp, normal)
        frame = np.stack([first, np.cross(normal, first)], axis=2)
        found = np.einsum("nia,nij,njb->nab", frame, state.membranes[name].cauchy, frame)
        found = (found + found.swapaxes(1, 2)) / 2
        stressed: Part = replace(structure.part(name, Membrane), prestress=found, warp=warp)
    else:
        found, wanted = state.bars[name].force, wanted[:, 0, 0]
        if part.is_strut and state.structure.terms:  # thrusts, which the step keeps
            found = np.array(wanted)
        stressed = replace(part, prestress=found)
    return stressed, found, float(np.abs(found - wanted).max() / max(np.abs(wanted).max(), np.finfo(float).tiny))
