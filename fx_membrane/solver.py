"""Solvers: a problem and a start go in; the state, its history and a reason in words come out."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from dolfinx import cpp
from petsc4py import PETSc

from .diagnosis import linear_failure, stalled
from .problem import Problem


class Iteration(NamedTuple):
    """One line of a convergence table.

    Attributes:
        energy: Total potential energy [J].
        residual: Largest unbalanced nodal force [N], infinity norm; at components whose prescribed displacement is
            not reached yet, the error times a typical stiffness.
        step: Length of the step that led here, in (0, 1]; 0 at the start.
    """

    energy: float
    residual: float
    step: float


@dataclass(frozen=True)
class Solution:
    """How a solve ended; the state itself is in the vector given to it.

    Attributes:
        converged: Whether the residual met the tolerance.
        reason: In words, why it stopped, and what to try where it failed.
        iterations: The iterates, the start first.
    """

    converged: bool
    reason: str
    iterations: tuple[Iteration, ...]


Solve = Callable[[PETSc.Vec], Solution]


@dataclass(frozen=True)
class Newton:
    """Newton-Raphson, Gil (74), by dolfinx's `NewtonSolver` with a direct factorization (MUMPS).

    Args:
        rtol: Converged when the 2-norm of the unbalanced forces is below rtol times that of all nodal forces,
            reactions and loads included.
        max_iterations: Most iterations for one load increment.
    """

    rtol: float = 1e-10
    max_iterations: int = 30

    def prepare(self, problem: Problem) -> Solve:
        """A function that brings a vector to equilibrium; it keeps matrix and symbolic factorization between calls."""
        return _NewtonRaphson(self, problem)


class _Stop(Exception):  # noqa: N818  (not an error but a message from callback to caller)
    """Ends the iteration from inside a callback, with the reason in words."""


class _NewtonRaphson:
    def __init__(self, settings: Newton, problem: Problem):
        self.settings, self.problem = settings, problem
        self.A = problem.discretization.create_matrix()
        self.A.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self.b = problem.discretization.create_vector()
        self.linear_error = self.b.duplicate()
        self.history: list[Iteration] = []
        self.next_step = 0.0
        self.newton = cpp.nls.petsc.NewtonSolver(problem.discretization.comm)
        self.newton.setF(self.residual, self.b)
        self.newton.setJ(self.tangent, self.A)
        self.newton.set_form(lambda x: None)
        self.newton.set_update(self.update)
        self.newton.convergence_criterion = "residual"
        self.newton.error_on_nonconvergence = False
        self.newton.rtol = 0.0  # `atol` is set from the forces at hand in each iteration
        self.newton.max_it = settings.max_iterations
        ksp = self.newton.krylov_solver
        ksp.setType("preonly")
        ksp.getPC().setType("cholesky")
        ksp.getPC().setFactorSolverType("mumps")

    def __call__(self, x: PETSc.Vec) -> Solution:
        self.history, self.next_step = [], 0.0
        try:
            _, converged = self.newton.solve(x)
        except _Stop as stop:
            return Solution(False, str(stop), tuple(self.history))
        reason = "converged" if converged else stalled(self.problem, x)
        return Solution(bool(converged), reason, tuple(self.history))

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        self.problem.residual(x, b)
        self.newton.atol = max(self.settings.rtol * b.norm(), 1e-300)
        self.problem.hold(x, b)
        largest = b.norm(PETSc.NormType.NORM_INFINITY)
        self.history.append(Iteration(self.problem.energy(x), largest, self.next_step))
        if not math.isfinite(largest):
            raise _Stop(stalled(self.problem, x))

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        self.problem.tangent(x, A)
        self.problem.hold_tangent(x, A, self.b)

    def update(self, newton: Any, dx: PETSc.Vec, x: PETSc.Vec) -> None:
        self.A.mult(dx, self.linear_error)
        self.linear_error.axpy(-1.0, self.b)
        # Written so that a norm that is not a number counts as a failure.
        if not self.linear_error.norm() <= 1e-6 * self.b.norm():
            raise _Stop(linear_failure(self.problem, self.A))
        self.next_step = 1.0
        x.axpy(-self.next_step, dx)
