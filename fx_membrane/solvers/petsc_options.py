"""PETSc options of a user for the linear solver, those with the prefix `fx_membrane_`; `Newton` has the list.

An option is honoured, refused in words, or told to have no effect.
"""

from __future__ import annotations

import ctypes
import re
import warnings
from collections.abc import Callable, Iterable

from mpi4py import MPI
from petsc4py import PETSc

from ..model.digests import fingerprint
from ..runtime.number_locale import decimal_point
from ..runtime.processes import refuse_differences, together

PREFIX = "fx_membrane_"
ICNTL, CNTL = "mat_mumps_icntl_", "mat_mumps_cntl_"
NEEDED = {13: "counts negative pivots on several processes", 24: "counts zero pivots"}  # ICNTL that must be 1
SOLVED = 1e-6  # residual of a step, as a fraction of its right-hand side
TOLERANCE = 1e-10  # default of an iterative solver
ITERATIVE = ("ksp_rtol", "ksp_atol", "ksp_divtol", "ksp_max_it")  # limits that a direct solver does not read
MEND = "Mend their names, or leave them out."
DIRECT = ("lu", "cholesky", "redundant", "telescope", "svd", "qr")  # preconditioners that solve in one application


class UnusedOptionWarning(UserWarning):
    """PETSc option with the prefix `fx_membrane_` that has no effect."""


def given() -> dict[str, str]:
    """Options of the user, without the prefix."""
    return dict(PETSc.Options(PREFIX).getAll())


def check(comm: MPI.Intracomm) -> None:
    """Refuse options that cannot be honoured; collective.

    Raises:
        ValueError: They differ between processes; PETSc does not know a type; MUMPS does not know a control, or is not
            to count pivots; steps are not solved to 1e-6.
    """
    refuse_differences(comm, lambda: {"PETSc options": fingerprint(sorted(given().items()))})
    with together(comm):
        controls = mumps()
    if any(controls):
        _try_controls(comm)
    ksp = PETSc.KSP().create(comm)
    try:
        ksp.setType("preonly")
        ksp.getPC().setType("lu")
        apply(ksp)
    finally:
        ksp.destroy()


def mumps() -> tuple[dict[int, int], dict[int, float]]:
    """Integer and real controls of MUMPS, by number.

    Raises:
        ValueError: One is not a number, or is needed otherwise.
    """
    options, names = PETSc.Options(PREFIX), given()
    try:
        icntl = {int(name.removeprefix(ICNTL)): options.getInt(name) for name in names if name.startswith(ICNTL)}
        with decimal_point():
            cntl = {int(name.removeprefix(CNTL)): options.getReal(name) for name in names if name.startswith(CNTL)}
    except (PETSc.Error, ValueError):
        shown = {name: value for name, value in names.items() if name.startswith((ICNTL, CNTL))}
        raise ValueError(
            f"The PETSc options {shown} with the prefix {PREFIX} are not all numbers; give whole ones for {ICNTL}*, "
            f"any for {CNTL}*."
        ) from None
    for number, what in NEEDED.items():
        if icntl.get(number, 1) != 1:
            raise ValueError(
                f"The PETSc option -{PREFIX}{ICNTL}{number} is {icntl[number]}; MUMPS {what} with 1 only, and the "
                "solvers need the count: leave the option out."
            )
    return icntl, cntl


def set_controls(factor: PETSc.Mat) -> None:
    """Set the controls of MUMPS in a factorization.

    Raises:
        ValueError: MUMPS does not have one.
    """
    icntl, cntl = mumps()
    for number, whole in icntl.items():
        _set_control(factor.setMumpsIcntl, f"{ICNTL}{number}", number, whole)
    for number, real in cntl.items():
        _set_control(factor.setMumpsCntl, f"{CNTL}{number}", number, real)


def _set_control(setter: Callable[[int, float], None], option: str, number: int, value: float) -> None:
    try:
        setter(number, value)
    except PETSc.Error as error:
        raise ValueError(
            f"The PETSc option -{PREFIX}{option} is {value:g}, which PETSc refuses (error {error.ierr}): MUMPS has no "
            "control of this number; mend the number or leave the option out."
        ) from None


def _try_controls(comm: MPI.Intracomm) -> None:
    """Set the controls of MUMPS in a factorization of a unit matrix, so that bad ones are refused early."""
    A, ksp = PETSc.Mat().createAIJ(comm.size, nnz=1, comm=comm), PETSc.KSP().create(comm)
    try:
        A.assemble()
        A.shift(1.0)
        ksp.setOperators(A)
        pc = ksp.getPC()
        pc.setType("lu")
        pc.setFactorSolverType("mumps")
        pc.setFactorSetUpSolverType()
        set_controls(pc.getFactorMatrix())
    finally:
        ksp.destroy()
        A.destroy()


