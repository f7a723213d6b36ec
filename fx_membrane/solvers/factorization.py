"""Direct factorization of the tangent by MUMPS: L D L^T where it is symmetric, L U where it is not (pressure)."""

import weakref
from typing import NamedTuple

from mpi4py import MPI
from petsc4py import PETSc

ROUNDING = 1e-12  # an antisymmetric part below this share of a matrix is none
SOLVED = 1e-6  # part of the right-hand side

_kept: list[tuple[MPI.Intracomm, "weakref.ref[object]", PETSc.KSP]] = []


def choose(ksp: PETSc.KSP, A: PETSc.Mat, symmetric: bool) -> None:
    """Makes a linear solver a direct one for a matrix that is symmetric or general."""
    pc = ksp.getPC()
    kind = "cholesky" if symmetric else "lu"
    if pc.getType() == kind:
        return  # its symbolic factorization is kept
    ksp.setType("preonly")
    ksp.setOperators(A)
    pc.setType(kind)
    pc.setFactorSolverType("mumps")
    pc.setFactorSetUpSolverType()
    factor = pc.getFactorMatrix()
    factor.setMumpsIcntl(24, 1)  # finds pivots that are zero: without, each is put off, and the workspace runs over
    factor.setMumpsIcntl(13, 1)  # counts negative pivots right on several processes
    factor.setMumpsIcntl(14, 50)  # per cent of workspace more than estimated


def symmetrize(A: PETSc.Mat) -> None:
    """Replaces a matrix by its symmetric part, (A + A^T) / 2."""
    other = A.copy()
    other.transpose()
    A.axpy(1.0, other, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    A.scale(0.5)
    other.destroy()


def symmetric_part(A: PETSc.Mat) -> PETSc.Mat:
    """(A + A^T) / 2."""
    part = A.copy()
    symmetrize(part)
    return part


def is_symmetric(A: PETSc.Mat) -> bool:
    """Whether a matrix is symmetric, but for rounding."""
    antisymmetric = A.copy()
    antisymmetric.transpose()
    # A process without rows may keep other columns of each: the patterns are not quite the same.
    antisymmetric.axpy(-1.0, A, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    error = antisymmetric.norm()
    antisymmetric.destroy()
    return bool(error <= 2 * ROUNDING * A.norm())


def solves(A: PETSc.Mat, x: PETSc.Vec, b: PETSc.Vec, work: PETSc.Vec) -> bool:
    """Whether A x = b; not where a number is not one."""
    A.mult(x, work)
    work.axpy(-1.0, b)
    return bool(work.norm() <= SOLVED * b.norm())


class Pivots(NamedTuple):
    """Signs of the pivots of a symmetric matrix, as many as eigenvalues of these signs (Sylvester)."""

    negative: int
    zero: int


def pivots(ksp: PETSc.KSP) -> Pivots:
    """Signs of the pivots of the symmetric matrix that was factored last."""
    factor = ksp.getPC().getFactorMatrix()
    return Pivots(negative=int(factor.getMumpsInfog(12)), zero=int(factor.getMumpsInfog(28)))


def keep_until_all_are_done(owner: object, comm: MPI.Intracomm, ksp: PETSc.KSP) -> None:
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
    _kept.append((comm, weakref.ref(owner), ksp))
