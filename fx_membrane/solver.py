"""Solvers: a problem and a start go in; the state, its history and a reason in words come out."""

import math
import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, cast

from mpi4py import MPI
from petsc4py import PETSc

from . import _dolfinx, validation
from .diagnosis import largest, linear_failure, stalled
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
        retry: Whether a smaller load increment may succeed where this one failed.
    """

    converged: bool
    reason: str
    iterations: tuple[Iteration, ...]
    retry: bool = False


ROUNDING = 1e-14

Monitor = Callable[[int, Iteration], None]


class Solve(Protocol):
    """Brings a vector to equilibrium; tells the monitor the number of each iterate and the iterate."""

    def __call__(self, x: PETSc.Vec, monitor: Monitor = ...) -> Solution:
        """How it ended; the state is in x."""
        ...


def _silent(number: int, iterate: Iteration) -> None:
    pass


@dataclass(frozen=True)
class Newton:
    """Newton-Raphson, Gil (74), by dolfinx's `NewtonSolver` with a direct factorization (MUMPS).

    Raises:
        ValueError: rtol is not a positive number; max_iterations is not a whole number above zero.

    Args:
        rtol: Converged when the 2-norm of the unbalanced forces is below rtol times that of all nodal forces,
            reactions and loads included. A start passes only at rounding.
        max_iterations: Most iterations for one load increment.
    """

    rtol: float = 1e-10
    max_iterations: int = 30

    def __post_init__(self) -> None:
        validation.positive("Newton rtol", self.rtol)
        validation.whole("Newton max_iterations", self.max_iterations)

    def prepare(self, problem: Problem) -> Solve:
        """A function that brings a vector to equilibrium; it keeps matrix and symbolic factorization between calls."""
        return _NewtonRaphson(self, problem)


class _Stop(Exception):  # noqa: N818  (not an error but a message from callback to caller)
    """Ends the iteration from inside a callback, with the reason in words."""


_kept: list[tuple[MPI.Intracomm, "weakref.ref[_NewtonRaphson]", PETSc.KSP]] = []


def _keep_until_all_are_done(owner: "_NewtonRaphson", comm: MPI.Intracomm) -> None:
    """Frees factorizations of earlier solvers that no process uses any more, and keeps that of this one.

    To free one is a collective act, but Python's garbage collector lets go of a solver at another moment on each
    process, and the C++ NewtonSolver would free it there and then: a deadlock. A reference of our own prevents that.
    """
    if comm.size == 1:
        return
    for entry in list(_kept):
        shared = MPI.Comm.Compare(entry[0], comm) in (MPI.IDENT, MPI.CONGRUENT)
        if shared and comm.allreduce(entry[1]() is None, MPI.LAND):
            _kept.remove(entry)
            entry[2].destroy()
    _kept.append((comm, weakref.ref(owner), owner.ksp))


Driver = tuple[Callable[[PETSc.Vec], bool], PETSc.KSP]  # runs the iteration; its linear solver


class _NewtonRaphson:
    """The iteration: callbacks for residual, tangent and step, and what drives them."""

    def __init__(self, settings: Newton, problem: Problem):
        self.settings, self.problem = settings, problem
        self.A = problem.discretization.create_matrix()
        self.b = problem.discretization.create_vector()
        self.linear_error = self.b.duplicate()
        self.history: list[Iteration] = []
        self.monitor: Monitor = _silent
        self.tolerance = 0.0
        self.newton = _dolfinx.newton_solver(problem.discretization.comm)
        self.next_step = 0.0
        # The drivers hold their callbacks in C and C++, where Python's garbage collector does not look: a weak
        # reference keeps the problem from living as long as the program.
        owner = cast(_NewtonRaphson, weakref.proxy(self))
        self.iterate, self.ksp = _by_snes(owner) if self.newton is None else _by_dolfinx(owner)
        self.ksp.setType("preonly")
        _keep_until_all_are_done(self, problem.discretization.comm)

    def __call__(self, x: PETSc.Vec, monitor: Monitor = _silent) -> Solution:
        self.history, self.next_step, self.monitor = [], 0.0, monitor
        self.ksp.getPC().setType("cholesky" if self.problem.symmetric else "lu")
        self.ksp.getPC().setFactorSolverType("mumps")
        try:
            with _dolfinx.quiet_log():
                converged = self.iterate(x)
        except _Stop as stop:
            # A tangent that is singular at the start of the increment is so for any length of it.
            return Solution(False, str(stop), tuple(self.history), retry=len(self.history) > 1)
        reason = "converged" if converged else self.stalled(x)
        return Solution(converged, reason, tuple(self.history), retry=True)

    def stalled(self, x: PETSc.Vec) -> str:
        """Why there is no solution after the last iterate."""
        last = self.history[-1].residual
        at_rounding = len(self.history) > 2 and last < 1e3 * self.tolerance
        return stalled(self.problem, x, len(self.history) - 1, last, at_rounding)

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual with held components; notes the iterate and the tolerance for its 2-norm."""
        self.problem.residual(x, b)
        # The start passes only at rounding: loads far below the prestress take their step too.
        forces = b.norm() + self.problem.load_norm(x)
        relative = (self.settings.rtol if self.history else ROUNDING) * forces
        self.tolerance = max(relative, 0.1 * ROUNDING * self.problem.prestress_forces, 1e-300)
        self.problem.hold(x, b)
        unbalanced = largest(b)
        self.history.append(Iteration(self.problem.energy(x), unbalanced, self.next_step))
        self.monitor(len(self.history) - 1, self.history[-1])
        if not math.isfinite(unbalanced):
            raise _Stop(self.stalled(x))

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Tangent and right-hand side with held components."""
        A.setOption(PETSc.Mat.Option.SYMMETRIC, self.problem.symmetric)
        self.problem.tangent(x, A)
        self.problem.hold_tangent(x, A, self.b)

    def step(self, dx: PETSc.Vec) -> float:
        """Length of the step -dx, after a look at how well dx solves the linear system."""
        self.A.mult(dx, self.linear_error)
        self.linear_error.axpy(-1.0, self.b)
        # Written so that a norm that is not a number counts as a failure.
        if not self.linear_error.norm() <= 1e-6 * self.b.norm():
            raise _Stop(linear_failure(self.problem, self.A))
        self.next_step = 1.0
        return self.next_step


def _by_dolfinx(owner: _NewtonRaphson) -> Driver:
    """dolfinx's NewtonSolver drives the iteration."""
    newton = owner.newton

    def residual(x: PETSc.Vec, b: PETSc.Vec) -> None:
        owner.residual(x, b)
        owner.newton.atol = owner.tolerance

    newton.setF(residual, owner.b)
    newton.setJ(lambda x, A: owner.tangent(x, A), owner.A)  # noqa: PLW0108  (a bound method would be a strong reference)
    newton.set_form(lambda x: None)
    newton.set_update(lambda _, dx, x: x.axpy(-owner.step(dx), dx))
    newton.convergence_criterion = "residual"
    newton.error_on_nonconvergence = False
    newton.rtol = 0.0  # `atol` follows the forces at hand
    newton.max_it = owner.settings.max_iterations
    return lambda x: bool(newton.solve(x)[1]), newton.krylov_solver


