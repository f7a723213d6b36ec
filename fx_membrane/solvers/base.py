"""The solver interface: a problem and a start go in, a state with its history and reason comes out."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..model.by_value import ByValue
from .outcome import Outcome


@dataclass(frozen=True)
class SolverLimits:
    """Limits that all solvers share.

    Attributes:
        rounding: Relative error of a sum by rounding.
        scale: Largest force scale of a relative tolerance, as a multiple of the loads.
        fallen: Displacement, in sizes of the structure, that leaves the original shape.
        far: Displacement, in sizes of the structure, that counts as divergence.
        rest: Fraction of all forces below which a stagnant residual is at rounding.
    """

    rounding: float = 1e-14
    scale: float = 1e3
    fallen: float = 0.5
    far: float = 1e3
    rest: float = 1e-8


LIMITS = SolverLimits()


class Iteration(NamedTuple):
    """Line of a convergence table.

    Attributes:
        energy: Total potential energy [J].
        residual: Largest unbalanced nodal force [N], infinity norm; at constrained components short of their prescribed
            displacement, the error times a typical stiffness.
        step: Length of the step that led here, in (0, 1]; 0 at the start.
        shift: Shift of the tangent for that step, lambda in K + lambda T with the stabilization matrix T: the stiffness
            of a tension of strain one in all parts [-]; 0 without a shift.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> increment = Analysis(rope).run([pull])["pull"].increments[0]
        >>> residuals = [iteration.residual for iteration in increment.iterations]
        >>> residuals[-1] < 1e-6 < residuals[0]
        True
    """

    energy: float
    residual: float
    step: float
    shift: float = 0.0


@dataclass(frozen=True, eq=False)
class Solution(ByValue):
    """End of a solve; the state itself is in the vector given to it.

    Attributes:
        outcome: Outcome.
        reason: Sentence on why the solve stopped and, after a failure, on the remedy.
        iterations: The iterates, the start first. Of several attempts, those of the one that gives the outcome: the one
            after the homotopy if it converged, or else the first.
        extra_iterations: Number of iterates missing from `iterations`: those of rejected attempts and of the homotopy.
        lost_stability: True if the start was stable, but negative curvature appeared during the iteration, beyond that
            of wrinkled and slack cells: that of masts or a pressure. Iterates can be far off, so smaller load
            increments may avoid it.
        motion: Free motion of a mechanism that made the solve fail, its largest displacement of size one, shape (n, 3).

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> problem = Problem(rope)
        >>> solve = Newton().prepare(problem)
        >>> solution = solve(problem.under(problem.actions_of(pull)), problem.create_vector())
        >>> solution.converged, solution.reason
        (True, 'equilibrium was found.')
    """

    outcome: Outcome
    reason: str
    iterations: tuple[Iteration, ...]
    extra_iterations: int = 0
    lost_stability: bool = False
    motion: NDArray[np.float64] | None = None

    if TYPE_CHECKING:  # the field is a tuple, but a list may be given

        def __init__(
            self,
            outcome: Outcome,
            reason: str,
            iterations: Sequence[Iteration],
            extra_iterations: int = ...,
            lost_stability: bool = ...,
            motion: NDArray[np.float64] | None = ...,
        ) -> None: ...

    @property
    def converged(self) -> bool:
        """True if the state is an equilibrium."""
        return self.outcome.converged


Monitor = Callable[[int, Iteration], None]


class Solve(Protocol):
    """Function that brings a vector to equilibrium and reports each iterate to the monitor.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> class Told:
        ...     def prepare(self, problem):
        ...         solve = Newton().prepare(problem)
        ...         def told(loaded, x, monitor, thorough):
        ...             solution = solve(loaded, x, monitor, thorough)
        ...             print(solution.outcome.name)
        ...             return solution
        ...         return told
        ...
        >>> states = Analysis(rope, Told()).run([pull])
        CONVERGED
    """

    def __call__(self, loaded: LoadedProblem, x: PETSc.Vec, monitor: Monitor, thorough: bool, /) -> Solution:
        """Return the outcome; the state is in x.

        Args:
            loaded: The structure under the actions of the increment: a view of the problem that `prepare` got, with
                the same numbering and sparsity pattern.
            x: The last state found, to be replaced by the equilibrium [m]. `loaded.constraints` imposes the prescribed
                displacements on it.
            monitor: Called with the number and the data of each iterate, the start first; on all processes. Let its
                exception through: it ends the solve at the limit of work.
            thorough: False to omit slow fallbacks that find distant states.
        """
        ...


class Solver(Protocol):
    """Solver of `Analysis`: any object with this method, as `Newton` or one of your own (`demos/own_solver.py`).

    `Analysis` calls `prepare` once, and the function that it returns for each load increment, on all processes. A
    failure with an outcome whose `retry` is true halves the increment. A state called an equilibrium is refused if it
    breaks the constraints; if its forces do not balance, `UnbalancedStateWarning` tells. Processes compare the class of
    a solver and those public attributes that are numbers or texts.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> class Strict:
        ...     def prepare(self, problem):
        ...         return Newton(rtol=1e-13).prepare(problem)
        ...
        >>> Analysis(rope, Strict()).run([pull])["pull"].cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
    """

    def prepare(self, problem: Problem, /) -> Solve:
        """Return a function that brings a vector to equilibrium and keeps its workspace between calls."""
        ...


def no_monitor(number: int, iterate: Iteration) -> None:
    """Monitor that does nothing."""


def tolerance(problem: LoadedProblem, x: PETSc.Vec, b: PETSc.Vec, rtol: float) -> float:
    """Upper limit of the 2-norm of the unbalanced forces, rounding set aside [N], for the residual b in x.

    With prestress far above the loads it is a fraction of the loads, so that their effect is found, too.

    Args:
        problem: The problem.
        x: The iterate.
        b: Its residual, with the reactions at constrained components.
        rtol: Fraction of the norm of all nodal forces, or of `scale` times that of the loads if smaller. At the start
            pass `rounding`, so that loads far below the prestress take their step too.
    """
    loads = problem.load_norm(x)
    forces = float(b.norm()) + loads + problem.standing_norm(x)
    return max(rtol * min(forces, LIMITS.scale * loads or forces), 1e-300)


def diverged(problem: LoadedProblem, x: PETSc.Vec, residual: float) -> bool:
    """Return True if the iterate has diverged or is not a number."""
    return not (math.isfinite(residual) and max_norm(x) <= LIMITS.far * problem.structure.size)


def max_norm(vector: PETSc.Vec) -> float:
    """Largest absolute value; NaN on every process if an entry is NaN.

    MPI_MAX does not define the result for NaN, so that processes could disagree.
    """
    return math.nan if math.isnan(vector.sum()) else float(vector.norm(PETSc.NormType.NORM_INFINITY))


def iterate(problem: LoadedProblem, x: PETSc.Vec) -> Iteration:
    """Energy and unbalanced force of a state."""
    with problem.discretization.work(1) as (b,):
        energy = problem.energy_and_residual(x, b)
        problem.constraints.constrain_residual(x, b)
        return Iteration(energy, max_norm(b), 0.0)
