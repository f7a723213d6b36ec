"""Preconditioners of the first-order methods: the diagonal of the tangent, or the tangent itself, factored once."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Literal, NamedTuple

from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from . import factorization

Kind = Literal["jacobi", "tangent"] | None
Divide = Callable[[PETSc.Vec, PETSc.Vec], object]  # writes M^-1 g, for the first argument g, into the second

# Shifts, as strains, tried until the tangent is positive definite: the schedule of `ShiftControl`.
SHIFTS = (0.0, *(1e-4 * 8.0**i for i in range(10)))
ZERO = 1e-13  # fraction of the largest entry below which a diagonal entry is zero


class Preconditioner(NamedTuple):
    """Preconditioner M of the states of a problem.

    Attributes:
        at: Returns the division by M of a state that meets the constraints; None if M cannot be made positive definite.
        release: Frees the factors of M until the next state; collective.
    """

    at: Callable[[LoadedProblem, PETSc.Vec], Divide | None]
    release: Callable[[], None]


def preconditioner(problem: Problem, kind: Kind) -> Preconditioner:
    """Return a preconditioner that keeps its workspace from state to state."""
    if kind is None:
        return Preconditioner(lambda problem, x: PETSc.Vec.copy, _nothing)
    divide_by = _diagonal if kind == "jacobi" else _Factors(problem)
    A, b = problem.discretization.create_matrix(), problem.discretization.create_vector()

    def at(problem: LoadedProblem, x: PETSc.Vec) -> Divide | None:
        problem.tangent(x, A)
        if not problem.symmetric:
            factorization.symmetrize(A)
        problem.constraints.constrain_tangent(x, A, b)
        divide = divide_by(A)
        for less, more in pairwise(SHIFTS):
            if divide is not None:
                break
            problem.stiffen(x, A, b, more - less)
            divide = divide_by(A)
        return divide

    return Preconditioner(at, divide_by.release if isinstance(divide_by, _Factors) else _nothing)


def _nothing() -> None:
    """Free nothing."""


def _diagonal(A: PETSc.Mat) -> Divide | None:
    """Divide by the diagonal; None if it is not positive."""
    diagonal = A.getDiagonal()
    if not diagonal.min()[1] > ZERO * diagonal.max()[1]:
        return None
    return lambda g, s: s.pointwiseDivide(g, diagonal)


class _Factors:
    """Division by the tangent; None if it is not positive definite."""

    def __init__(self, problem: Problem):
        self.ksp = PETSc.KSP().create(problem.comm)
        factorization.keep_until_all_are_done(self, problem.comm, self.ksp)

    def __call__(self, A: PETSc.Mat) -> Divide | None:
        factorization.choose(self.ksp, A, symmetric=True)
        self.ksp.setOperators(A)  # without this `setUp` keeps the last factorization
        self.ksp.setUp()
        return self.ksp.solve if factorization.pivots(self.ksp) == (0, 0) else None

    def release(self) -> None:
        """Free the factors."""
        factorization.release(self.ksp)
