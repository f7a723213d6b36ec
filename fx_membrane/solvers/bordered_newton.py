"""Newton's method for displacement and load factor together: a point of an equilibrium path in a plane.

    R(u, factor) = 0,    normal . u + load_weight factor = distance

Elimination solves the two equations. Each iteration takes one factorization of K and two solutions: for R, and for the
derivative of R by the load factor. That derivative is minus the stage's own loads, pressures as in the present shape.
Convergence is quadratic where a smooth path crosses the plane. Limit points of the load, where K is singular, are no
exception.

Source: E. Ramm, Strategies for tracing the nonlinear response near limit points, in: W. Wunderlich, E. Stein,
K.-J. Bathe (eds.), Nonlinear finite element analysis in structural mechanics, Springer (1981) 63-89.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.actions import Actions, between
from ..assembly.integral_energies import add_rate
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from . import factorization, petsc_options
from .base import LIMITS, Iteration, Monitor, no_monitor, tolerance
from .bordered_system import BorderedSystem
from .progress import Pulse


@dataclass(frozen=True)
class CorrectorLimits:
    """Limits of the corrector.

    Attributes:
        iterations: Maximum number of iterations.
        solved: Relative error of a linear solution: few digits remain near a limit point, none in a singular system.
    """

    iterations: int = 12
    solved: float = 1e-3


CORRECTOR = CorrectorLimits()


class Step(NamedTuple):
    """A displacement and a change of the load factor."""

    x: PETSc.Vec
    factor: float


class Point(NamedTuple):
    """A point of a path, or an estimate of one, with its iteration count."""

    x: PETSc.Vec
    factor: float
    iterations: tuple[Iteration, ...] = ()

    def moved(self, step: Step, length: float) -> Point:
        """Return the point after a step times a length."""
        x = self.x.copy()
        x.axpy(length, step.x)
        return Point(x, self.factor + length * step.factor)

    def since(self, start: Point) -> Step:
        """Step from another point to this one."""
        x = self.x.copy()
        x.axpy(-1.0, start.x)
        return Step(x, self.factor - start.factor)


class Plane(NamedTuple):
    """Set of all (u, factor) with normal . u + load_weight factor = distance."""

    normal: PETSc.Vec
    load_weight: float
    distance: float

    def signed_distance(self, point: Point) -> float:
        """Signed distance of a point beyond the plane, in the unit of the distance."""
        return float(self.normal.dot(point.x)) + self.load_weight * point.factor - self.distance


class BorderedNewton:
    """Newton's method for load factors between two actions; it keeps matrix and symbolic factorization between calls.

    Attributes:
        A: The tangent that was factored last.
        du_load: Derivative of the displacement by the load factor with that tangent.
        compression: Fraction of each `compression_stiffness` in effect.
        symmetric: True if the tangent is symmetric at every load factor.
        monitor: Hears of the iterates, and may end the search by an exception.
    """

    def __init__(self, problem: Problem, start: Actions, end: Actions, x: PETSc.Vec, rtol: float):
        petsc_options.check(problem.comm)
        petsc_options.tell_not_for_steps(problem.comm, "equilibrium_path", factors=True)
        self.problem, self.start, self.end, self.rtol = problem, start, end, rtol
        self.rate = problem.under(end.less(start))
        self.compression = 1.0
        self.monitor: Monitor = no_monitor
        self.bordered = BorderedSystem()
        self.pulse = Pulse("equilibrium path", problem.comm.rank == 0)
        create = problem.discretization.create_vector
        self.b, self.du_residual, self.du_load, self.work, self.zero = create(), create(), create(), create(), create()
        self.size = problem.structure.size
        self.symmetric = self.has_potential(x)
        self.A = problem.discretization.create_matrix("sbaij" if self.symmetric else "baij")
        self.ksp = PETSc.KSP().create(problem.comm)
        factorization.choose(self.ksp, self.A, self.symmetric)

    def without_compression_stiffness(self, left: float) -> BorderedNewton:
        """Return the same method, with the same matrix, for the structure with less compression stiffness.

        Args:
            left: Fraction of each `compression_stiffness` that remains [-].
        """
        other = copy.copy(self)
        other.compression = left
        return other

    def under(self, factor: float) -> LoadedProblem:
        """View of the problem at a load factor."""
        loaded = self.problem.under(between(self.start, self.end, factor))
        return loaded if self.compression == 1 else loaded.without_compression_stiffness(self.compression)

    def free(self) -> None:
        """Free PETSc objects on all processes together; Python's garbage collector acts at a different time on each."""
        self.ksp.destroy()
        self.A.destroy()
        self.bordered.free()

    def has_potential(self, x: PETSc.Vec) -> bool:
        """Return True if pressures keep the tangent symmetric, as uniform ones on closed surfaces or in held edges."""
        views = [self.problem.under(actions) for actions in (self.start, self.end)]
        if any(view.terms.without_potential for view in views):  # symmetric here, perhaps, and not elsewhere
            return False
        views = [view for view in views if not view.symmetric]
        if not views:
            return True
        A = self.problem.discretization.create_matrix("baij")
        try:
            return all(factorization.is_symmetric(view.constraints.close(view.tangent(x, A))) for view in views)
        finally:
            A.destroy()

    def find(self, guess: Point, plane: Plane) -> Point | None:
        """Return the point of the path in a plane, from an initial guess in it, or None."""
        x, factor = guess.x.copy(), guess.factor
        iterations: list[Iteration] = []
        while True:
            balanced = self.residual(x, factor)
            max_norm = self.b.norm(PETSc.NormType.NORM_INFINITY)
            iterations.append(Iteration(self.under(factor).energy(x), max_norm, float(bool(iterations))))
            self.pulse(f"load factor {factor:.6g}, iteration {len(iterations) - 1}, residual {max_norm:.1e}")
            self.monitor(len(iterations) - 1, iterations[-1])
            if balanced:
                return Point(x, factor, tuple(iterations))
            diverged = not (math.isfinite(max_norm) and x.norm(PETSc.NormType.NORM_INFINITY) <= LIMITS.far * self.size)
            if diverged or len(iterations) > CORRECTOR.iterations or not self.linearize(x, factor):
                return None
            move = self.correction(Point(x, factor), plane)
            if move is None:
                return None
            x.axpy(1.0, move.x)
            factor += move.factor

    def correction(self, guess: Point, plane: Plane) -> Step | None:
        """Step of one iteration into a plane, by the tangent factored last; None if it is singular."""
        if not self.solve(self.b, self.du_residual, self.bordered.borders.rest):
            return None
        slope = float(plane.normal.dot(self.du_load)) + plane.load_weight
        growth = (float(plane.normal.dot(self.du_residual)) - plane.signed_distance(guess)) / (slope or math.nan)
        move = self.du_load.copy()
        move.scale(growth)
        move.axpy(-1.0, self.du_residual)
        return Step(move, growth)

    def residual(self, x: PETSc.Vec, factor: float) -> bool:
        """Evaluate the residual; return True if the unbalanced forces are below the tolerance."""
        loaded = self.under(factor)
        loaded.residual(x, self.b)
        accepted = tolerance(loaded, x, self.b, self.rtol)
        loaded.constraints.constrain_residual(x, self.b)
        return loaded.beyond_rounding(x, self.b) < accepted

    def linearize(self, x: PETSc.Vec, factor: float) -> bool:
        """Factor the tangent, solve for `du_load`; return True if it is regular."""
        loaded = self.under(factor)
        loaded.tangent(x, self.A)
        with self.problem.discretization.work(1) as (gain,):
            self.rate.load_derivative(x, b=gain)
            loaded.add_stress_rate(x, self.start, self.end, gain)
            rest = self.add_integral_rate(loaded, x, factor, gain)
            self.rate.constraints.constrain_tangent(
                self.zero, self.A, gain
            )  # constrained components move at their rate
            gain.scale(-1.0)
            self.ksp.setOperators(self.A)
            self.ksp.setUp()
            self.bordered.factor(self.ksp)
            return self.solve(gain, self.du_load, rest)

    def solve(self, b: PETSc.Vec, x: PETSc.Vec, rest: NDArray[np.float64]) -> bool:
        """Solve for the right-hand side b, and `rest` of the borders; return True if x is a solution."""
        self.ksp.solve(b, x)
        q = self.bordered.correct(x, rest)
        return self.bordered.solves(self.A, x, q, b, self.work, CORRECTOR.solved)

    def negative_pivots(self) -> int | None:
        """Count of negative eigenvalues of the tangent factored last; None if it is not symmetric."""
        return self.bordered.negative(factorization.pivots(self.ksp).negative) if self.symmetric else None

    def add_integral_rate(
        self, loaded: LoadedProblem, x: PETSc.Vec, factor: float, gain: PETSc.Vec
    ) -> NDArray[np.float64]:
        """Renew the borders; add the derivative of the forces of integrals by the load factor to a vector.

        Returns:
            Right-hand side of the borders: the rate of given integrals, less that by constrained components.
        """
        self.bordered.free()
        self.bordered = BorderedSystem(loaded.borders(x, one_sided=True))
        if not (loaded.integrals.all or self.problem.under(self.end).integrals.all):  # water may only be on its way
            return np.zeros(0)
        borders = self.bordered.borders
        rest = np.zeros(0)
        if borders.vectors:
            rest = -borders.closed_by(self.rate.constraints.prescribed, self.problem.comm)
        rest[borders.given] += add_rate(x, lambda at: self.under(at).integrals, factor, gain)
        return rest
