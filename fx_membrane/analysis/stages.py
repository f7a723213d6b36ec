"""Stages: load increments, load cases that branch from a common state, and results that survive failures."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.actions import Actions, between, unloaded, with_constraints_of
from ..assembly.load_cases import prescribed
from ..assembly.loaded_problem import LoadedProblem
from ..assembly.problem import Problem
from ..checks import paths, validation
from ..model.fingerprints import fingerprint, of_stages
from ..model.restraint import check_supports
from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from ..results.remarks import held_by_slack_parts, remarked, warn_of_remarks
from ..results.slackness import hanging_ends, slack_parts
from ..results.states import Increment, StageResult, StageResults
from ..results.strain_limits import warn_of_large_prestress
from ..runtime.processes import refuse_differences, together
from ..solvers.base import Solution
from ..solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ..solvers.curvature import wrinkling_threshold
from ..solvers.newton import Newton
from ..solvers.progress import Report
from . import checkpoint
from .checkpoint_file import Progress
from .increments import HALVINGS, Ceiling
from .reasons import MORE, reason
from .work import Work, WorkDone, WorkLimit

PROBE = 1 / 256  # fraction of an increment that snapped: its load shows at the start of a stage which parts carry

AnySolver = Newton | ConjugateGradient | SteepestDescent


class ConvergenceError(RuntimeError):
    """Failure to find equilibrium in a load increment.

    Attributes:
        results: Results of the stages that were completed, by name.
        last: The last converged state of the stage that failed: that of its last converged increment, or else its
            start. Later iterates are discarded.
        failed: The increment that did not converge, with its iterations.
        motion: For a mechanism, the free motion of its nodes, the largest displacement of size one, shape (n, 3); None
            otherwise. `plot.contours(error.last, {"free motion": np.linalg.norm(error.motion, axis=1)}, path)` shows
            it.
    """

    def __init__(
        self,
        message: str,
        results: StageResults,
        last: StageResult,
        failed: Increment,
        motion: NDArray[np.float64] | None = None,
    ):
        super().__init__(message)
        self.results, self.last, self.failed, self.motion = results, last, failed, motion


class Analysis:
    """Nonlinear statics of a structure; meshes are made and forms compiled once, for all its stages.

    A failed increment is halved, up to eight times, unless that cannot help: in a stage that applies nothing, for a
    mechanism, or after a first-order method ran out of iterations. After a converged increment the next is twice as
    long, up to the size that the stage asks for. An increment from a stable start that meets more negative curvature
    than wrinkled and slack cells have is halved, too. Smaller increments avoid the instability or bracket the critical
    load, at which the structure snaps through or buckles. An `UnstableStateWarning` reports the first such load of each
    stage.

    Args:
        structure: The structure.
        solver: Method that finds equilibrium in each load increment.
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
    """

    def __init__(
        self,
        structure: Structure,
        solver: AnySolver = Newton(),
        comm: MPI.Intracomm = MPI.COMM_WORLD,
        limit: WorkLimit = WorkLimit(),
        progress: bool = True,
    ):
        validation.communicator("Analysis comm", comm)
        with together(comm):
            validation.instance("Analysis structure", structure, Structure)
            validation.instance("Analysis solver", solver, AnySolver)
            validation.instance("Analysis limit", limit, WorkLimit)
            progress = validation.truth("Analysis progress", progress)
        refuse_differences(comm, lambda: {"solver": fingerprint(solver), "limit": fingerprint(limit)})
        self._limit, self._progress = limit, progress
        self.structure = structure
        self._comm = comm
        self.problem = Problem(structure, comm)
        self._solve = solver.prepare(self.problem)
        self._record = StateEvaluator(self.problem)

    def run(self, stages: Sequence[Stage], checkpoint_file: str | Path | None = None) -> StageResults:
        """Run the stages and return their final states, by name; an unknown name raises a KeyError with the names.

        Args:
            stages: The stages, each after the one it follows.
            checkpoint_file: File in which to save the state after each converged increment. States in an existing file
                are not computed again, and the run continues from it. Stages may be added or left out, and have other
                `increments`. The solver may be another, too: each state is in equilibrium to the tolerance of the
                solver that found it. It is one file of any name, an SQLite database. While a run has it, no other can
                use it. Its journal, with "-journal" after its name, lies beside it and belongs to it. The first process
                alone reads and writes it.

        Raises:
            ValueError: A stage does not fit the structure or the other stages; it leaves a free rigid-body motion (one
                turn about a line is allowed: loads may hold it); the checkpoint belongs to another structure or to
                other stages, was changed, is in use by another run or cannot be written; the processes have different
                input.
            ConvergenceError: A load increment found no equilibrium, or the limit of work is used up; the exception has
                the results computed before.

        Warns:
            LargeStrainWarning: Strains of a stage, or those that belong to the prestress, are above 5 %.
            UnstableStateWarning: A state is not stable; the structure has snapped or buckled between two load factors
                (`Newton` with a line search tells); a node moved by more than half the size of what is connected with
                it, or a mast tilted by more than 15 degrees in the stage, both beyond what is prescribed; or slack or
                wrinkled parts carry a mast, or more than 1 % of the forces or loads connected with them.
            LostPrestressWarning: No cell of a part has 1 % of its prestress left.
            UnbalancedStateWarning: Unbalanced forces of a stage are above 1e-6 of the loads.
            CheckpointWarning: A state could not be saved, as on a full disk; the run continues without.
        """
        with together(self._comm):
            file = None if checkpoint_file is None else paths.path("checkpoint_file", checkpoint_file)
            if file and self._comm.rank == 0:
                paths.check_writable("checkpoint_file", file)
            self._check(stages)
        refuse_differences(self._comm, lambda: of_stages(stages))
        with together(self._comm):
            if self._comm.rank == 0:
                warn_of_large_prestress(self.structure, stacklevel=3)
        with checkpoint.opened(file, self.structure, stages, self._comm) as saved:
            results = StageResults()
            ends: dict[str | None, Actions] = {None: unloaded(self.structure)}
            for stage in stages:
                ends[stage.name] = end = self.problem.actions(stage, ends[stage.after])
                shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
                start = with_constraints_of(ends[stage.after], end, shape)
                state = saved.progress.get(stage.name) or Progress(
                    shape, Fraction(0), Fraction(1, stage.increments), ()
                )
                results[stage.name] = remarked(self._run(stage, start, end, state, results, saved.save), shape)
                with together(self._comm):
                    warn_of_remarks(results[stage.name], self._comm, stacklevel=3)
        return results

    def _check(self, stages: Sequence[Stage]) -> None:
        check_stages(self.structure, stages)
        held: dict[str | None, NDArray[np.bool_]] = {None: self.structure.supported}
        for stage in stages:
            held[stage.name] = held[stage.after] | prescribed(stage, self.structure)[0]
            check_supports(self.structure, held[stage.name])

    def _run(
        self,
        stage: Stage,
        start: Actions,
        end: Actions,
        state: Progress,
        results: StageResults,
        save: Callable[[str, Progress], None],
    ) -> StageResult:
        """Run the load increments of a stage from a converged state, between the actions at its start and its end."""
        full = Fraction(1, stage.increments)
        balanced = stage.after is not None or not self.problem.magnitudes.prestress_forces
        beyond: Progress | None = None  # a state beyond a loss of stability, while smaller increments bracket it
        x = self.problem.to_petsc(state.displacement)
        with Report(stage.name, float(state.factor), shown=self._progress and self._comm.rank == 0) as report:
            ceiling = Ceiling()
            work = Work(self._limit, self._comm, report.iteration)
            while state.factor < 1:
                factor = ceiling.next(state.factor, state.size)
                _dolfinx.free_dropped(self._comm)
                loaded = self.problem.under(between(start, end, float(factor)))
                solution = self._solved(loaded, x, work, ceiling.smooth and beyond is None)
                judged = (balanced or state.factor > 0) and not any(entry.snapped for entry in state.increments)
                snapped = solution.converged and solution.lost_stability and judged
                remarks = (solution.stabilized, solution.unstable, solution.extra_iterations, snapped)
                increment = Increment(float(factor), solution.iterations, *remarks)
                found = None
                if solution.converged:
                    size = full if snapped else min(2 * state.size, full)
                    shape = self.problem.to_numpy(x)
                    found = Progress(shape, factor, size, (*state.increments, increment))
                else:
                    ceiling.failed(factor, len(work.iterates))
                beyond = found if snapped else beyond
                divisible = bool(stage.loads or stage.displacements) and state.size > full / 2**HALVINGS
                divisible = divisible and (snapped or not ceiling.reached(state.factor))
                if divisible and (snapped or (not solution.converged and solution.retry)):
                    state = replace(state, size=(factor - state.factor) / 2)
                    self.problem.to_petsc(state.displacement).copy(x)
                    continue
                reached = self._located(stage, start, end, state, found or beyond, work)
                if not reached:
                    shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
                    slack = self._slack(stage, loaded, x)
                    last = remarked(self._result(stage, start, end, state), shape)
                    warn_of_remarks(last, self._comm, stacklevel=4)
                    words = reason(loaded, x, solution, state, beyond, ceiling, work) + slack
                    message = (
                        f"Stage {stage.name!r} found no equilibrium at load factor {float(factor):.6g} "
                        f"(the last found is at {float(state.factor):.6g}): {words}"
                    )
                    failed = increment._replace(snapped=False)  # that is not known yet
                    raise ConvergenceError(message, results, last, failed, solution.motion)
                state, beyond = reached, None
                ceiling.found(state.factor)
                self.problem.to_petsc(state.displacement).copy(x)
                save(stage.name, state)
                report.increment(float(state.factor), state.increments[-1].iterations[-1].residual)
        return self._result(stage, start, end, state)

    def _solved(self, loaded: LoadedProblem, x: PETSc.Vec, work: Work, thorough: bool) -> Solution:
        """Solve an increment; once the limit of work is used up, allow no retry."""
        work.iterates.clear()
        try:
            return self._solve(loaded, x, work, thorough)
        except WorkDone as done:
            return Solution(False, f"{done}; {MORE}", tuple(work.iterates), retry=False)

    def _located(
        self, stage: Stage, start: Actions, end: Actions, state: Progress, reached: Progress | None, work: Work
    ) -> Progress | None:
        """Choose the state that follows another; None without one, or if the limit of work ended its search."""
        if reached and not work.over and reached.increments[-1].snapped:
            reached = self._fallen(stage, start, end, state, reached, work)
        return None if work.over else reached

    def _fallen(
        self, stage: Stage, start: Actions, end: Actions, state: Progress, reached: Progress, work: Work
    ) -> Progress:
        """Note with an increment that snapped the parts that only slack parts held before.

        At the start of a stage forces may not show that yet: a small fraction of the increment makes them visible.
        """
        if not wrinkling_threshold(self.structure):
            return reached  # no part can be slack
        factor = float(state.factor) or PROBE * float(reached.factor)
        loaded = self.problem.under(between(start, end, factor))
        x = self.problem.to_petsc(state.displacement)
        if state.factor == 0 and not self._solved(loaded, x, work, thorough=False).converged:
            return reached
        *others, snap = reached.increments
        words = held_by_slack_parts(self._record(stage.name, loaded, x, ()))
        return replace(reached, increments=(*others, snap._replace(fallen=words)))

    def _slack(self, stage: Stage, loaded: LoadedProblem, x: PETSc.Vec) -> str:
        """Sentence on slack parts and free cable ends in a state that is no equilibrium."""
        if not np.isfinite(x.norm()):
            return ""
        state = self._record(stage.name, loaded, x, ())
        return slack_parts(state) + hanging_ends(state)

    def _result(self, stage: Stage, start: Actions, end: Actions, state: Progress) -> StageResult:
        loaded = self.problem.under(between(start, end, float(state.factor)))
        x = self.problem.to_petsc(state.displacement)
        return self._record(stage.name, loaded, x, state.increments)
