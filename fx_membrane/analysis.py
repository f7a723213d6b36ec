"""Stages: load increments, load cases that branch from a common state, and results that are never lost."""

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from . import checkpoint, load_case, loads, validation
from .balance import warn_of_unbalance
from .checkpoint import Progress
from .first_order import ConjugateGradient, SteepestDescent
from .increments import HALVINGS, Ceiling
from .large_strain import warn_of_large_prestress, warn_of_large_strains
from .loads import Stage
from .newton import Newton
from .problem import Actions, Problem
from .progress import Report
from .recorder import Recorder
from .results import Increment, StageResult, StageResults, UnstableStateWarning
from .rigid_motion import check_supports
from .slackness import hanging_ends, slack_parts
from .solver import FALLEN, Solution
from .structure import Structure
from .work import Work, WorkDone, WorkLimit

MORE = "allow more (WorkLimit), or see in its iterations, `failed`, whether it comes nearer at all"

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
        comm: The processes that share the work; each must give the same structure and stages.
        limit: Most work that each stage may take.
        progress: Whether stderr shows how far a stage is: a bar on a terminal, or else a line for each increment and
            one every ten seconds.
    """

    def __init__(
        self,
        structure: Structure,
        solver: AnySolver = Newton(),
        comm: MPI.Intracomm = MPI.COMM_WORLD,
        limit: WorkLimit = WorkLimit(),
        progress: bool = True,
    ):
        validation.instance("Analysis structure", structure, Structure)
        validation.instance("Analysis solver", solver, AnySolver)
        validation.instance("Analysis limit", limit, WorkLimit)
        validation.instance("Analysis progress", progress, bool)
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
                solver that found it, and the rest is found by the present one.

        Raises:
            ValueError: A stage does not fit the structure or the other stages, or leaves the structure free to move
                as a rigid body (one turn about a line is let pass: loads may hold it); the checkpoint belongs to
                another structure or to other stages.
            ConvergenceError: A load increment found no equilibrium, or the limit of work is used up; what was computed
                before is on the exception.

        Warns:
            LargeStrainWarning: Strains of a stage, or those that belong to the prestress, are above 5 %.
            UnstableStateWarning: A state is not stable; the structure has snapped or buckled between two load factors
                (`Newton` with a line search tells); or a node moved by more than half the size of the structure in
                one increment; this once for each stage.
            UnbalancedStateWarning: Unbalanced forces of a stage are above 1e-6 of the loads.
        """
        self._check(stages)
        if self._comm.rank == 0:
            warn_of_large_prestress(self.structure, stacklevel=3)
        path = None if checkpoint_file is None else Path(checkpoint_file)
        progress = {} if path is None else checkpoint.load(path, self.structure, stages)

        def save(name: str, state: Progress) -> None:
            progress[name] = state
            if path is not None and self._comm.rank == 0:
                checkpoint.save(path, self.structure, stages, progress)

        results = StageResults()
        ends: dict[str | None, Actions] = {None: load_case.unloaded(self.structure)}
        for stage in stages:
            ends[stage.name] = end = load_case.target(self._problem, stage, ends[stage.after])
            shape = results[stage.after].displacement if stage.after else np.zeros(self.structure.points.shape)
            start = load_case.taking_hold(ends[stage.after], end, shape)
            state = progress.get(stage.name) or Progress(shape, Fraction(0), Fraction(1, stage.steps), ())
            results[stage.name] = self._run(stage, start, end, state, results, save)
            if self._comm.rank == 0:
                warn_of_large_strains(results[stage.name], stacklevel=3)
                warn_of_unbalance(results[stage.name], stacklevel=3)
        return results

    def _check(self, stages: Sequence[Stage]) -> None:
        loads.check(self.structure, stages)
        held: dict[str | None, NDArray[np.bool_]] = {None: self.structure.supported}
        for stage in stages:
            held[stage.name] = held[stage.after] | load_case.prescribed(stage, self.structure)[0]
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
        far = False  # whether a node has been found to have moved very far
        with Report(stage.name, float(state.factor), shown=self._progress and self._comm.rank == 0) as report:
            ceiling = Ceiling()
            work = Work(self._limit, self._comm, report.iteration)
            while state.factor < 1:
                factor = ceiling.next(state.factor, state.size)
                self._problem.apply(load_case.between(start, end, float(factor)))
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
                elif reached := found or beyond:
                    moved = "" if far else _fallen(self.structure, reached.displacement - state.displacement, end.held)
                    _warn_of_instability(stage.name, state.factor, reached, moved)
                    far = far or bool(moved)
                    state, beyond = reached, None
                    ceiling.found(state.factor)
                    self._problem.discretization.distribute(state.displacement).copy(x)
                    save(stage.name, state)
                    report.increment(float(state.factor), state.increments[-1].iterations[-1].residual)
                else:
                    slack = self._slack(stage, x, load_case.between(start, end, float(factor)))
                    last = self._result(stage, start, end, state)
                    words = ceiling.words(state.factor) if solution.retry else ""
                    message = (
                        f"Stage {stage.name!r} found no equilibrium at load factor {float(factor):.6g} "
                        f"(the last found is at {float(state.factor):.6g}): {words}{solution.reason}{slack}"
                    )
                    raise ConvergenceError(message, results, last, increment, solution.motion)
        return self._result(stage, start, end, state)

    def _solved(self, x: PETSc.Vec, work: Work, thorough: bool) -> Solution:
        """How an increment ended; where the limit of work is used up it is not tried again."""
        work.iterates.clear()
        try:
            return self._solve(x, work, thorough)
        except WorkDone as done:
            return Solution(False, f"{done}; {MORE}", tuple(work.iterates), retry=False)

    def _slack(self, stage: Stage, x: PETSc.Vec, actions: Actions) -> str:
        """What is slack or ends in the air in a state that is no equilibrium, in words."""
        if not np.isfinite(x.norm()):
            return ""
        state = self._record(stage.name, x, actions, ())
        return slack_parts(state) + hanging_ends(state)

    def _result(self, stage: Stage, start: Actions, end: Actions, state: Progress) -> StageResult:
        actions = load_case.between(start, end, float(state.factor))
        self._problem.apply(actions)
        x = self._problem.discretization.distribute(state.displacement)
        return self._record(stage.name, x, actions, state.increments)


