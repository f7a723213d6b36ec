"""Stages: load increments, load cases that branch from a common state, and results that are never lost."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly import load_cases
from ..assembly.problem import Actions, Problem
from ..checks import paths, validation
from ..model import loads
from ..model.fingerprints import fingerprint, of_stages
from ..model.loads import Stage
from ..model.restraint import check_supports
from ..model.structure import Structure
from ..results.balance import warn_of_unbalance
from ..results.evaluation import Recorder
from ..results.remarks import held_by_slack_parts, remarked, warn_of_remarks
from ..results.slackness import hanging_ends, slack_parts
from ..results.states import Increment, StageResult, StageResults
from ..results.strain_limits import warn_of_large_prestress, warn_of_large_strains
from ..runtime.processes import refuse_differences, together
from ..solvers.base import Solution
from ..solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ..solvers.lowest_mode import explained
from ..solvers.newton import Newton
from ..solvers.progress import Report
from . import checkpoint
from .checkpoint_file import Progress
from .increments import HALVINGS, Ceiling
from .reasons import MORE, reason
from .work import Work, WorkDone, WorkLimit

PROBE = 1 / 256  # of an increment that snapped: a load under which the start of a stage shows what holds it

AnySolver = Newton | ConjugateGradient | SteepestDescent


class ConvergenceError(RuntimeError):
    """A load increment found no equilibrium.

    Attributes:
        results: Results of the stages that were completed, by name.
        last: The last converged state of the stage that failed: that of its last increment that converged, or else
            the state it started from. What the solver had come to after that is no equilibrium, and is not kept.
        failed: The increment that did not converge, with its iterations.
        motion: Where the structure is a mechanism, how its nodes move freely, the largest displacement of size one,
            shape (n, 3); None otherwise. `plot.contours(error.last, {"free motion": np.linalg.norm(error.motion,
            axis=1)}, path)` shows it.
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

    An increment that does not converge is halved, up to eight times, unless that cannot help (a stage that applies
    nothing; a mechanism; a first-order method that ran out of iterations); after one that does, the next is twice as
    long, up to what the stage asks for. One that begins in a stable equilibrium and meets negative curvature, more than
    wrinkled and slack cells have, is halved too: either smaller increments go around that, or they come to the load at
    which the structure snaps or buckles. An `UnstableStateWarning` tells it, for the first such load of each stage.

    Args:
        structure: The structure.
        solver: What finds equilibrium in each load increment.
        comm: The processes that share the work; each must give the same structure, solver and stages. What one of them
            refuses is refused by all; an exception in a script of yours is not seen from here, and others wait for
            that process for ever unless the script is run as `mpirun -n 2 python -m mpi4py script.py`.
        limit: Most work that each stage may take.
        progress: Whether stderr shows how far a stage is: a bar on a terminal, or else a line for each increment and
            one every ten seconds.

    Raises:
        ValueError: An argument is none such, or is not the same on all processes.
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
        self._problem = Problem(structure, comm)
        self._solve = solver.prepare(self._problem)
        self._record = Recorder(self._problem)

    def run(self, stages: Sequence[Stage], checkpoint_file: str | Path | None = None) -> StageResults:
        """Final state of each stage, by name; asking for a stage that is not there raises a KeyError with the names.

        Args:
            stages: The stages, each after the one it follows.
            checkpoint_file: Where to save the state after each converged increment. If the file is there, what is in
                it is not computed again, and the run goes on from it; stages may be added or left out, and have other
                `steps`. The solver may be another too: what is in the file is in equilibrium to the tolerance of the
                solver that found it, and the rest is found by the present one. It is one file of any name, an SQLite
                database; while a run has it, no other can use it, and its journal, named the same and "-journal", lies
                beside it and belongs to it. The first process alone reads and writes it.

        Raises:
            ValueError: A stage does not fit the structure or the other stages, or leaves the structure free to move
                as a rigid body (one turn about a line is let pass: loads may hold it); the checkpoint belongs to
                another structure or to other stages, was changed, is in use by another run or cannot be written; the
                processes have different input.
            ConvergenceError: A load increment found no equilibrium, or the limit of work is used up; what was computed
                before is on the exception.

        Warns:
            LargeStrainWarning: Strains of a stage, or those that belong to the prestress, are above 5 %.
            UnstableStateWarning: A state is not stable; the structure has snapped or buckled between two load factors
                (`Newton` with a line search tells); a node moved by more than half the size of the structure in the
                stage; or slack or wrinkled parts carry more than 1 % of the largest force of their kind.
            LostPrestressWarning: No cell of a part has 1 % of its prestress left.
            UnbalancedStateWarning: Unbalanced forces of a stage are above 1e-6 of the loads.
            CheckpointWarning: A state could not be saved, as on a full disk; the run goes on without.
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
            ends: dict[str | None, Actions] = {None: load_cases.unloaded(self.structure)}
            for stage in stages:
                ends[stage.name] = end = load_cases.target(self._problem, stage, ends[stage.after])
                shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
                start = load_cases.taking_hold(ends[stage.after], end, shape)
                state = saved.progress.get(stage.name) or Progress(shape, Fraction(0), Fraction(1, stage.steps), ())
                results[stage.name] = remarked(self._run(stage, start, end, state, results, saved.save), shape)
                with together(self._comm):
                    warn_of_remarks(results[stage.name], stacklevel=3)
                    if self._comm.rank == 0:
                        warn_of_large_strains(results[stage.name], stacklevel=3)
                        warn_of_unbalance(results[stage.name], stacklevel=3)
        return results

    def _check(self, stages: Sequence[Stage]) -> None:
        loads.check(self.structure, stages)
        held: dict[str | None, NDArray[np.bool_]] = {None: self.structure.supported}
        for stage in stages:
            held[stage.name] = held[stage.after] | load_cases.prescribed(stage, self.structure)[0]
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
        """Load increments of a stage from a converged state, between the actions at its start and its end."""
        full = Fraction(1, stage.steps)
        balanced = stage.after is not None or not self._problem.prestress_forces
        beyond: Progress | None = None  # a state past a loss of stability, while smaller increments locate that
        x = self._problem.discretization.distribute(state.displacement)
        with Report(stage.name, float(state.factor), shown=self._progress and self._comm.rank == 0) as report:
            ceiling = Ceiling()
            work = Work(self._limit, self._comm, report.iteration)
            while state.factor < 1:
                factor = ceiling.next(state.factor, state.size)
                _dolfinx.free_dropped(self._comm)
                self._problem.apply(load_cases.between(start, end, float(factor)))
                solution = self._solved(x, work, ceiling.smooth and beyond is None)
                judged = (balanced or state.factor > 0) and not any(entry.snapped for entry in state.increments)
                snapped = solution.converged and solution.lost_stability and judged
                remarks = (solution.drawn_smooth, solution.unstable, solution.unlisted, snapped)
                increment = Increment(float(factor), solution.iterations, *remarks)
                found = None
                if solution.converged:
                    size = full if snapped else min(2 * state.size, full)
                    shape = self._problem.discretization.gather(x)
                    found = Progress(shape, factor, size, (*state.increments, increment))
                else:
                    ceiling.failed(factor, len(work.iterates))
                beyond = found if snapped else beyond
                divisible = bool(stage.loads or stage.displacements) and state.size > full / 2**HALVINGS
                divisible = divisible and (snapped or not ceiling.reached(state.factor))
                if divisible and (snapped or (not solution.converged and solution.retry)):
                    state = replace(state, size=(factor - state.factor) / 2)
                    self._problem.discretization.distribute(state.displacement).copy(x)
                    continue
                reached = self._located(stage, start, end, state, found or beyond, work)
                if not reached:
                    shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
                    slack = self._slack(stage, x, load_cases.between(start, end, float(factor)))
                    last = remarked(self._result(stage, start, end, state), shape)
                    warn_of_remarks(last, stacklevel=4)
                    words = reason(self._problem, x, solution, state, beyond, ceiling, work) + slack
                    message = (
                        f"Stage {stage.name!r} found no equilibrium at load factor {float(factor):.6g} "
                        f"(the last found is at {float(state.factor):.6g}): {words}"
                    )
                    failed = increment._replace(snapped=False)  # that is not known yet
                    raise ConvergenceError(message, results, last, failed, solution.motion)
                state, beyond = reached, None
                ceiling.found(state.factor)
                self._problem.discretization.distribute(state.displacement).copy(x)
                save(stage.name, state)
                report.increment(float(state.factor), state.increments[-1].iterations[-1].residual)
        return self._result(stage, start, end, state)

    def _solved(self, x: PETSc.Vec, work: Work, thorough: bool) -> Solution:
        """How an increment ended; where the limit of work is used up it is not tried again."""
        work.iterates.clear()
        try:
            return self._solve(x, work, thorough)
        except WorkDone as done:
            return Solution(False, f"{done}; {MORE}", tuple(work.iterates), retry=False)

    def _located(
        self, stage: Stage, start: Actions, end: Actions, state: Progress, reached: Progress | None, work: Work
    ) -> Progress | None:
        """The state that follows another; None where there is none, or the limit of work ended the search for it."""
        if reached and not work.over and reached.increments[-1].snapped:
            reached = self._fallen(stage, start, end, state, reached, work)
        return None if work.over else reached

    def _fallen(
        self, stage: Stage, start: Actions, end: Actions, state: Progress, reached: Progress, work: Work
    ) -> Progress:
        """Notes with an increment that snapped where nothing but slack parts held the structure before.

        At the start of a stage forces may not show that yet: a small share of the increment brings them forth.
        """
        if not explained(self._problem):
            return reached  # nothing can be slack
        factor = float(state.factor) or PROBE * float(reached.factor)
        actions = load_cases.between(start, end, factor)
        self._problem.apply(actions)
        x = self._problem.discretization.distribute(state.displacement)
        if state.factor == 0 and not self._solved(x, work, thorough=False).converged:
            return reached
        *others, snap = reached.increments
        words = held_by_slack_parts(self._record(stage.name, x, actions, ()))
        return replace(reached, increments=(*others, snap._replace(fallen=words)))

    def _slack(self, stage: Stage, x: PETSc.Vec, actions: Actions) -> str:
        """What is slack or ends in the air in a state that is no equilibrium, in words."""
        if not np.isfinite(x.norm()):
            return ""
        state = self._record(stage.name, x, actions, ())
        return slack_parts(state) + hanging_ends(state)

    def _result(self, stage: Stage, start: Actions, end: Actions, state: Progress) -> StageResult:
        actions = load_cases.between(start, end, float(state.factor))
        self._problem.apply(actions)
        x = self._problem.discretization.distribute(state.displacement)
        return self._record(stage.name, x, actions, state.increments)