def _by_snes(owner: _NewtonRaphson) -> Driver:
    """PETSc's SNES drives the same iteration, where dolfinx has no NewtonSolver."""
    reasons = PETSc.SNES.ConvergedReason

    def shorten(_: PETSc.Vec, dx: PETSc.Vec) -> bool:
        dx.scale(owner.step(dx))
        return True

    def test(_: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> int:
        if norms[2] < owner.tolerance:
            return reasons.CONVERGED_FNORM_ABS
        return reasons.DIVERGED_MAX_IT if iteration == owner.settings.max_iterations else reasons.ITERATING

    snes = PETSc.SNES().create(owner.problem.discretization.comm)
    snes.setType("newtonls")
    snes.setOptionsPrefix("fx_membrane_")
    PETSc.Options("fx_membrane_")["snes_linesearch_type"] = "basic"
    snes.setFromOptions()
    snes.setFunction(lambda _, x, b: owner.residual(x, b), owner.b)
    snes.setJacobian(lambda _, x, A, P: owner.tangent(x, A), owner.A)
    snes.setLineSearchPreCheck(shorten)
    snes.setConvergenceTest(test)

    def solve(x: PETSc.Vec) -> bool:
        snes.solve(None, x)
        if snes.getConvergedReason() == reasons.DIVERGED_LINEAR_SOLVE:
            raise _Stop(linear_failure(owner.problem, owner.A))
        return bool(snes.getConvergedReason() > 0)

    return solve, snes.getKSP()
