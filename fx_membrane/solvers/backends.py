"""Backends of Newton's iteration: dolfinx's NewtonSolver, or PETSc's SNES with the same callbacks."""

from __future__ import annotations

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, Protocol

from petsc4py import PETSc

from ..runtime.number_locale import decimal_point

SNES = "fxm_"  # prefix of our own options; that of the user's is in `petsc_options`
Backend = tuple[Callable[[PETSc.Vec], bool], PETSc.KSP]  # backend: the iteration and its linear solver


class Callbacks(Protocol):
    """Callbacks and workspace of the iteration.

    Attributes:
        b: The right-hand side.
        balanced: True if the last residual is within the tolerance.
        most: Maximum number of iterations.
        newton: dolfinx's NewtonSolver, or None.
    """

    b: PETSc.Vec
    balanced: bool
    most: int
    newton: Any

    @property
    def A(self) -> PETSc.Mat:
        """The tangent of this solve."""

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual with held components."""

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Tangent with held components; sets b to match."""

    def step(self, x: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Replace the solution dx of the linear system by the step: the next iterate is x - dx."""


def by_dolfinx(owner: Callbacks) -> Backend:
    """Drive the iteration by dolfinx's NewtonSolver."""
    newton = owner.newton

    def residual(x: PETSc.Vec, b: PETSc.Vec) -> None:
        owner.residual(x, b)
        owner.newton.atol = math.inf if owner.balanced else 0.0

    def update(_: object, dx: PETSc.Vec, x: PETSc.Vec) -> None:
        owner.step(x, dx)
        x.axpy(-1.0, dx)

    newton.setF(residual, owner.b)
    newton.set_form(lambda x: None)
    newton.set_update(update)
    newton.convergence_criterion = "residual"
    newton.error_on_nonconvergence = False
    newton.rtol = 0.0  # `atol` returns the verdict of `residual`

    def solve(x: PETSc.Vec) -> bool:
        owner.newton.setJ(lambda x, A: owner.tangent(x, A), owner.A)  # noqa: PLW0108  (no strong reference)
        owner.newton.max_it = owner.most
        return bool(owner.newton.solve(x)[1])

    return solve, newton.krylov_solver


@decimal_point()
def by_snes(owner: Callbacks) -> Backend:
    """Drive the same iteration by PETSc's SNES, for versions of dolfinx without NewtonSolver."""
    reasons = PETSc.SNES.ConvergedReason

    def shorten(x: PETSc.Vec, dx: PETSc.Vec) -> bool:
        owner.step(x, dx)
        return True

    def solve_for_step(outer: PETSc.KSP, b: PETSc.Vec, dx: PETSc.Vec) -> None:
        """Solve the linear system; tell of no failure, at some of which SNES would end: `step` judges them."""
        ksp.setOperators(*outer.getOperators())
        ksp.solve(b, dx)
        outer.setConvergedReason(PETSc.KSP.ConvergedReason.CONVERGED_ITS)

    def test(_: PETSc.SNES, iteration: int, norms: tuple[float, float, float]) -> int:
        return reasons.CONVERGED_FNORM_ABS if owner.balanced else reasons.ITERATING

    snes = PETSc.SNES().create(owner.b.comm)
    snes.setType("newtonls")
    snes.setOptionsPrefix(SNES)
    PETSc.Options(SNES)["snes_linesearch_type"] = "basic"
    snes.setFromOptions()
    ksp = PETSc.KSP().create(owner.b.comm)
    snes.getKSP().setType("python")
    snes.getKSP().getPC().setType("none")
    snes.getKSP().setPythonContext(SimpleNamespace(solve=solve_for_step))
    snes.setFunction(lambda _, x, b: owner.residual(x, b), owner.b)
    snes.setLineSearchPreCheck(shorten)
    snes.setConvergenceTest(test)

    def solve(x: PETSc.Vec) -> bool:
        snes.setJacobian(lambda _, x, A, P: owner.tangent(x, A), owner.A)
        # By default SNES stops after 50. `test` and the basic line search make none of its other tests.
        snes.setTolerances(stol=0.0, max_it=owner.most)
        try:
            snes.solve(None, x)
        except PETSc.Error as error:  # PETSc 3.25 wraps exceptions of callbacks
            raise (error.__cause__ or error) from None
        return bool(snes.getConvergedReason() > 0)

    return solve, ksp
