"""Direct factorization of the tangent by MUMPS: L D L^T where it is symmetric, L U where it is not (pressure)."""

from __future__ import annotations

import weakref
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

from ..runtime.processes import everywhere
from . import petsc_options

SYMMETRY_ROUNDING = 1e-12  # fraction of a matrix below which its antisymmetric part is zero
KIND = "fx_membrane_kind"  # attribute of a linear solver: the factorization chosen last

_kept: list[tuple[MPI.Intracomm, weakref.ref[object], PETSc.KSP]] = []


def choose(ksp: PETSc.KSP, A: PETSc.Mat, symmetric: bool, steps: bool = False) -> None:
    """Make a linear solver a direct one for a matrix that is symmetric or general.

    Args:
        ksp: The linear solver; it keeps its symbolic factorization if the kind of the matrix is the same as before.
        A: The matrix.
        symmetric: True for L D L^T.
        steps: True if the user's PETSc options may choose another linear solver, one without a count of pivots.
    """
    pc = ksp.getPC()
    kind = "cholesky" if symmetric else "lu"
    if ksp.getAttr(KIND) == kind:
        return
    ksp.setAttr(KIND, kind)
    ksp.setType("preonly")
    ksp.setOperators(A)
    pc.setType(kind)
    pc.setFactorSolverType("mumps")
    if steps:
        petsc_options.apply(ksp)
    if not _is_mumps(pc):
        return
    pc.setFactorSetUpSolverType()
    factor = pc.getFactorMatrix()
    factor.setMumpsIcntl(24, 1)  # detect zero pivots: otherwise each is delayed, and the workspace overflows
    factor.setMumpsIcntl(13, 1)  # count negative pivots correctly on several processes
    factor.setMumpsIcntl(14, 50)  # per cent of workspace above the estimate
    petsc_options.set_controls(factor)


def release(ksp: PETSc.KSP) -> None:
    """Free the factors, most of the memory of an analysis; `choose` prepares the linear solver again."""
    ksp.reset()
    ksp.setAttr(KIND, None)


def counts_pivots(ksp: PETSc.KSP) -> bool:
    """Return True if a linear solver counts the negative pivots of a symmetric matrix."""
    return ksp.getPC().getType() == "cholesky" and _is_mumps(ksp.getPC())


def _is_mumps(pc: PETSc.PC) -> bool:
    return pc.getType() in ("lu", "cholesky") and pc.getFactorSolverType() == "mumps"


def symmetrize(A: PETSc.Mat) -> None:
    """Replace a matrix by its symmetric part, (A + A^T) / 2."""
    other = A.copy()
    other.transpose()
    A.axpy(1.0, other, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    A.scale(0.5)
    other.destroy()


def symmetric_part(A: PETSc.Mat) -> PETSc.Mat:
    """Return the symmetric part, (A + A^T) / 2."""
    part = A.copy()
    symmetrize(part)
    return part


def is_symmetric(A: PETSc.Mat) -> bool:
    """Return True if a matrix is symmetric up to rounding."""
    antisymmetric = A.copy()
    antisymmetric.transpose()
    # A process without rows may keep other columns of each, so that the patterns differ.
    antisymmetric.axpy(-1.0, A, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    error = antisymmetric.norm()
    antisymmetric.destroy()
    return bool(error <= 2 * SYMMETRY_ROUNDING * A.norm())


def solves(A: PETSc.Mat, x: PETSc.Vec, b: PETSc.Vec, work: PETSc.Vec) -> bool:
    """Return True if A x = b up to a tolerance; False for NaN."""
    A.mult(x, work)
    work.axpy(-1.0, b)
    return bool(work.norm() <= petsc_options.SOLVED * b.norm())


class Pivots(NamedTuple):
    """Signs of the pivots of a symmetric matrix, equal to those of its eigenvalues in number (Sylvester)."""

    negative: int
    zero: int


def pivots(ksp: PETSc.KSP) -> Pivots:
    """Return the signs of the pivots of the symmetric matrix factored last."""
    factor = ksp.getPC().getFactorMatrix()
    return Pivots(negative=int(factor.getMumpsInfog(12)), zero=int(factor.getMumpsInfog(28)))


def keep_until_all_are_done(owner: object, comm: MPI.Intracomm, ksp: PETSc.KSP) -> None:
    """Free factorizations of earlier solvers that no process uses any more, and keep that of this one.

    Freeing one is collective. Python's garbage collector drops a solver at a different time on each process. The C++
    NewtonSolver would free it then: a deadlock. A reference of our own prevents that.
    """
    if comm.size == 1:
        return
    for entry in list(_kept):
        shared = MPI.Comm.Compare(entry[0], comm) in (MPI.IDENT, MPI.CONGRUENT)
        if shared and everywhere(comm, entry[1]() is None):
            _kept.remove(entry)
            entry[2].destroy()
    _kept.append((comm, weakref.ref(owner), ksp))
