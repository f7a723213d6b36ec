"""Stages: load increments, load cases that branch from a common state, and results that survive failures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import partial
from pathlib import Path

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.actions import Actions, unloaded
from ..assembly.gas import ChamberResult
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..checks import paths, validation
from ..checks.calls import unfit
from ..model.cable_changes import FixedLength
from ..model.digests import fingerprint, of_stages
from ..model.ponds import Pond
from ..model.stages import Stage
from ..model.structure import Structure
from ..model.water_events import BasinResult, WaterEvent
from ..results.evaluation import StateEvaluator
from ..results.remarks import held_by_slack_parts, remarked, warn_of_remarks
from ..results.slackness import hanging_ends, slack_parts
from ..results.states import StageResult, StageResults
from ..results.strain_limits import warn_of_large_prestress
from ..results.unfinished_stages import Failure, last_found
from ..runtime.freed_memory import return_freed_memory
from ..runtime.processes import refuse_differences, together
from ..solvers import own
from ..solvers.base import Solution, Solver
from ..solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ..solvers.curvature import wrinkling_threshold
from ..solvers.newton import Newton
from ..solvers.outcome import Outcome
from ..solvers.progress import Report
from ..solvers.undefined_terms import undefined_start
from . import checkpoint
from .checkpoint_file import Progress
from .convergence_error import ConvergenceError
from .course import Course, course_of
from .increments import IncrementControl, Verdict
from .reasons import MORE, reason
from .stage_check import check_run, refuse_given_volumes
from .water_at_rest import at_rest, resumed
from .work import Work, WorkDone, WorkLimit

PROBE = 1 / 256  # fraction of an increment that snapped: its load shows at the start of a stage which parts carry


class Analysis:
    """Nonlinear statics of a structure; meshes are made and forms compiled once, for all its stages.

    A failed increment is halved, up to eight times, unless that cannot help: in a stage that applies nothing, for a
    mechanism, or after a first-order method ran out of iterations. After a converged increment the next is twice as
    long, up to the size that the stage asks for. An increment from a stable start that meets more negative curvature
    than wrinkled and slack cells have is halved, too. Smaller increments avoid the instability or bracket the critical
    load, at which the structure snaps through or buckles. An `UnstableStateWarning` reports the first of these loads in
    each stage.

    Args:
        structure: The structure.
        solver: Method that finds equilibrium in each load increment: `Newton`, `ConjugateGradient`, `SteepestDescent`,
            or an object of your own that keeps the protocol `Solver`.
        comm: The processes that share the work; each must give the same structure, solver and stages. Input that one of
            them refuses is refused by all. An exception in your own script on one process is invisible here: the others
            wait for ever, unless the script is run as `mpirun -n 2 python -m mpi4py script.py`.
        limit: Maximum work of each stage.
        progress: True to report the progress of a stage on stderr: a bar on a terminal, or else a line for each
            increment and one every ten seconds.

    Raises:
        ValueError: An argument is of another kind, or differs between processes.

    Attributes:
        structure: The structure.
        problem: Meshes and forms of the structure, on which its states, paths and modes continue.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> results = Analysis(rope).run([Stage("rest"), Stage("pull", [PointLoad(1, (0, 0, -10.0))], after="rest")])
        >>> {name: round(float(state.displacement[1, 2]), 4) for name, state in results.items()}
        {'rest': 0.0, 'pull': -0.0148}
    """

    def __init__(
        self,
        structure: Structure,
        solver: Solver = Newton(),
        comm: MPI.Intracomm = MPI.COMM_WORLD,
        limit: WorkLimit = WorkLimit(),
        progress: bool = True,
    ):
        validation.communicator("Analysis comm", comm)
        with together(comm):
            validation.instance("Analysis structure", structure, Structure)
            own.check(solver)
            validation.plain("Analysis limit", limit, WorkLimit)
            progress = validation.truth("Analysis progress", progress)
        refuse_differences(comm, lambda: {"solver": fingerprint(own.settings(solver)), "limit": fingerprint(limit)})
        self._limit, self._shown = limit, progress and comm.rank == 0
        self.structure = structure
        self._comm = comm
        self.problem = Problem(structure, comm)
        self._solver, self._solve = solver, own.prepared(solver, self.problem)
        self._record = StateEvaluator(self.problem)

    def run(
        self,
        stages: Sequence[Stage],
        checkpoint_file: str | Path | None = None,
        observe: Callable[[StageResult], None] | None = None,
    ) -> StageResults:
        """Run the stages and return their final states, by name; an unknown name raises a KeyError with the names.

        Args:
            stages: The stages, each after the one it follows.
            checkpoint_file: File in which to save the state after each converged increment. States in an existing file
                are not computed again, and the run continues from it. Stages may be added or left out, and have other
                `increments`. The solver may be another, too: each state is in equilibrium to the tolerance of the
                solver that found it. It is one file of any name, an SQLite database; its folder is made. While a run
                has it, no other can use it. Its journal, with "-journal" after its name, lies beside it and belongs to
                it. The first process alone reads and writes it.
            observe: Function that is given the state after each converged increment, on all processes, such as a
                `ParaViewSeries`; of a stage that the checkpoint has, its last saved state first.

        Raises:
            ValueError: A stage does not fit the structure or the other stages; it leaves a free rigid-body motion (one
                turn about a line is allowed: loads may hold it); the checkpoint belongs to another structure or to
                other stages; it was changed, is in use by another run, or cannot be written; the processes have
                different input.
            ConvergenceError: A load increment found no equilibrium, or the limit of work is used up; the exception has
                the results computed before.

        Warns:
            LargeStrainWarning: Strains of a stage, or those that belong to the prestress, are above 5 %.
            UnstableStateWarning: A state is not stable; the structure has snapped or buckled between two load factors
                (`Newton` with a line search tells); a node moved by more than half the size of what is connected with
                it; a mast tilted by more than 15 degrees, both beyond what is prescribed; or slack or wrinkled parts
                carry a mast, or more than 1 % of the forces or loads connected with them.
            LostPrestressWarning: No cell of a part has 1 % of its prestress left.
            UnbalancedStateWarning: Unbalanced forces of a stage are above 1e-6 of the loads.
            ShearSignWarning: A membrane without two sides has shear along warp and weft, which has no sign.
            CheckpointWarning: A state could not be saved, as on a full disk; the run continues without.
        """
        with together(self._comm):
            file = None if checkpoint_file is None else paths.path("checkpoint_file", checkpoint_file)
            if file and self._comm.rank == 0:
                paths.check_writable("checkpoint_file", file)
            if observe is not None and (shown := unfit(observe, 1)):
                raise ValueError(f"observe is {shown}; give a function of a state.")
            check_run(self.structure, stages)
            if isinstance(self._solver, ConjugateGradient | SteepestDescent):
                refuse_given_volumes(stages, type(self._solver).__name__)
        refuse_differences(self._comm, lambda: of_stages(stages))
        with together(self._comm):
            if self._comm.rank == 0:
                warn_of_large_prestress(self.structure, stacklevel=3)
        with checkpoint.opened(file, self.structure, stages, self._comm) as saved:
            results = StageResults(stages=stages)
            ends: dict[str | None, Actions] = {None: unloaded(self.structure)}
            for stage in stages:
                ends[stage.name] = self.problem.actions_of(stage, ends[stage.after])
            fixes = any(
                isinstance(one, FixedLength | Pond) for stage in stages for one in (*stage.changes, *stage.loads)
            )
            natural = {name for end in ends.values() for name in end.natural}
            self.problem.allow_natural_shapes(natural, {name for end in ends.values() for name in end.tensions})
            for stage in stages:
                shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
                course = course_of(self.problem, stage, ends, shape, fixes)
                begin = Progress(shape, Fraction(0), Fraction(1, stage.increments), ())
                state = saved.progress.get(stage.name, begin)
                if state.increments:
                    course = resumed(course, state.factor, state.displacement, state.increments[-1].basins)
                accept = partial(self._accept, saved, observe)
                if observe and state.factor > 0:  # a run that was stopped may not have shown its last saved state
                    observe(self._result(course, state))
                state, course = self._run(course, state, results, accept)
                ends[stage.name] = replace(ends[stage.name], ponds=course.end.ponds)
                if stage is stages[-1]:
                    own.release(self._solve)  # it takes several times the memory of the result
                    return_freed_memory(3 * len(self.problem.discretization.owned_nodes))
                results[stage.name] = remarked(self._result(course, state), shape)
                with together(self._comm):
                    warn_of_remarks(results[stage.name], self._comm, stacklevel=3)
        return results

    def _run(
        self, course: Course, state: Progress, results: StageResults, accept: Callable[[Course, Progress], None]
    ) -> tuple[Progress, Course]:
        """Run the load increments of a stage from a converged state; return its end, with the water then."""
        stage = course.stage
        stressed = self.problem.magnitudes.prestress_forces or course.start.changes_stress or self.structure.terms
        balanced = stage.after is not None or not stressed
        control = IncrementControl(stage, state, balanced)
        x, before = self.problem.create_vector(), len(state.increments)
        waters: dict[Fraction, tuple[Course, tuple[BasinResult, ...], tuple[WaterEvent, ...]]] = {}
        with Report(stage.name, float(state.factor), self._shown, len(results) + 1, len(results.stages)) as report:
            work = Work(self._limit, self._comm, report.iteration)
            while control.state.factor < 1:
                _dolfinx.free_dropped(self._comm)
                self.problem.discretization.to_petsc(control.state.displacement, x)
                solve = partial(self._solved, x=x, work=work, thorough=control.thorough)
                count, rest = work.count, at_rest(self.problem, course, control.next(), x, solve)
                shape = self.problem.to_numpy(x) if rest.solution.converged else None
                waters[control.factor] = rest.course, rest.basins, rest.events
                verdict = control.judge(rest.solution, shape, work.count - count)
                if verdict is Verdict.HALVE:
                    continue
                if verdict is Verdict.STOP or work.over or not self._located(course, control, work):
                    raise self._failure(course, control, rest.loaded, x, rest.solution, work, results)
                if self.structure.chambers:
                    control.note_chambers(self._chambers(course, control))
                assert control.reached
                course, basins, events = waters[control.reached.factor]
                control.note_water(basins, events)
                accept(course, control.accept())
                waters.clear()
                found = control.state.increments[before:]
                iterations = sum(entry.total_iterations for entry in found)
                report.increment(float(control.state.factor), found[-1].iterations[-1].residual, iterations)
        return control.state, course

    def _accept(
        self,
        saved: checkpoint.Checkpoint,
        observe: Callable[[StageResult], None] | None,
        course: Course,
        state: Progress,
    ) -> None:
        """Save a converged increment, and show it to an observer."""
        saved.save(course.stage.name, state)
        if observe:
            observe(self._result(course, state))

    def _solved(self, loaded: LoadedProblem, taken: int, x: PETSc.Vec, work: Work, thorough: bool) -> Solution:
        """Solve an increment; once the limit of work is used up, allow no retry."""
        work.iterates.clear()
        try:
            return undefined_start(loaded, x) or self._solve(loaded, x, work, thorough, taken)
        except WorkDone as done:
            return Solution(Outcome.WORK_LIMIT, f"{done}; {MORE}", tuple(work.iterates))

    def _chambers(self, course: Course, control: IncrementControl) -> dict[str, ChamberResult]:
        """Gas in the chambers in the accepted state."""
        assert control.reached
        loaded = self.problem.under(course.actions(control.reached.factor))
        return loaded.chambers(self.problem.discretization.to_petsc(control.reached.displacement))

    def _located(self, course: Course, control: IncrementControl, work: Work) -> bool:
        """Note parts that slack parts alone held before a loss of stability; False if the limit of work ended that."""
        reached = control.lost
        if not reached or not wrinkling_threshold(self.structure):  # without it, no part can be slack
            return True
        factor = float(control.state.factor) or PROBE * float(reached.factor)  # at the start forces may not show yet
        loaded = self.problem.under(course.actions(factor))
        x = self.problem.discretization.to_petsc(control.state.displacement)
        if control.state.factor == 0 and not self._solved(loaded, 0, x, work, thorough=False).converged:
            return not work.over
        control.note_fallen(held_by_slack_parts(self._record(course.stage.name, loaded, x, ())))
        return True

    def _failure(
        self,
        course: Course,
        control: IncrementControl,
        loaded: LoadedProblem,
        x: PETSc.Vec,
        solution: Solution,
        work: Work,
        results: StageResults,
    ) -> ConvergenceError:
        """Warn of the last state, and return the exception that ends the stage after it."""
        own.release(self._solve)
        slack = self._slack(course, loaded, x)
        last = remarked(self._result(course, control.state), course.shape)
        warn_of_remarks(last, self._comm, stacklevel=5)
        words = reason(loaded, x, solution, control, work) + slack
        results.failure = Failure(course.stage.name, float(control.factor), float(control.state.factor), words)
        results.last = last_found(results.failure, last, results)
        return ConvergenceError(results.failure.message, results, last, control.failed(solution), solution.motion)

    def _slack(self, course: Course, loaded: LoadedProblem, x: PETSc.Vec) -> str:
        """Sentence on slack parts and free cable ends in a state that is no equilibrium."""
        if not np.isfinite(x.norm()):
            return ""
        return slack_parts(state := self._record(course.stage.name, loaded, x, ())) + hanging_ends(state)

    def _result(self, course: Course, state: Progress) -> StageResult:
        x = self.problem.discretization.to_petsc(state.displacement)
        return self._record(course.stage.name, self.problem.under(course.actions(state.factor)), x, state.increments)
