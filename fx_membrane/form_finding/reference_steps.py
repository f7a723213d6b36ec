"""Steps of the updated reference on all processes, and the search for places of free mast heads between them.

Each solves for the displacement to equilibrium of the prestress with respect to the shape before it.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.loaded_problem import LoadedProblem
from ..assembly.problem import Problem
from ..geometry.measures import measures, normals, projected
from ..model.loads import PlanLoad
from ..model.parts import Membrane, Part
from ..model.stages import Stage
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from ..results.states import StageResult
from ..solvers.base import Iteration, Solution
from ..solvers.newton import Newton
from ..solvers.progress import Pulse
from .balance.membrane_balance import nodal_loads
from .form import Form, FormStep
from .masts.bar_balance import fallen_mast
from .masts.mast_balance import Balance, Step, balance_masts
from .natural_step import abandoned, wish_of
from .reasons.few_supports import all_held
from .reasons.no_form import established
from .shape_change import change_of_shape, check_collapse, collapse

SAME = 1e-12  # relative change of the loads that counts as none
REPEATS = 100  # maximum number of solves of a step


class _Shape(NamedTuple):
    """Shape after steps, with the stress found as prestress of its parts, their forces, and the reactions."""

    points: NDArray[np.float64]
    parts: dict[str, Part]
    forces: dict[str, NDArray[np.float64]]
    reactions: NDArray[np.float64]
    steps: tuple[FormStep, ...]


def steps_of_reference(
    structure: Structure,
    stage: Stage,
    is_settled: Callable[[FormStep], bool],
    most: int,
    pulse: Pulse,
    comm: MPI.Intracomm,
) -> tuple[Form, str]:
    """Form with places of free mast heads searched for where needed, and the collapse that ended it in words.

    Raises:
        RuntimeError: There is no form after the first step.
    """
    points, converged, searched, collapse_told = structure.points, False, False, ""
    shape, nearest, fallen = None, None, None
    steps: tuple[FormStep, ...] = ()

    def monitor(number: int, entry: Iteration) -> None:
        pulse(f"step {len(steps) + 1}, iteration {number}, residual {entry.residual:.1e}")

    def stepper(of: Structure) -> Step:
        problem = Problem(of, comm, elastic=False)
        solve, record = Newton(line_search=False).prepare(problem), StateEvaluator(problem)
        return lambda points, number: _step(record, lambda loaded, x: solve(loaded, x, monitor), stage, points, number)

    def fits(points: NDArray[np.float64], state: StageResult) -> bool:
        return is_settled(_stressed(structure, points, state)[2])

    step, limit = stepper(structure), most
    while len(steps) < limit and not converged:
        try:
            state = step(points, len(steps) + 1)
        except RuntimeError as failure:
            found, words = None, str(failure)
            if not searched:
                try:
                    found = balance_masts(structure, stage, stepper, fits, pulse, comm, limit, words)
                except RuntimeError as missing:
                    words = str(missing)
            if found is None:
                if nearest is None:
                    raise RuntimeError(words) from failure
                collapse_told = abandoned(len(nearest.steps), words)
                shape = nearest
                break
            searched, points, steps = True, found.points, ()
            step, limit = stepper(found.structure), found.steps
            continue
        parts, forces, entry = _stressed(structure, points, state)
        points, steps = points + state.displacement, (*steps, entry)
        shape = _Shape(points, parts, forces, state.reactions, steps)
        if nearest is None or entry.stress_error < nearest.steps[-1].stress_error:
            nearest = shape
        converged = is_settled(entry)
        if converged and (words := fallen_mast(structure, points)):
            fallen = (shape, f"The form is in equilibrium with the forces prescribed, but {words}")
            found = None if searched else _standing(structure, stage, stepper, fits, pulse, comm, limit)
            if found is None:
                break
            searched, points, steps, converged = True, found.points, (), False
            step, limit = stepper(found.structure), found.steps
    if fallen is not None and (not converged or shape is fallen[0]):
        shape, collapse_told, converged = *fallen, False
    assert shape is not None
    made = replace(structure, points=shape.points, parts=shape.parts)
    form = Form(shape.points, shape.forces, shape.reactions, shape.steps, converged, made, wish_of(structure.parts))
    return replace(form, remarks=all_held(structure)), collapse_told


def _standing(
    structure: Structure,
    stage: Stage,
    stepper: Callable[[Structure], Step],
    fits: Callable[[NDArray[np.float64], StageResult], bool],
    pulse: Pulse,
    comm: MPI.Intracomm,
    limit: int,
) -> Balance | None:
    """Find a shape near the first one in which free masts stand, where the steps let them fall; None without one."""
    try:
        return balance_masts(structure, stage, stepper, fits, pulse, comm, limit, "")
    except RuntimeError:
        return None


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
        raise RuntimeError(collapse(structure, number))
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
    x, shape, before = problem.create_vector(), reference, None
    in_plan = [load for load in stage.loads if isinstance(load, PlanLoad)]  # of an analysis: per area of the first plan
    others = replace(stage, loads=[load for load in stage.loads if not isinstance(load, PlanLoad)])
    for _ in range(REPEATS):
        problem.discretization.move(shape)
        actions = problem.actions_of(others)
        problem.discretization.move(reference)
        actions = replace(actions, loads=actions.loads + nodal_loads(problem.structure, in_plan, shape))
        loaded = problem.under(actions)
        if before is not None and np.abs(actions.loads - before).max() <= SAME * np.abs(actions.loads).max():
            return loaded, x
        if not solve(loaded, x).converged:
            if before is None:
                return None
            break
        shape, before = reference + problem.to_numpy(x), actions.loads
    reason = established(problem.structure, problem.structure.points)
    raise RuntimeError(
        "Form finding found no shape for the distributed loads: they grow with the form faster than the "
        f"prestress can hold. {reason} Give a larger prestress or smaller loads.".replace("  ", " ")
    )


def _stressed(
    structure: Structure, before: NDArray[np.float64], state: StageResult
) -> tuple[dict[str, Part], dict[str, NDArray[np.float64]], FormStep]:
    """Parts with the stress of a state as prestress, in the shape after a step, their forces, and the step."""
    points = before + state.displacement
    parts: dict[str, Part] = {}
    forces: dict[str, NDArray[np.float64]] = {}
    area = error = 0.0
    for name, part in structure.parts.items():
        parts[name], forces[name], deviation = _stressed_part(structure, name, points, state)
        error = max(error, deviation)
        area += float(measures(points, part.cells).sum()) if part.dimension == 2 else 0.0
    return parts, forces, FormStep(area, change_of_shape(structure, before, state.displacement), error)


def _stressed_part(
    structure: Structure, name: str, points: NDArray[np.float64], state: StageResult
) -> tuple[Part, NDArray[np.float64], float]:
    """Replace the prestress of a part by the stress of a state, in a new shape; return that, and its relative error."""
    part, result = structure.parts[name], state.parts[name]
    wanted = part.prestress_tensors()
    if result.dimension == 2:
        warp = structure.warp(name)
        normal = normals(points, part.cells)
        first = projected(warp, normal)
        frame = np.stack([first, np.cross(normal, first)], axis=2)
        found = np.einsum("nia,nij,njb->nab", frame, result.cauchy, frame)
        found = (found + found.swapaxes(1, 2)) / 2
        stressed: Part = replace(structure.part(name, Membrane), prestress=found, warp=warp)
    else:
        found, wanted = result.force, wanted[:, 0, 0]
        if part.is_strut and state.structure.terms:  # thrusts, which the step keeps
            found = np.array(wanted)
        stressed = replace(part, prestress=found)
    return stressed, found, float(np.abs(found - wanted).max() / max(np.abs(wanted).max(), np.finfo(float).tiny))
