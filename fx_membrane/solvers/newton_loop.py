"""The iteration of Newton's method: residual, tangent and step as callbacks of dolfinx's NewtonSolver.

Each step solves (K + lambda T) dx = -R, Gil (74), by a direct factorization. A line search on the energy sets its
length, and an inertia correction the shift lambda.
"""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import cast

import numpy as np
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.discretization import MatrixKind
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..runtime.freed_memory import return_freed_memory
from . import factorization, petsc_options
from .backends import by_dolfinx, by_snes
from .base import LIMITS, Iteration, Monitor, Solution, diverged, max_norm, no_monitor, tolerance
from .bordered_system import BorderedSystem
from .convergence import at_rest, stagnant
from .curvature import wrinkling_threshold
from .diagnosis import linear_failure, loose_nodes, stagnation_message
from .inertia_correction import ShiftControl
from .line_search import halves, step_back
from .outcome import Outcome

Proceed = Callable[[list[Iteration]], bool]  # True to continue an attempt, by its iterates


def always(history: list[Iteration]) -> bool:
    """Continue."""
    return True


class _Stop(Exception):  # noqa: N818  (not an error but a message from callback to caller)
    """Exception that ends the iteration from inside a callback, with the reason as a sentence."""

    def __init__(self, outcome: Outcome, reason: str):
        super().__init__(reason)
        self.outcome = outcome