def _warn_of_instability(name: str, before: Fraction, reached: Progress, moved: str) -> None:
    """Warns of a state that is not stable, and where the structure snapped or a node moved very far to reach it."""
    increment, factor = reached.increments[-1], float(reached.factor)
    words = []
    if increment.unstable:
        words.append(
            f"the equilibrium found at load factor {factor:.6g} is not stable, and none that is was found from there; "
            "stability(state) shows how it gives way. Add supports, members or prestress against that."
        )
    if increment.snapped:
        words.append(
            f"between load factors {float(before):.6g} and {factor:.6g} the structure lost its stability: it has "
            "snapped or buckled into another shape. Stay below that load, or add supports, members or prestress, if "
            "that is not meant; `trace` shows the limit point."
        )
    elif moved:
        words.append(
            f"up to load factor {factor:.6g} {moved}, more than half the size of the structure in one increment: it "
            "has fallen, snapped, hung down or been stretched into quite another shape. If that is not meant, check "
            "units and stiffness, and whether something is slack or missing; `trace` shows the way there."
        )
    for sentence in words:
        warnings.warn(f"Stage {name!r}: {sentence}", UnstableStateWarning, stacklevel=4)


def _fallen(structure: Structure, motion: NDArray[np.float64], held: NDArray[np.bool_]) -> str:
    """Which node moved very far, further than what is moved by prescription, in words; empty where none did."""
    moved, given = (np.linalg.norm(np.where(where, motion, 0.0), axis=1) for where in (~held, held))
    node = int(moved.argmax())
    far = FALLEN * structure.size + given.max()
    return f"node {node} moved by {moved[node]:.3g}" if moved[node] > far else ""
