"""Form finding with prescribed stress: soap films, and membranes and edge cables of given prestress.

Each step solves for equilibrium with the prestress as 2nd Piola-Kirchhoff stress with respect to the present shape. The
result is the next reference shape. The energy is quadratic, so a step is one linear solve, and the nodes have a
definite place within the surface. With an isotropic stress it is the algorithm of Pinkall and Polthier for minimal
surfaces. The shape settles in a few steps, while the nodes slide within it for many more; the steps end when only
sliding remains. Equilibrium is exact after each step, with the stress found. That stress differs from the prescribed
one by the remaining sliding, which vanishes in the end. Loads along a line or a surface, such as the weight of a
hanging cable, are an exception: no constant stress balances them.

Distributed loads are per area of the form, which a step finds only by solving. So each step is solved again with the
loads of its result until these no longer change.

Source: K.-U. Bletzinger, E. Ramm, A general finite element approach to the form finding of tensile structures by the
updated reference strategy, Int. J. Space Structures 14 (1999) 131-145; U. Pinkall, K. Polthier, Computing discrete
minimal surfaces and their conjugates, Experimental Mathematics 2 (1993) 15-36.
"""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.loaded_problem import LoadedProblem
from ..assembly.problem import Problem
from ..checks import validation
from ..geometry.measures import measures, normals, projected
from ..model.fingerprints import of_settings
from ..model.loads import DistributedLoad, PointLoad, Pressure
from ..model.parts import Membrane, Part
from ..model.restraint import check_supports
from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from ..results.states import StageResult
from ..runtime.processes import refuse_differences, together
from ..solvers.base import Iteration, Solution
from ..solvers.newton import Newton
from ..solvers.progress import Pulse
from .form import Form, FormStep, refuse_terms
from .masts.mast_balance import Step, balance_masts
from .shape_change import change_of_shape, check_collapse, collapse

SAME = 1e-12  # relative change of the loads that counts as none
REPEATS = 100  # maximum number of solves of a step
STRAY = 0.1  # accepted error of the stress where it can settle, relative to the prescribed stress
STRAY_LOADED = 0.5  # the same with loads along lines and surfaces, which no constant stress balances


class UnsettledFormWarning(UserWarning):
    """Form that has not settled in the steps allowed: it is in equilibrium, but not with the stress prescribed."""


