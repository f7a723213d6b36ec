"""Globalized Newton-Raphson, Gil (74): line search on the energy, then inertia correction, then homotopy.

Prestressed nets and membranes are stiff in their surface and soft across. They slacken and wrinkle. Flat ones without
prestress have no stiffness across at all. Four strategies make Newton's method converge, each in a file of its own:

- A line search on the total potential energy shortens steps that overshoot (`line_search`).
- A shift of the tangent corrects its inertia after negative curvature or a short step (`inertia_correction`).
- A natural-parameter homotopy in a fading stabilization finds a start if both fail (`homotopy`).
- A step along negative curvature leaves an equilibrium that is not stable (`saddle`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..checks import validation
from . import factorization, petsc_options
from .base import LIMITS, Iteration, Monitor, Solution, max_norm, no_monitor
from .convergence import Patience, nearer
from .curvature import negative_between
from .diagnosis import collapsed, mechanism, mechanism_or_too_few, slack_mechanism, unlikely_units
from .homotopy import HomotopyControl, attempts_message, stabilized_start
from .inertia_correction import ShiftControl
from .newton_loop import NewtonLoop, Proceed, always
from .outcome import Outcome
from .saddle import SaddleControl, leave_saddle


@dataclass(frozen=True)
class Newton:
    """Newton-Raphson, Gil (74), by dolfinx's `NewtonSolver` with a direct factorization (MUMPS).

    PETSc options with the prefix `fx_membrane_` reach the linear solver: by the environment,
    `PETSC_OPTIONS="-fx_membrane_mat_mumps_icntl_14 100"`, or in a script, `PETSc.Options("fx_membrane_")["ksp_type"] =
    "cg"`, before the analysis is made:

    - `mat_mumps_icntl_N`, `mat_mumps_cntl_N`: controls of MUMPS, in all factorizations of the package. ICNTL(13) and
      ICNTL(24) must be 1, for the count of pivots.
    - `ksp_...`, `pc_...`: the linear solver of the steps, as `ksp_type cg` with `pc_type gamg`. Its tolerance is 1e-10
      unless `ksp_rtol` says so, at most 1e-6. Without a Cholesky factorization by MUMPS there is no count of pivots.
      Negative curvature is then seen along the steps only, as under a pressure. One factorization by MUMPS tests the
      state that is found. Paths, eigenvalues and the preconditioner "tangent" keep their factorization.

    Options that PETSc or this solver cannot honour are refused. `UnusedOptionWarning` names those without effect.

    Raises:
        ValueError: rtol is out of range; max_iterations is not a positive whole number.

    Args:
        rtol: Relative tolerance of the unbalanced forces: their 2-norm over that of all nodal forces, reactions and
            loads included. Rounding counts as converged. Rounding is that of the forces in each node, or stagnation
            below 1e-8 of all forces. A start converges only at rounding.
        max_iterations: Maximum number of iterations for one try of a load increment, those of all strategies together.
            The first attempt takes a fifth of them, at least 50, or more while residuals fall; the homotopy and the
            attempts after it take what remains. Each iteration is one step; a corrected inertia takes several
            factorizations.
        line_search: False gives the method of the textbook: full steps, with the tangent as it is. For loads without a
            potential (follower pressure in general) the energy includes their work along the step, which is exact.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> state = Analysis(rope, Newton(rtol=1e-12, max_iterations=50)).run([pull])["pull"]
        >>> state.cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
    """

    rtol: float = 1e-10
    max_iterations: int = 1000
    line_search: bool = True

    def __post_init__(self) -> None:
        validation.store(self, validation.tolerance, "rtol")
        validation.store(self, validation.positive_integer, "max_iterations")
        validation.store(self, validation.truth, "line_search")

    def prepare(self, problem: Problem) -> _Globalized:
        """Return a function that brings a vector to equilibrium; it keeps matrix and symbolic factorization.

        Raises:
            ValueError: PETSc options cannot be honoured.
        """
        petsc_options.check(problem.comm)
        return _Globalized(self, problem)


class _Globalized:
    """The strategies, one after the other.

    Attributes:
        problem: The problem of the present solve.
        loop: The iteration.
        patience: Length of an attempt.
        homotopy: Schedule of the homotopy.
        saddle: Limits of the escape from a saddle.
        told: True once options without effect were told.
    """

    patience, homotopy, saddle = Patience(), HomotopyControl(), SaddleControl()

    def __init__(self, settings: Newton, problem: Problem):
        self.settings, self.problem, self.told = settings, problem.under(), False
        self.loop = NewtonLoop(problem, settings.line_search, ShiftControl())
        create = problem.discretization.create_vector
        self.start, self.before = create(), create()

    def __call__(
        self, problem: LoadedProblem, x: PETSc.Vec, monitor: Monitor = no_monitor, thorough: bool = True
    ) -> Solution:
        loop, start = self.loop, x.copy(self.start)
        self.problem = problem
        loop.begin(problem, monitor, self.settings.max_iterations)
        solution = self.solve(x, start, thorough)
        if not self.told:
            self.told = True
            petsc_options.tell_unread(problem.comm, "Newton")
        lost = loop.lost_stability
        if solution.converged and loop.from_stable and not lost:
            lost = negative_between(self.problem, start, x)  # a step may pass over a snap-through
        return replace(solution, extra_iterations=loop.iterates - len(solution.iterations), lost_stability=lost)

    def release(self) -> None:
        """Free the factorization until the next solve; collective."""
        factorization.release(self.loop.ksp)

    def solve(self, x: PETSc.Vec, start: PETSc.Vec, thorough: bool) -> Solution:
        """Run the strategies."""
        free = cache(lambda: mechanism(self.problem, start))

        def proceed(history: list[Iteration]) -> bool:
            return not self.due(history) or (thorough and self.falling(history, False) and not has_fallen())

        def has_fallen() -> bool:
            return bool(free()) and self.distance(start, x) > LIMITS.fallen * self.problem.structure.size

        solution = self.attempt(x, proceed)
        if not self.settings.line_search:
            return solution
        if solution.converged:
            return self.escape_saddle(x, solution)
        # A mechanism stays one in a smaller increment.
        if solution.outcome is not Outcome.LINEAR_LIMIT and thorough and self.loop.left and not has_fallen():
            start.copy(x)
            left = self.loop.left
            stabilized_start(self.loop, x, self.homotopy)
            homotopy = left - self.loop.left
            second = self.attempt(x, lambda history: not self.due(history) or self.falling(history, True))
            if second.converged and not collapsed(self.problem, x):
                return self.escape_saddle(x, replace(second, outcome=Outcome.STABILIZED))
            solution = replace(solution, reason=solution.reason + attempts_message(solution, homotopy, second))
        units = unlikely_units(self.problem, start)
        motion = free() or slack_mechanism(self.problem, start)
        if not motion:
            return replace(solution, reason=solution.reason + units)
        if free() and not has_fallen() and self.cut_short(solution, thorough):
            words = mechanism_or_too_few(motion, self.settings.max_iterations, self.loop.history[-1].residual)
            return replace(solution, outcome=Outcome.MAX_ITERATIONS, reason=words + units, motion=motion.motion)
        outcome = Outcome.MECHANISM if free() else Outcome.SLACK_MECHANISM
        return replace(solution, outcome=outcome, reason=motion.words + units, motion=motion.motion)

    def cut_short(self, first: Solution, thorough: bool) -> bool:
        """Return True if the strategies were cut off before their end, so that more iterations may help.

        Without the homotopy, the first attempt ends by patience, a share of the limit.
        """
        slow = first.outcome in (Outcome.MAX_ITERATIONS, Outcome.STAGNATED)
        return not self.loop.left or (slow and not thorough)

    def attempt(self, x: PETSc.Vec, proceed: Proceed = always) -> Solution:
        """Run the iteration, at most up to the end of the total."""
        return self.loop.attempt(x, self.settings.rtol, self.loop.left, proceed)

    def due(self, history: list[Iteration]) -> bool:
        """Return True if an attempt continues only while its residuals fall."""
        return self.patience.due(len(history) - 1, self.settings.max_iterations)

    def falling(self, history: list[Iteration], unknown: bool) -> bool:
        """Return True if the residuals of an attempt fall, or `unknown` without a trend."""
        return nearer(history, self.patience.usual(self.settings.max_iterations), unknown)

    def distance(self, start: PETSc.Vec, x: PETSc.Vec) -> float:
        """Largest displacement of a component between two states [m]."""
        with self.problem.discretization.work(1) as (way,):
            way.waxpy(-1.0, start, x)
            return max_norm(way)

    def untouched(self, solution: Solution) -> bool:
        """Return True if the start is the solution, as without loads; water may stand there in an unstable balance."""
        return len(solution.iterations) == 1 and not any(energy.is_load for energy in self.problem.integrals.all)

    def escape_saddle(self, x: PETSc.Vec, solution: Solution) -> Solution:
        """Escape from an unstable equilibrium to a stable one.

        A last tangent without shift had no negative curvature, so that the equilibrium is stable.
        """
        loop = self.loop
        for _ in range(self.saddle.attempts):
            if self.untouched(solution) or (len(solution.iterations) > 1 and loop.counts_pivots and loop.shift == 0):
                return solution
            x.copy(self.before)
            if not leave_saddle(self.problem, x, self.saddle):
                return solution
            loop.lost_stability |= loop.from_stable
            onward = self.attempt(x)
            if not onward.converged:
                self.before.copy(x)
                break
            solution = replace(onward, outcome=solution.outcome, iterations=solution.iterations + onward.iterations)
        return replace(solution, outcome=Outcome.UNSTABLE)
