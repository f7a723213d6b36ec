"""Lowest eigenvalues of K phi = lambda M phi by SLEPc: Krylov-Schur with shift-invert, factorized by MUMPS.

By Sylvester's law of inertia, the negative pivots of K - shift M count the eigenvalues below the shift. The count
serves twice. First, the shift is lowered until the count is zero, so that negative eigenvalues come first and none is
lost. Second, eigenvalues below the highest one found are counted (Sturm sequence check). If one was missed, such as a
copy of a multiple eigenvalue, the search continues orthogonally to those found. Massless components have infinite
eigenvalues, which come last.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from petsc4py import PETSc
from slepc4py import SLEPc

from . import factorization, petsc_options
from .base import LIMITS

PREFIX = "fxm_eigenvalues_"  # of our own options; that of the user's is in `petsc_options`
FIRST_SHIFT, LAST_SHIFT = 1e-12, 1e8  # below zero, as fractions of a typical eigenvalue
SPREAD = 1e4  # maximum ratio of distances from the shift; the larger ones lose as many digits
EQUAL_EIGENVALUES = 1e-9  # eigenvalues closer than this fraction of their distance from the shift count as equal
TOLERANCE = 1e-12  # estimated relative error of an eigenvalue


class Eigenpair(NamedTuple):
    """Eigenvalue and its vector, of unit norm in M; the imaginary part is zero for a symmetric K.

    Eigenvalues at rounding are set to zero.
    """

    value: complex
    real: PETSc.Vec
    imaginary: PETSc.Vec


def lowest(
    K: PETSc.Mat, M: PETSc.Mat | None, count: int, first: float | None = None, borders: int = 0
) -> tuple[list[Eigenpair], int]:
    """Lowest eigenvalues of a symmetric K, ascending, and the number of negative ones, found or not.

    Args:
        K: Symmetric.
        M: Symmetric and positive semi-definite; the identity if None.
        count: Number of eigenvalues; at most the rank of M.
        first: First shift below zero to try, for eigenvalues that are known to be negative; the number of negative ones
            is then that of those below it.
        borders: Number of negative pivots that belong to borders of K, see `augmented_matrix`.

    Raises:
        ValueError: K is singular or negative where M is zero.
        RuntimeError: SLEPc did not converge.
    """
    with _solver(K, M, symmetric=True) as eps:
        if first is not None:
            eps.setTarget(-first)
        shift, negative = _below_all(eps, borders)
        found = _solve(eps, count)
        low, high = found[0].value.real, found[-1].value.real
        if high - shift > SPREAD * (low - shift):  # the shift is too close to the lowest
            shift = low - 10 * (high - low) / SPREAD
            _move(eps, shift)
            found = _solve(eps, count)
        while (missing := _missing(eps, found, shift, borders)) > 0:
            _move(eps, shift)
            eps.setDeflationSpace([pair.real for pair in found])
            more = _solve(eps, min(missing, count))
            new = [pair for pair in more if pair.value.real < _limit(found, shift)]
            found = _sorted(found + more)[:count]
            if not new:  # differences between count and search are rounding
                break
    return found, negative


def zeros(K: PETSc.Mat, M: PETSc.Mat | None = None) -> int:
    """Count of zero eigenvalues of a symmetric K, up to rounding; M, as of `lowest`, tells a typical one."""
    with _solver(K, M, symmetric=True) as eps:
        eps.setUp()
        negative, _ = _inertia(eps)
        _move(eps, -eps.getTarget())
        below, _ = _inertia(eps)
        return below - negative


def lowest_unsymmetric(K: PETSc.Mat, M: PETSc.Mat, count: int, borders: int = 0) -> list[Eigenpair]:
    """Eigenvalues of an unsymmetric K nearest to a shift below all, ascending in their real part.

    No real part is below the lowest eigenvalue of the symmetric part of K (Bendixson), which gives the shift. Args and
    Raises as for `lowest`.
    """
    part = factorization.symmetric_part(K)
    with _solver(part, M, symmetric=True) as eps:
        shift, _ = _below_all(eps, borders)
    part.destroy()
    return nearest(K, M, count, shift)


def nearest(K: PETSc.Mat, M: PETSc.Mat, count: int, shift: float) -> list[Eigenpair]:
    """Eigenvalues of an unsymmetric K nearest to a shift, ascending in their real part."""
    with _solver(K, M, symmetric=False) as eps:
        eps.setTarget(shift)
        return _solve(eps, count)


@contextmanager
def _solver(K: PETSc.Mat, M: PETSc.Mat | None, symmetric: bool) -> Iterator[SLEPc.EPS]:
    """Shift-invert Krylov-Schur with a shift just below zero; freed by all processes together."""
    eps = SLEPc.EPS().create(K.comm)
    try:
        kinds = SLEPc.EPS.ProblemType
        eps.setOperators(K, M)
        eps.setProblemType((kinds.HEP if M is None else kinds.GHEP) if symmetric else kinds.GNHEP)
        eps.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
        eps.setTarget(-FIRST_SHIFT * _typical(K, M))
        _factorize_by_mumps(eps, "cholesky" if symmetric else "lu")
        yield eps
    finally:
        eps.destroy()


def _typical(K: PETSc.Mat, M: PETSc.Mat | None) -> float:
    """Typical eigenvalue."""
    return float(K.norm() / (K.getSize()[0] ** 0.5 if M is None else M.norm()))


def _factorize_by_mumps(eps: SLEPc.EPS, kind: str) -> None:
    options = PETSc.Options(PREFIX)
    options["st_mat_mumps_icntl_13"] = 1  # no ScaLAPACK at the root, which does not count pivots
    options["st_mat_mumps_icntl_14"] = 100  # twice the memory that is estimated without pivoting
    options["st_mat_mumps_icntl_24"] = 1  # counts null pivots
    icntl, cntl = petsc_options.mumps()
    for number, whole in icntl.items():
        options[f"st_{petsc_options.ICNTL}{number}"] = whole
    for number, real in cntl.items():
        options[f"st_{petsc_options.CNTL}{number}"] = real
    eps.setOptionsPrefix(PREFIX)
    spectral = eps.getST()
    spectral.setType(SLEPc.ST.Type.SINVERT)
    spectral.setMatStructure(PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    ksp = spectral.getKSP()
    ksp.setType(PETSc.KSP.Type.PREONLY)
    ksp.getPC().setType(kind)
    ksp.getPC().setFactorSolverType("mumps")


def _below_all(eps: SLEPc.EPS, borders: int) -> tuple[float, int]:
    """Move the shift below all eigenvalues; return it and the number of negative eigenvalues."""
    eps.setUp()
    shift = eps.getTarget()
    last = LAST_SHIFT * _typical(*eps.getOperators())
    negative, null = _inertia(eps, borders)
    below = negative
    while (below or null) and shift > -last:  # an eigenvalue may be equal to the shift
        shift *= 100
        _move(eps, shift)
        below, null = _inertia(eps, borders)
    if below or null:
        raise ValueError(
            "The tangent stiffness is singular or negative where there is no mass; give mass to the parts without."
        )
    return shift, negative


def _move(eps: SLEPc.EPS, shift: float) -> None:
    """Factorize K - shift M."""
    eps.setTarget(shift)
    spectral = eps.getST()
    spectral.setShift(shift)
    spectral.setUp()
    spectral.getKSP().setUp()


def _inertia(eps: SLEPc.EPS, borders: int = 0) -> tuple[int, int]:
    """Numbers of negative and null pivots: of eigenvalues below the shift and at it; those of borders are left out."""
    negative, null, _ = eps.getST().getKSP().getPC().getFactorMatrix().getInertia()
    return negative - borders, null


def _solve(eps: SLEPc.EPS, count: int) -> list[Eigenpair]:
    eps.setDimensions(count, PETSc.DECIDE, PETSc.DECIDE)
    eps.setTolerances(tol=TOLERANCE)
    eps.solve()
    if eps.getConverged() < count:
        raise RuntimeError(
            f"The eigenvalue solver found {eps.getConverged()} of {count} modes in its {eps.getIterationNumber()} "
            "iterations; ask for fewer."
        )
    return _sorted([_pair(eps, i) for i in range(count)])


def _pair(eps: SLEPc.EPS, i: int) -> Eigenpair:
    K, M = eps.getOperators()
    real, imaginary = K.createVecRight(), K.createVecRight()
    value = complex(eps.getEigenpair(i, real, imaginary))
    work = real.duplicate()
    square = 0.0
    for part in (real, imaginary):
        part.copy(work) if M is None else M.mult(part, work)
        square += work.dot(part)
    for part in (real, imaginary):
        part.scale(square**-0.5)
    # Rounding of K phi where there is no stiffness; its sign is meaningless.
    if abs(value) <= LIMITS.rounding * K.norm(PETSc.NormType.INFINITY) * (real.norm() ** 2 + imaginary.norm() ** 2):
        value = 0j
    return Eigenpair(value, real, imaginary)


def _sorted(pairs: list[Eigenpair]) -> list[Eigenpair]:
    return sorted(pairs, key=lambda pair: pair.value.real)


def _limit(found: list[Eigenpair], shift: float) -> float:
    """Value just below the highest eigenvalue found."""
    highest = found[-1].value.real
    return highest - EQUAL_EIGENVALUES * (highest - shift)


def _missing(eps: SLEPc.EPS, found: list[Eigenpair], shift: float, borders: int) -> int:
    """Count of eigenvalues below the highest found that the search missed."""
    limit = _limit(found, shift)
    _move(eps, limit)
    below, _ = _inertia(eps, borders)
    return below - sum(pair.value.real < limit for pair in found)