def failure(error: Exception) -> ValueError | None:
    """Error in words for one that PETSc raised while options of the user chose its linear solver; None for others."""
    by_dolfinx = "PETSc function" in str(error) or "construction from null" in str(error)  # of an error without words
    if not ((isinstance(error, PETSc.Error) or by_dolfinx) and choose_solver()):
        return None
    shown = ", ".join(f"-{PREFIX}{option} {value}".rstrip() for option, value in sorted(given().items()))
    code = re.search(r"error code(?: is)?:? (\d+)", str(error))
    return ValueError(
        f"PETSc cannot solve for a step with the options {shown}"
        + (f" (error {code[1]})" if code else "")
        + ": its solver may not work on several processes, or not on this matrix. Choose another one, or leave them "
        "out."
    )


@decimal_point()
def apply(ksp: PETSc.KSP) -> None:
    """Apply the options to the linear solver of Newton's steps, a direct one up to here.

    Raises:
        ValueError: PETSc does not know a type; steps would not be solved to 1e-6.
    """
    ksp.setOptionsPrefix(PREFIX)
    ksp.setTolerances(rtol=TOLERANCE)
    try:
        ksp.setFromOptions()
    except PETSc.Error as error:
        kinds = {name: value for name, value in given().items() if name.startswith(("ksp_", "pc_"))}
        raise ValueError(
            f"PETSc refuses the options {kinds} with the prefix {PREFIX}, or does not have this type (error "
            f"{error.ierr}); mend them or leave them out."
        ) from None
    kind = ksp.getPC().getType()
    if ksp.getType() == "preonly" and kind not in DIRECT:
        raise ValueError(
            f"The PETSc option -{PREFIX}pc_type is {kind}, which does not solve for a step when it is applied once; "
            f"give an iterative method too, as -{PREFIX}ksp_type cg."
        )
    rtol = float(ksp.getTolerances()[0])
    if "ksp_rtol" in given() and ksp.getType() != "preonly":  # newer PETSc replaces a negative one without a word
        rtol = PETSc.Options(PREFIX).getReal("ksp_rtol")
    if not rtol >= 0:
        raise ValueError(f"The PETSc option -{PREFIX}ksp_rtol is {rtol:g}, below zero; give at most {SOLVED:g}.")
    if ksp.getType() != "preonly" and rtol > SOLVED:
        raise ValueError(
            f"The PETSc option -{PREFIX}ksp_rtol is {rtol:g}; steps must be solved to {SOLVED:g}: give no more."
        )


def name(ksp: PETSc.KSP) -> str:
    """Name of a linear solver that options have chosen, as "cg with jacobi"; empty for the direct default."""
    return f"{ksp.getType()} with {ksp.getPC().getType()}" if choose_solver() else ""


def ran_out(ksp: PETSc.KSP) -> bool:
    """Return True if the last solve of an iterative linear solver ended at its limit of iterations."""
    return bool(ksp.getConvergedReason() == PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)


def limit_message(ksp: PETSc.KSP) -> str:
    """Sentence on a linear solver that ran out of iterations."""
    rtol, _, _, most = ksp.getTolerances()
    return (
        f"the linear solver that the PETSc options choose, {name(ksp)}, ran out of its {most} iterations before a step "
        f"was solved to {rtol:g}; allow more (-{PREFIX}ksp_max_it), give a better preconditioner (as -{PREFIX}pc_type "
        f"gamg), or leave -{PREFIX}ksp_type out for the direct solver."
    )


def choose_solver() -> bool:
    """Return True if options choose another linear solver than the direct default."""
    return any(option.startswith(("ksp_type", "pc_type", "pc_factor_mat_solver_type")) for option in given())


def unread() -> list[str]:
    """Options that PETSc has not read since the program began."""
    library = ctypes.CDLL(PETSc.__file__)  # petsc4py does not have this function
    used = ctypes.c_int(0)

    def is_used(option: str) -> bool:
        library.PetscOptionsUsed(None, f"{PREFIX}{option}".encode(), ctypes.byref(used))
        return bool(used.value & 0xFF)  # an int, or a bool in newer versions

    return [option for option in given() if not is_used(option)]


def tell_unread(comm: MPI.Intracomm, where: str) -> None:
    """Tell of options that PETSc has not read; collective.

    Warns:
        UnusedOptionWarning: There are some.
    """
    options, remedy = unread(), MEND
    if "ksp_type" not in given() and any(option in ITERATIVE for option in options):
        remedy = f"Limits of iterations need an iterative method: give -{PREFIX}ksp_type, as cg, or leave them out."
    tell_unused(comm, options, where, remedy)


def tell_unused(comm: MPI.Intracomm, options: Iterable[str], where: str, remedy: str = MEND) -> None:
    """Tell of options without effect; collective.

    Warns:
        UnusedOptionWarning: There are some.
    """
    names = ", ".join(f"-{PREFIX}{option}" for option in sorted(options))
    with together(comm):
        if names and comm.rank == 0:
            warnings.warn(
                f"PETSc options have no effect on {where}: {names}. {remedy}", UnusedOptionWarning, stacklevel=4
            )


def tell_not_for_steps(comm: MPI.Intracomm, where: str, factors: bool) -> None:
    """Tell of options that a solver without Newton's steps does not read: all, or those not of MUMPS if it factors."""
    tell_unused(comm, [option for option in given() if not (factors and option.startswith((ICNTL, CNTL)))], where)
