"""Stages: load increments, load cases that branch from a common state, and results that are never lost."""

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from . import loads, validation
from .loads import DeadLoad, PointLoad, Stage
from .problem import Actions, Problem
from .results import Increment, Recorder, StageResult
from .rigid_motion import check_supports
from .solver import Newton
from .structure import Structure


class ConvergenceError(RuntimeError):
    """A load increment found no equilibrium.

    Attributes:
        results: Results of the stages that were completed, by name.
        last: The last converged state of the stage that failed: that of its last increment that converged, or else
            the state it started from.
        failed: The increment that did not converge, with its iterations.
    """

    def __init__(self, message: str, results: dict[str, StageResult], last: StageResult, failed: Increment):
        super().__init__(message)
        self.results, self.last, self.failed = results, last, failed


class Analysis:
    """Nonlinear statics of a structure; meshes are made and forms compiled once, for all its stages.

    Args:
        structure: The structure.
        solver: What finds equilibrium in each load increment.
        comm: The processes that share the work; each must give the same structure and stages.
    """

    def __init__(self, structure: Structure, solver: Newton = Newton(), comm: MPI.Intracomm = MPI.COMM_WORLD):
        self.structure = structure
        self._problem = Problem(structure, comm)
        self._solve = solver.prepare(self._problem)
        self._record = Recorder(self._problem)

    def run(self, stages: Sequence[Stage]) -> dict[str, StageResult]:
        """Final state of each stage, by name.

        Raises:
            ValueError: A stage does not fit the structure or the other stages, or leaves the structure free to move
                as a rigid body.
            ConvergenceError: A load increment found no equilibrium; what was computed before is on the exception.
        """
        loads.check(self.structure, stages)
        held: dict[str | None, NDArray[np.bool_]] = {None: self.structure.supported}
        for stage in stages:
            held[stage.name] = held[stage.after] | _prescribed(stage, self.structure)[0]
            check_supports(self.structure, held[stage.name])

        zero = np.zeros(self.structure.points.shape)
        results: dict[str, StageResult] = {}
        ends: dict[str | None, Actions] = {None: Actions(zero, self.structure.supported, zero)}
        for stage in stages:
            start, displacement = ends[stage.after], zero if stage.after is None else results[stage.after].displacement
            ends[stage.name] = self._target(stage, start)
            results[stage.name] = self._run(stage, start, ends[stage.name], displacement, results)
        return results

    def _target(self, stage: Stage, start: Actions) -> Actions:
        """Actions at the end of a stage: those at its start, and its own."""
        point_loads = np.zeros(self.structure.points.shape)
        dead_loads = {
            name: np.zeros((len(part.cells), 3))
            for name, part in self.structure.parts.items()
            if any(isinstance(load, DeadLoad) and load.part == name for load in stage.loads)
        }
        for load in stage.loads:
            if isinstance(load, PointLoad):
                np.add.at(point_loads, np.asarray(load.nodes), load.force)
            else:
                cells = np.arange(len(dead_loads[load.part])) if load.cells is None else np.asarray(load.cells)
                np.add.at(dead_loads[load.part], cells, load.load)
        held, displacement = _prescribed(stage, self.structure)
        return Actions(
            loads=start.loads + point_loads + self._problem.nodal_loads(dead_loads),
            held=start.held | held,
            displacement=np.where(held, displacement, start.displacement),
        )

    def _run(
        self,
        stage: Stage,
        start: Actions,
        end: Actions,
        displacement: NDArray[np.float64],
        results: dict[str, StageResult],
    ) -> StageResult:
        """Load increments of a stage, from a converged displacement at the start actions."""
        free = ~start.held  # what this stage takes hold of starts from where it is
        start = Actions(start.loads, end.held, np.where(free, displacement, start.displacement))
        actions = start
        x = self._problem.discretization.distribute(displacement)
        converged = x.copy()
        increments: list[Increment] = []
        for step in range(1, stage.steps + 1):
            factor = step / stage.steps
            target = _between(start, end, factor)
            self._problem.apply(target)
            solution = self._solve(x)
            if not solution.converged:
                self._problem.apply(actions)
                last = self._record(stage.name, converged, actions, tuple(increments))
                failed = Increment(factor, solution.iterations)
                message = f"Stage {stage.name!r} found no equilibrium at load factor {factor:.6g}: {solution.reason}"
                raise ConvergenceError(message, results, last, failed)
            actions = target
            x.copy(converged)
            increments.append(Increment(factor, solution.iterations))
        return self._record(stage.name, x, actions, tuple(increments))


def _between(start: Actions, end: Actions, factor: float) -> Actions:
    return Actions(
        loads=start.loads + factor * (end.loads - start.loads),
        held=end.held,
        displacement=start.displacement + factor * (end.displacement - start.displacement),
    )


def _prescribed(stage: Stage, structure: Structure) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Components that a stage prescribes, shape (n, 3), and their displacements, shape (n, 3) [m]."""
    held = np.zeros(structure.points.shape, dtype=bool)
    displacement = np.zeros(structure.points.shape)
    for entry in stage.displacements:
        for component in validation.components("PrescribedDisplacement components", entry.components):
            held[entry.nodes, component] = True
            displacement[entry.nodes, component] = np.asarray(entry.displacement)[..., component]
    return held, displacement
