"""Globalized Newton-Raphson, Gil (74): line search on the energy, then inertia correction, then homotopy.

Prestressed nets and membranes are stiff in their surface and soft across. They slacken and wrinkle. Flat ones without
prestress have no stiffness across at all. Three strategies make Newton's method converge:

- A line search on the total potential energy shortens steps that overshoot.
- A shift of the tangent, an artificial tension, corrects its inertia after negative curvature or a short step. The
  signs of the pivots show the curvature. The shift decays with the residual and vanishes at the solution. Sources:
  A. Waechter, L. T. Biegler, Math. Program. 106 (2006) 25-57 (inertia correction in Ipopt); TAO's Newton line search
  (TAONLS); C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998) 508-523 (pseudo-transient continuation).
- A natural-parameter homotopy finds a start if both fail: stabilization by an artificial tension in the structure
  itself, reduced from solve to solve.
"""

import weakref
from dataclasses import dataclass, replace
from typing import cast

from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.loaded_problem import LoadedProblem
from ..assembly.problem import Problem
from ..checks import validation
from . import artificial_tension, factorization
from .backends import by_dolfinx, by_snes
from .base import FALLEN, FAR, ROUNDING, Iteration, Monitor, Solution, Solve, diverged, max_norm, no_monitor, tolerance
from .convergence import at_rest, nearer
from .curvature import negative_between, negative_curvature_direction, wrinkling_threshold
from .diagnosis import collapsed, linear_failure, mechanism, slack_mechanism, stagnation_message, unlikely_units
from .line_search import step_back

# The numbers from here on have no source: they were chosen by trial on tests/benchmarks/hard_cases.py.

# Levels of the homotopy: artificial tension in the structure, as a strain.
HOMOTOPY = tuple(10.0**-i for i in range(2, 9))
ROUGH, FEW = 1e-3, 40  # tolerance and iterations of each level
PATIENCE, MORE = 5, 50  # factor of max_iterations, and batch, while residuals fall: slack fabric converges slowly

# Escape from a saddle of the energy.
ESCAPE, ESCAPES = 1e-3, 3  # size of the step, in sizes of the structure, and number of attempts

REST = 1e-8  # fraction of all forces below which a stagnant residual is at rounding


@dataclass(frozen=True)
class Newton:
    """Newton-Raphson, Gil (74), by dolfinx's `NewtonSolver` with a direct factorization (MUMPS).

    Raises:
        ValueError: rtol is out of range; max_iterations is not a positive whole number.

    Args:
        rtol: Relative tolerance of the unbalanced forces: their 2-norm over that of all nodal forces, reactions and
            loads included. Rounding counts as converged. Rounding is that of the forces in each node, or stagnation
            below 1e-8 of all forces. A start converges only at rounding.
        max_iterations: Maximum number of iterations for one load increment; up to five times as many while residuals
            fall.
        line_search: False gives the method of the textbook: full steps, with the tangent as it is. For loads without a
            potential (follower pressure in general) the energy includes their work along the step, which is exact.
    """

    rtol: float = 1e-10
    max_iterations: int = 200
    line_search: bool = True

    def __post_init__(self) -> None:
        validation.store(self, validation.tolerance, "rtol")
        validation.store(self, validation.positive_integer, "max_iterations")
        validation.store(self, validation.truth, "line_search")

    def prepare(self, problem: Problem) -> Solve:
        """Return a function that brings a vector to equilibrium; it keeps matrix and symbolic factorization."""
        return _NewtonRaphson(self, problem)


class _Stop(Exception):  # noqa: N818  (not an error but a message from callback to caller)
    """Exception that ends the iteration from inside a callback, with the reason as a sentence."""