class NewtonLoop:
    """The iteration: callbacks for residual, tangent and step, and their backend.

    Attributes:
        problem: The problem of the present attempt.
        length: Length of the last step.
        shift: Shift of the tangent for that step, as a strain.
        left: Number of iterations that remain of the total for the solve.
        taken: Number of iterations since the solve began, those of rejected attempts included.
        attempts: Number of attempts since then.
        counts_pivots: True if the linear solver tells negative curvature by pivots; else it shows along steps only.
        from_stable: True if the first tangent of the solve had no more negative curvature than slack cells have.
        lost_stability: True if a later tangent had more.
    """

    def __init__(self, problem: Problem, line_search: bool, control: ShiftControl):
        self.line_search, self.control = line_search, control
        self.matrices: dict[MatrixKind, PETSc.Mat] = {}
        self.b = problem.discretization.create_vector()
        create = problem.discretization.create_vector
        self.work, self.here = create(), create()
        self.bordered, self.forces = BorderedSystem(), np.zeros(0)
        self.rtol = self.tolerance = self.length = self.shift = 0.0
        self.balanced = False
        self.begin(problem.under(), no_monitor, 0)
        self.newton = _dolfinx.newton_solver(problem.comm)
        # The backends hold their callbacks in C and C++, invisible to Python's garbage collector: a weak reference lets
        # the problem be freed before the program ends.
        owner = cast(NewtonLoop, weakref.proxy(self))
        self.iterate, self.ksp = by_snes(owner) if self.newton is None else by_dolfinx(owner)
        factorization.keep_until_all_are_done(self, problem.comm, self.ksp)

    def begin(self, problem: LoadedProblem, monitor: Monitor, most: int) -> None:
        """Begin a solve of at most so many iterations."""
        self.problem, self.monitor, self.left = problem, monitor, most
        self.history: list[Iteration] = []
        self.taken = self.attempts = 0
        self.symmetric, self.counts_pivots, self.from_stable, self.lost_stability = True, True, False, False

    @property
    def A(self) -> PETSc.Mat:
        """The tangent; the upper triangle of its blocks if it is symmetric."""
        return self.matrix(self.symmetric)

    def matrix(self, symmetric: bool) -> PETSc.Mat:
        """Return the matrix for a symmetric or a general tangent, made on first use; few linear solvers take blocks."""
        blocks: MatrixKind = "sbaij" if symmetric else "baij"
        kind: MatrixKind = "aij" if petsc_options.choose_solver() else blocks
        if kind not in self.matrices:
            self.matrices[kind] = self.problem.discretization.create_matrix(kind)
        return self.matrices[kind]

    def attempt(self, x: PETSc.Vec, rtol: float, most: int, proceed: Proceed = always) -> Solution:
        """Run the iteration from x.

        Args:
            x: The start; replaced by the last iterate.
            rtol: Relative tolerance.
            most: Maximum number of iterations; never more than remain of the total.
            proceed: Decision to take one more iteration.
        """
        self.history, self.rtol = [], rtol
        self.most, self.proceed = min(most, self.left), proceed
        self.attempts += 1
        self.length = self.shift = 0.0
        self.problem = self.problem.settled(x)
        self.symmetric = self.problem.symmetric or self.conservative(x)
        factorization.choose(self.ksp, self.A, self.symmetric, steps=True)
        self.counts_pivots = self.symmetric and factorization.counts_pivots(self.ksp)
        try:
            with _dolfinx.quiet_log():
                converged = self.iterate(x)
        except _Stop as stop:
            return Solution(stop.outcome, str(stop), tuple(self.history))
        except (PETSc.Error, RuntimeError) as error:
            failure = petsc_options.failure(error)
            if failure:
                raise failure from None
            raise
        finally:
            self.proceed = always  # a closure of the caller keeps a solver that is dropped, in a circle
        if converged:
            return Solution(Outcome.CONVERGED, Outcome.CONVERGED.value, tuple(self.history))
        end = self.without_end(x)
        return Solution(end.outcome, str(end), tuple(self.history))

    def conservative(self, x: PETSc.Vec) -> bool:
        """Return True if pressures have a potential here, as within held edges: the tangent is symmetric.

        That of a term without a potential may be symmetric here and not elsewhere, as with friction.
        """
        if self.problem.terms.without_potential:
            return False
        A = self.problem.tangent(x, self.matrix(symmetric=False))
        return factorization.is_symmetric(self.problem.constraints.close(A))

    def without_end(self, x: PETSc.Vec) -> _Stop:
        """Outcome and reason of an iteration whose last iterate is no solution."""
        last = self.history[-1].residual
        at_rounding = stagnant(self.history, self.tolerance)
        outcome = Outcome.STAGNATED if at_rounding else Outcome.MAX_ITERATIONS
        return _Stop(outcome, stagnation_message(self.problem, x, len(self.history) - 1, last, at_rounding))

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual with constraints; record the iterate and the tolerance for its 2-norm."""
        energy = self.problem.energy_and_residual(x, b)
        self.tolerance = tolerance(self.problem, x, b, self.rtol if self.history else LIMITS.rounding)
        self.problem.constraints.constrain_residual(x, b)
        beyond, unbalanced = self.problem.beyond_rounding(x, b), max_norm(b)
        self.taken += bool(self.history)  # the start of an attempt is no iteration
        self.history.append(Iteration(energy, unbalanced, self.length, self.shift))
        small = beyond < LIMITS.rest * self.tolerance / self.rtol
        self.balanced = beyond < self.tolerance or (small and at_rest(self.history))
        self.monitor(len(self.history) - 1, self.history[-1])
        if diverged(self.problem, x, unbalanced):
            raise _Stop(Outcome.DIVERGED, str(self.without_end(x)))

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Tangent and right-hand side with constraints; end an attempt that is not to proceed."""
        if not self.proceed(self.history):
            raise self.without_end(x)
        self.problem.tangent(x, A)
        self.bordered.free()
        self.bordered = BorderedSystem(self.problem.borders(x, one_sided=True))
        self.problem.constraints.constrain_tangent(x, A, self.b)
        shift, self.shift = self.control.next(self.length, self.shift, self.history), 0.0
        if shift:
            self.set_shift(x, shift)
        return_freed_memory(x.local_size)  # that of the assembly, before the factorization

    def step(self, x: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Replace the solution dx of the linear system by the step: the next iterate is x - dx, Gil (74)."""
        return_freed_memory(x.local_size)  # that of the factorization, before the next assembly
        self.length = 1.0
        self.left -= 1
        self.close_borders(dx)
        if not self.line_search:
            if not self.solves(dx):
                self.stop_at_linear_limit()
                # A tangent that is singular at the start of an increment stays so for any smaller one.
                outcome = Outcome.SINGULAR if len(self.history) > 1 else Outcome.SINGULAR_START
                raise _Stop(outcome, self.linear_failure())
            self.settle(x, 1.0)
            return
        start = x.copy(self.here)
        moved = self.problem.constraints.impose(start)
        length = None
        while length is None:
            while not self.is_descent(dx):
                self.correct_inertia(x, dx)
            self.problem.constraints.zero_constrained(dx)
            problem, known = self.with_next_multipliers(x), not self.problem.integrals.given
            if not self.follows:
                length = step_back(problem, self.b, self.history[-1].energy if known else None, start, dx, moved)
            elif not moved and halves(problem, self.b, start, dx):
                length = 1.0
            elif moved or self.b.dot(dx) > 0:
                length = step_back(problem, self.b, None, start, dx, moved)
            if length is None:
                self.correct_inertia(x, dx)
        if self.attempts == len(self.history) == 1:
            # The least shift makes up for slack cells; without slack cells it would hide an unstable start.
            slack = wrinkling_threshold(self.problem.structure) > 0
            self.from_stable = self.shift <= (self.control.first if slack else 0.0)
        self.length = length
        self.settle(x, length)
        dx.scale(length)
        if moved:  # otherwise the next iterate is the last trial, bit by bit, which is not evaluated again
            dx.axpy(1.0, x)
            dx.axpy(-1.0, start)

    @property
    def follows(self) -> bool:
        """True if water follows an outlet that moves: no potential, and a tangent that is not symmetric."""
        return not self.bordered.borders.two_sided.all()

    def is_descent(self, dx: PETSc.Vec) -> bool:
        """Return True if dx solves the linear system and -dx is a descent direction, without negative curvature."""
        if not self.solves(dx):
            self.stop_at_linear_limit()
            return False
        if self.counts_pivots:
            negative, zero = factorization.pivots(self.ksp)
            negative = self.bordered.negative(negative)
        else:
            negative, zero = int(not self.follows and self.bordered.curvature(self.b, dx, self.forces) <= 0), 0
        # Later attempts begin out of balance.
        if negative and self.from_stable and self.attempts == 1:
            self.lost_stability |= self.shift > wrinkling_threshold(self.problem.structure)
        return (negative, zero) == (0, 0)

    def correct_inertia(self, x: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Correct the inertia: increase the shift of the tangent and solve again."""
        if self.shift > self.control.largest:
            raise _Stop(Outcome.SINGULAR, self.linear_failure())
        self.set_shift(x, self.control.more(self.shift))
        self.ksp.solve(self.b, dx)
        self.close_borders(dx)

    def close_borders(self, dx: PETSc.Vec) -> None:
        """Make the solution of the sparse system that of the whole."""
        self.bordered.factor(self.ksp)
        self.forces = self.bordered.correct(dx)

    def solves(self, dx: PETSc.Vec) -> bool:
        """Return True if dx solves the linear system."""
        return self.bordered.solves(self.A, dx, self.forces, self.b, self.work)

    def with_next_multipliers(self, x: PETSc.Vec, share: float = 1.0) -> LoadedProblem:
        """View of the problem with the multipliers of given integrals after a share of the step from x."""
        if not self.problem.integrals.given:
            return self.problem
        steps = self.forces[self.bordered.borders.given]
        forces = np.array(self.problem.integrals.forces(x)) - share * steps
        return self.problem.with_multipliers(forces.tolist(), self.bordered.penalties().tolist())

    def settle(self, x: PETSc.Vec, share: float) -> None:
        """Set the multipliers of given integrals to those after a share of the step from x."""
        self.problem = self.with_next_multipliers(x, share)

    def stop_at_linear_limit(self) -> None:
        """Stop where the iterative linear solver ran out of iterations, and no node is without stiffness.

        A smaller increment has as many unknowns, and a shift would hide the cause.
        """
        if petsc_options.ran_out(self.ksp) and not (self.shift == 0 and loose_nodes(self.problem, self.A)):
            raise _Stop(Outcome.LINEAR_LIMIT, petsc_options.limit_message(self.ksp))

    def linear_failure(self) -> str:
        """Sentence on why a step could not be solved for."""
        words, chosen = linear_failure(self.problem, self.A), petsc_options.name(self.ksp)
        if not chosen:
            return words
        tangent = "" if self.symmetric else ", for a tangent that is not symmetric"
        return (
            f"{words} Or the linear solver that the PETSc options choose, {chosen}{tangent}, is at fault: leave out "
            f"-{petsc_options.PREFIX}ksp_type and -{petsc_options.PREFIX}pc_type."
        )

    def set_shift(self, x: PETSc.Vec, shift: float) -> None:
        """Set the shift of the tangent."""
        self.problem.stiffen(x, self.A, self.b, shift - self.shift)
        self.shift = shift