def updated_reference(
    structure: Structure,
    loads: Sequence[PointLoad | DistributedLoad | Pressure] = (),
    tolerance: float = 1e-3,
    max_iterations: int = 100,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> Form:
    """Find the shape in which the prestress of membranes, cables and masts is in equilibrium, without elasticity.

    The length of a mast is not prescribed, but found with its force. A free mast head is found where the forces there
    have an equilibrium near the first shape. Where the steps find none, the place of the heads is searched for, with
    the rest of the form held there; for bars alone, under point loads at most, the balance of their forces is solved.
    For a mast of given place or length hold its head by a support, and add masts and stays by `masts_and_stays`.

    Stress and warp stay with the cells, whose nodes slide for hundreds of steps: with warp unlike weft, and along edge
    cables, stress and area drift on. `prescribed_stress` keeps the mesh even, takes both anew where the cell is, and
    settles. Take it for them, and this function for soap films and masts.

    Args:
        structure: Initial shape with the intended prestress and the supports of the form.
        loads: Loads that the form balances, such as an inner pressure; distributed loads are per area or length of the
            form.
        tolerance: Accepted change of shape in a step, `FormStep.change` [-].
        max_iterations: Maximum number of steps, and of moves of free mast heads in search of their places.
        comm: The processes that share the work.

    Returns:
        The form, in equilibrium even if the steps were too few. It has converged if the change of shape fell below the
        tolerance, with an error of the stress below 10 %; below 50 % under loads per area or length or at points, which
        may leave no constant stress.

    Raises:
        ValueError: The structure has no prestress at all, or a compressive one in a membrane or a cable; it is not
            supported; the loads do not fit it; it has energy terms.
        RuntimeError: A step found no equilibrium, or the shape collapses, as a catenoid between rings too far apart; a
            cable or a mast shrinks to a point or grows without bound; no place of a free mast head was found, and the
            force that is missing there is named; or distributed loads grow with the form faster than the prestress can
            carry.

    Warns:
        UnsettledFormWarning: The steps were too few; the form is that of the last one.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> points[:, 2] = points[:, 0] * points[:, 1] + 0.1 * (1 - points[:, 0] ** 2)
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)
        >>> form = updated_reference(Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))]))
        >>> form.steps[-1].area < form.steps[0].area
        True
    """
    validation.communicator("updated_reference comm", comm)
    with together(comm):
        validation.instance("updated_reference structure", structure, Structure)
        refuse_terms(structure)
        tolerance = validation.positive("tolerance", tolerance)
        max_iterations = validation.positive_integer("max_iterations", max_iterations)
        stage = Stage("form", validation.instances("loads", loads, PointLoad | DistributedLoad | Pressure))
        check_stages(structure, [stage])
        check_supports(structure, structure.supported)
        _check_prestress(structure)
    settings = {"loads": stage.loads, "tolerance": tolerance, "max_iterations": max_iterations}
    refuse_differences(comm, lambda: of_settings(settings))
    points = structure.points
    steps: list[FormStep] = []
    parts: dict[str, Part] = {}
    forces: dict[str, NDArray[np.float64]] = {}
    reactions = np.zeros(points.shape)
    converged = searched = False
    stray = STRAY_LOADED if any(isinstance(load, PointLoad | DistributedLoad) for load in stage.loads) else STRAY
    pulse = Pulse("form finding", comm.rank == 0)

    def monitor(number: int, entry: Iteration) -> None:
        pulse(f"step {len(steps) + 1}, iteration {number}, residual {entry.residual:.1e}")

    def stepper(of: Structure) -> Step:
        problem = Problem(of, comm, elastic=False)
        solve, record = Newton(line_search=False).prepare(problem), StateEvaluator(problem)
        return lambda points, number: _step(record, lambda loaded, x: solve(loaded, x, monitor), stage, points, number)

    def is_settled(step: FormStep) -> bool:
        return step.change <= tolerance and step.stress_error <= stray

    def fits(points: NDArray[np.float64], state: StageResult) -> bool:
        return is_settled(_stressed(structure, points, state)[2])

    step, limit = stepper(structure), max_iterations
    while len(steps) < limit and not converged:
        try:
            state = step(points, len(steps) + 1)
        except RuntimeError as failure:
            found = None
            if not searched:
                found = balance_masts(structure, stage, stepper, fits, pulse, comm, limit, str(failure))
            if found is None:
                raise
            searched, points, steps = True, found.points, []
            step, limit = stepper(found.structure), found.steps
            continue
        parts, forces, entry = _stressed(structure, points, state)
        points, reactions = points + state.displacement, state.reactions
        steps.append(entry)
        converged = is_settled(entry)
    with together(comm):
        if not converged and comm.rank == 0:
            _warn_of_unsettled_form(steps, tolerance)
    made = replace(structure, points=points, parts=parts)
    return Form(points, forces, reactions, tuple(steps), converged, made)


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
    for _ in range(REPEATS):
        problem.discretization.move(shape)
        actions = problem.actions_of(stage)
        problem.discretization.move(reference)
        loaded = problem.under(actions)
        if before is not None and np.abs(actions.loads - before).max() <= SAME * np.abs(actions.loads).max():
            return loaded, x
        if not solve(loaded, x).converged:
            if before is None:
                return None
            break
        shape, before = reference + problem.to_numpy(x), actions.loads
    raise RuntimeError(
        "Form finding found no shape for the distributed loads: they grow with the form faster than the "
        "prestress can hold. Give a larger prestress or smaller loads."
    )


def _warn_of_unsettled_form(steps: Sequence[FormStep], tolerance: float) -> None:
    last = steps[-1]
    warnings.warn(
        f"The form has not settled: step {len(steps)}, the last, changed it by {last.change:.3g} of the length of an "
        f"edge, more than the tolerance {tolerance:g}, and its stress is off by {100 * last.stress_error:.3g} % of the "
        "prescribed one; it is in equilibrium with the stress found. Allow more steps (max_iterations=...) or a larger "
        "tolerance; where the change does not fall from step to step (form.steps), the prestress may have no form.",
        UnsettledFormWarning,
        stacklevel=3,
    )


def _check_prestress(structure: Structure) -> None:
    stresses = {name: part.prestress_tensors() for name, part in structure.parts.items()}
    if not any(stress.any() for stress in stresses.values()):
        raise ValueError("No part has a prestress; form finding needs the stress that the form is to have.")
    for name, part in structure.parts.items():
        least = np.linalg.eigvalsh(stresses[name])[:, 0]
        if not part.is_strut and least.min() < 0:
            cell = int(np.argmin(least))
            where = validation.format_point(structure.points[part.cells[cell]].mean(axis=0))
            raise ValueError(
                f"Part {name!r}, cell {cell}: its prestress is compressive ({least[cell]:g}) at {where}; no form of "
                "fabric or cables holds that, give a tension."
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