class _NewtonRaphson:
    """The iteration: callbacks for residual, tangent and step, and their backend.

    Attributes:
        problem: The problem of the present solve.
        length: Length of the last step.
        added: Shift of the tangent for that step, as a strain.
        iterates: Number of iterates since the solve began, rejected ones included.
        first: True in the first attempt of the solve.
        from_stable: True if the first tangent of the solve had no more negative curvature than slack cells have.
        lost_stability: True if a later tangent had more.
    """

    def __init__(self, settings: Newton, problem: Problem):
        self.settings = settings
        self.problem = problem.under()
        self.A = problem.discretization.create_matrix()
        self.b = problem.discretization.create_vector()
        create = problem.discretization.create_vector
        self.work, self.begin, self.origin, self.before, self.here = (create() for _ in range(5))
        self.history: list[Iteration] = []
        self.monitor: Monitor = no_monitor
        self.rtol = self.tolerance = self.length = self.added = 0.0
        self.balanced = False
        self.most = settings.max_iterations
        self.iterates, self.first = 0, True
        self.symmetric, self.from_stable, self.lost_stability = True, False, False
        self.size = problem.structure.size
        self.newton = _dolfinx.newton_solver(problem.comm)
        # The backends hold their callbacks in C and C++, invisible to Python's garbage collector: a weak reference lets
        # the problem be freed before the program ends.
        owner = cast(_NewtonRaphson, weakref.proxy(self))
        self.iterate, self.ksp = by_snes(owner) if self.newton is None else by_dolfinx(owner)
        factorization.keep_until_all_are_done(self, problem.comm, self.ksp)

    def __call__(
        self, problem: LoadedProblem, x: PETSc.Vec, monitor: Monitor = no_monitor, thorough: bool = True
    ) -> Solution:
        self.problem, self.monitor, self.iterates = problem, monitor, 0
        self.from_stable = self.lost_stability = False
        start = x.copy(self.begin)
        solution = self.solve(x, thorough)
        if solution.converged and self.from_stable and not self.lost_stability:
            self.lost_stability = negative_between(self.problem, start, x)  # a step may pass over a snap-through
        extra_iterations = self.iterates - len(solution.iterations)
        return replace(solution, extra_iterations=extra_iterations, lost_stability=self.lost_stability)

    def solve(self, x: PETSc.Vec, thorough: bool) -> Solution:
        """Run the strategies one after the other."""
        start = x.copy(self.origin)
        solution = self.attempt(x, self.settings.rtol, self.settings.max_iterations)
        if not self.settings.line_search:
            return solution
        free = None if solution.converged else mechanism(self.problem, start)
        # A mechanism stays one in a smaller increment.
        self.work.waxpy(-1.0, start, x)
        thorough = thorough and not (free and max_norm(self.work) > FALLEN * self.size)
        if thorough:
            solution = self.onward(x, solution, unknown=False)
        if solution.converged:
            return self.escape_saddle(x, solution)
        if thorough:
            start.copy(x)
            self.stabilized_start(x)
            second = self.attempt(x, self.settings.rtol, self.settings.max_iterations)
            second = self.onward(x, second, unknown=True)
            if second.converged and not collapsed(self.problem, x):
                return replace(self.escape_saddle(x, second), stabilized=True)
        motion = free or slack_mechanism(self.problem, start)
        reason = motion.words if motion else solution.reason
        return replace(
            solution,
            reason=reason + unlikely_units(self.problem, start),
            retry=solution.retry and not free,
            motion=motion.motion if motion else None,
        )

    def onward(self, x: PETSc.Vec, solution: Solution, unknown: bool) -> Solution:
        """Resume an attempt that ran out of iterations, while residuals fall or their trend is unknown."""
        usual = self.settings.max_iterations
        most = PATIENCE * usual
        while not solution.converged and usual < len(self.history) <= most and nearer(self.history, usual, unknown):
            self.history.pop()  # evaluated again
            self.most = min(MORE, most - len(self.history))
            solution = self.run(x)
        return solution

    def escape_saddle(self, x: PETSc.Vec, solution: Solution) -> Solution:
        """Escape from an unstable equilibrium along its lowest mode to a stable one.

        A last tangent without shift had no negative curvature, so that the equilibrium is stable.
        """
        for _ in range(ESCAPES):
            if len(solution.iterations) == 1 or (self.symmetric and self.added == 0):
                return solution
            found = negative_curvature_direction(self.problem, x)
            if found.negative == 0:
                return solution
            self.lost_stability |= self.from_stable
            before = x.copy(self.before)
            step = found.motion
            step.scale(ESCAPE * self.size / step.norm(PETSc.NormType.NORM_INFINITY))
            energy = self.problem.energy_along(x, step)
            x.axpy(1.0 if energy(1.0) < energy(-1.0) else -1.0, step)
            onward = self.attempt(x, self.settings.rtol, self.settings.max_iterations)
            if not onward.converged:
                before.copy(x)
                break
            solution = replace(onward, iterations=solution.iterations + onward.iterations)
        return replace(solution, unstable=True)

    def stabilized_start(self, x: PETSc.Vec) -> None:
        """Solve a homotopy in a fading artificial tension."""
        given = self.problem
        try:
            for tension in HOMOTOPY:
                self.problem = given.with_stabilization(tension)
                before = x.copy(self.before)
                self.attempt(x, ROUGH, FEW)
                if not max_norm(x) <= FAR * self.size:
                    before.copy(x)
                    return
        finally:
            self.problem = given

    def attempt(self, x: PETSc.Vec, rtol: float, most: int) -> Solution:
        """Run the iteration once."""
        self.history, self.rtol, self.most = [], rtol, most
        self.first = self.iterates == 0
        self.length = self.added = 0.0
        self.symmetric = self.problem.symmetric or self.conservative(x)
        factorization.choose(self.ksp, self.A, self.symmetric)
        return self.run(x)

    def run(self, x: PETSc.Vec) -> Solution:
        """Resume the iteration from an iterate, for `most` iterations."""
        try:
            with _dolfinx.quiet_log():
                converged = self.iterate(x)
        except _Stop as stop:
            # A tangent that is singular at the start of an increment stays so for any smaller one.
            retry = self.settings.line_search or len(self.history) > 1
            return Solution(False, str(stop), tuple(self.history), retry)
        reason = "converged" if converged else self.stagnation_message(x)
        return Solution(converged, reason, tuple(self.history), retry=True)

    def conservative(self, x: PETSc.Vec) -> bool:
        """Return True if pressures have a potential here, as within held edges: the tangent is symmetric."""
        self.problem.tangent(x, self.A)
        self.problem.constraints.constrain_tangent(x, self.A, self.b)
        return factorization.is_symmetric(self.A)

    def stagnation_message(self, x: PETSc.Vec) -> str:
        """Sentence on why the last iterate is no solution."""
        last = self.history[-1].residual
        # Small, and no longer falling.
        at_rounding = len(self.history) > 2 and self.history[-2].residual < 10 * last < 1e4 * self.tolerance
        return stagnation_message(self.problem, x, len(self.history) - 1, last, at_rounding)

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual with constraints; record the iterate and the tolerance for its 2-norm."""
        self.problem.residual(x, b)
        self.tolerance = tolerance(self.problem, x, b, self.rtol if self.history else ROUNDING)
        self.problem.constraints.constrain_residual(x, b)
        beyond, unbalanced = self.problem.beyond_rounding(x, b), max_norm(b)
        self.history.append(Iteration(self.problem.energy(x), unbalanced, self.length, self.added))
        small = beyond < REST * self.tolerance / self.rtol
        self.balanced = beyond < self.tolerance or (small and at_rest(self.history))
        self.iterates += 1
        self.monitor(len(self.history) - 1, self.history[-1])
        if diverged(self.problem, x, unbalanced):
            raise _Stop(self.stagnation_message(x))

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Tangent and right-hand side with constraints."""
        A.setOption(PETSc.Mat.Option.SYMMETRIC, self.symmetric)
        self.problem.tangent(x, A)
        self.problem.constraints.constrain_tangent(x, A, self.b)
        damping = artificial_tension.to_begin_with(self.length, self.added, self.history)
        self.added = 0.0
        if damping:
            self.add_tension(x, damping)

    def step(self, x: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Replace the solution dx of the linear system by the step: the next iterate is x - dx."""
        self.length = 1.0
        if not self.settings.line_search:
            if not factorization.solves(self.A, dx, self.b, self.work):
                raise _Stop(linear_failure(self.problem, self.A))
            return
        start = x.copy(self.here)
        moved = self.problem.constraints.impose(start)
        length = None
        while length is None:
            while not self.is_descent(dx):
                self.correct_inertia(x, dx)
            self.problem.constraints.zero_constrained(dx)
            length = step_back(self.problem, self.b, self.history[-1].energy, start, dx, moved)
            if length is None:
                self.correct_inertia(x, dx)
        if self.iterates == 1:
            # The least shift makes up for slack cells; without slack cells it would hide an unstable start.
            self.from_stable = self.added <= (
                artificial_tension.FIRST if wrinkling_threshold(self.problem.structure) else 0.0
            )
        self.length = length
        dx.scale(length)
        dx.axpy(1.0, x)
        dx.axpy(-1.0, start)

    def is_descent(self, dx: PETSc.Vec) -> bool:
        """Return True if dx solves the linear system and -dx is a descent direction, without negative curvature."""
        if not factorization.solves(self.A, dx, self.b, self.work):
            return False
        if self.symmetric:
            negative, zero = factorization.pivots(self.ksp)
        else:
            negative, zero = int(float(self.b.dot(dx)) <= 0), 0
        # Later attempts begin out of balance.
        if negative and self.from_stable and self.first:
            self.lost_stability |= self.added > wrinkling_threshold(self.problem.structure)
        return (negative, zero) == (0, 0)

    def correct_inertia(self, x: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Correct the inertia: increase the shift of the tangent and solve again."""
        if self.added > artificial_tension.LARGEST:
            raise _Stop(linear_failure(self.problem, self.A))
        self.add_tension(x, artificial_tension.more(self.added))
        self.ksp.solve(self.b, dx)

    def add_tension(self, x: PETSc.Vec, tension: float) -> None:
        """Set the shift of the tangent."""
        self.problem.stiffen(x, self.A, self.b, tension - self.added)
        self.added = tension
