"""PETSc options with the prefix fx_membrane_: honoured, refused in words, or told to have no effect."""

import os
import subprocess
import sys

import numpy as np
import pytest
from dolfinx import cpp
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    ConvergenceError,
    DistributedLoad,
    Newton,
    Outcome,
    Pressure,
    Stage,
    UnusedOptionWarning,
    equilibrium_path,
    stability,
)
from fx_membrane.solvers import factorization, own
from models import inclined_sheet, sheet

SNOW = [Stage("snow", [DistributedLoad((0, 0, -200.0), "fabric")])]
WIND = [Stage("wind", [Pressure(150.0, "fabric", range(7))])]
PREFIX = "fx_membrane_"


@pytest.fixture
def options():
    """Set options with the prefix; they are removed after the test."""
    database = PETSc.Options(PREFIX)

    def set_options(**given):
        for name, value in given.items():
            database[name] = value

    yield set_options
    for name in database.getAll():
        del database[name]


@pytest.fixture
def solvers(monkeypatch):
    """Linear solvers of Newton's steps that were used."""
    used, choose = [], factorization.choose

    def record(ksp, A, symmetric, steps=False):
        choose(ksp, A, symmetric, steps)
        if steps:
            used.append(ksp)

    monkeypatch.setattr(factorization, "choose", record)
    return used


def run(stages, solver=None):
    return Analysis(inclined_sheet(), solver or Newton()).run(stages)[stages[0].name]


@pytest.mark.mpi_once
@pytest.mark.parametrize("backend", ["dolfinx", "snes"])
@pytest.mark.parametrize("stages", [SNOW, WIND])
@pytest.mark.parametrize(
    "given",
    [
        {"ksp_type": "cg", "pc_type": "jacobi"},
        {"ksp_type": "gmres", "pc_type": "gamg", "ksp_max_it": 500},
        {"pc_type": "lu"},
        pytest.param(
            {"pc_type": "lu", "pc_factor_mat_solver_type": "petsc"},
            marks=pytest.mark.skipif(MPI.COMM_WORLD.size > 1, reason="for one process"),
        ),
    ],
)
def test_other_linear_solver_finds_the_same_state(given, stages, backend, options, solvers, monkeypatch):
    if backend == "snes":
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    expected = run(stages)
    assert solvers[-1].getType() == "preonly"
    assert factorization.counts_pivots(solvers[-1]) == (stages is SNOW)
    if given.get("ksp_type") == "cg" and stages is WIND:
        given = given | {"ksp_type": "bcgs"}  # for a tangent that is not symmetric
    options(**given)
    found = run(stages)
    assert solvers[-1].getType() == given.get("ksp_type", "preonly")
    assert solvers[-1].getPC().getType() == given["pc_type"]
    assert not factorization.counts_pivots(solvers[-1])
    size = np.abs(expected.displacement).max()
    np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-9 * size)


@pytest.mark.mpi
def test_flat_sheet_without_prestress_by_conjugate_gradients(options):
    """Its first tangent is singular: the shift of the tangent still finds the state."""
    expected = Analysis(sheet(prestress=0.0)).run(SNOW)["snow"]
    options(ksp_type="cg", pc_type="jacobi")
    found = Analysis(sheet(prestress=0.0)).run(SNOW)["snow"]
    assert found.equilibrium.residual < 1e-6 * 800
    size = np.abs(expected.displacement).max()
    np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-6 * size)
    assert stability(found).stable


@pytest.mark.mpi_once
@pytest.mark.parametrize("backend", ["dolfinx", "snes"])
def test_linear_solver_that_fails_on_a_singular_tangent_gets_a_shift(backend, options, monkeypatch):
    """MINRES divides zero by zero there, a failure at which SNES would end."""
    if backend == "snes":
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    options(ksp_type="minres", pc_type="none")
    (increment,) = Analysis(sheet(prestress=0.0)).run(SNOW)["snow"].increments
    assert increment.outcome is Outcome.CONVERGED


@pytest.mark.mpi
def test_controls_of_mumps_reach_the_factorization(options, solvers, monkeypatch):
    monkeypatch.setattr(own, "release", lambda solve: None)  # at the end of the run, factors included
    run(SNOW)
    assert solvers[-1].getPC().getFactorMatrix().getMumpsIcntl(14) == 50
    options(mat_mumps_icntl_14=123, mat_mumps_icntl_7=5, mat_mumps_cntl_1=0.02)
    state = run(SNOW)
    factor = solvers[-1].getPC().getFactorMatrix()
    assert (factor.getMumpsIcntl(14), factor.getMumpsIcntl(7), factor.getMumpsCntl(1)) == (123, 5, 0.02)
    assert factor.getMumpsIcntl(24) == 1
    assert stability(state).stable  # the eigenvalue solver takes them too


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"mat_mumps_icntl_13": 0}, "-fx_membrane_mat_mumps_icntl_13 is 0; MUMPS counts negative pivots"),
        ({"mat_mumps_icntl_24": 0}, "-fx_membrane_mat_mumps_icntl_24 is 0; MUMPS counts zero pivots"),
        ({"mat_mumps_icntl_999": 1}, "-fx_membrane_mat_mumps_icntl_999 is 1, which PETSc refuses"),
        ({"mat_mumps_cntl_99": 1.5}, r"-fx_membrane_mat_mumps_cntl_99 is 1\.5, which PETSc refuses"),
        ({"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": -1}, "-fx_membrane_ksp_rtol is -1, below zero"),
        ({"mat_mumps_icntl_14": "much"}, "with the prefix fx_membrane_ are not all numbers; give whole .*icntl_.*[.]$"),
        ({"pc_type": "jacobi"}, "-fx_membrane_pc_type is jacobi, which does not solve for a step"),
        ({"pc_type": "magic"}, "PETSc refuses the options .*'pc_type': 'magic'"),
        ({"ksp_type": "magic"}, "PETSc refuses the options .*'ksp_type': 'magic'"),
        ({"ksp_type": "cg", "pc_type": "jacobi", "ksp_rtol": 1e-3}, "ksp_rtol is 0.001; steps must be solved to 1e-06"),
    ],
)
def test_refused(given, words, options):
    options(**given)
    with pytest.raises(ValueError, match=words):
        Analysis(sheet())


@pytest.mark.mpi
def test_error_of_petsc_without_words_is_told_in_words(options):
    options(ksp_type="cg", pc_type="jacobi", ksp_max_it=2, ksp_error_if_not_converged=1)
    with pytest.raises(ValueError, match="PETSc cannot solve for a step with the options -fx_membrane_ksp_error_if"):
        run(SNOW)


@pytest.mark.mpi
def test_linear_solver_that_fails_is_named(options):
    options(ksp_type="cg", pc_type="jacobi", ksp_max_it=2)
    with pytest.raises(ConvergenceError, match="the linear solver that the PETSc options choose, cg with jacobi") as e:
        run(SNOW)
    assert "its 2 iterations" in str(e.value)
    assert "-fx_membrane_ksp_max_it" in str(e.value)
    assert e.value.failed.outcome is Outcome.LINEAR_LIMIT
    assert e.value.failed.load_factor == 1.0  # at once: no increment was halved
    assert e.value.failed.total_iterations <= 2


@pytest.mark.parametrize("stages", [SNOW, WIND])
@pytest.mark.parametrize("line_search", [True, False])
def test_limit_of_the_linear_solver_is_told_by_any_newton(line_search, stages, options):
    options(ksp_type="gmres", pc_type="jacobi", ksp_max_it=12)
    with pytest.raises(ConvergenceError, match="ran out of its 12 iterations"):
        run(stages, Newton(line_search=line_search))


@pytest.mark.mpi
@pytest.mark.parametrize("backend", ["dolfinx", "snes"])
@pytest.mark.parametrize(
    ("given", "shown"),
    [
        ({"pc_type": "cholesky", "pc_factor_mat_solver_type": "petsc"}, "-fx_membrane_pc_type cholesky"),
        ({"ksp_type": "cg", "pc_type": "icc"}, "-fx_membrane_ksp_type cg, -fx_membrane_pc_type icc"),
    ],
)
def test_factorization_for_one_process_alone_is_refused_on_several(given, shown, backend, options, monkeypatch):
    if backend == "snes":
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    options(**given)
    if MPI.COMM_WORLD.size == 1:
        run(SNOW)
        return
    with pytest.raises(ValueError, match=f"cannot solve for a step with the options .*{shown} .error 92"):
        run(SNOW)


def told(record):
    messages = [str(entry.message) for entry in record if issubclass(entry.category, UnusedOptionWarning)]
    return MPI.COMM_WORLD.bcast(messages)


@pytest.mark.mpi
def test_option_that_nothing_reads_is_told_once(options, recwarn):
    options(ksp_typo="cg", snes_monitor="", mat_mumps_icntl_14=60)
    analysis = Analysis(sheet())
    analysis.run(SNOW)
    analysis.run(SNOW)
    expected = "PETSc options have no effect on Newton: -fx_membrane_ksp_typo, -fx_membrane_snes_monitor. Mend"
    (message,) = told(recwarn)
    assert message.startswith(expected)


@pytest.mark.mpi
def test_limit_of_iterations_of_the_direct_solver_is_told(options, recwarn):
    options(ksp_rtol=1e-9)
    run(SNOW)
    (message,) = told(recwarn)
    assert "no effect on Newton: -fx_membrane_ksp_rtol. " in message
    assert "iterative method: give -fx_membrane_ksp_type" in message


def test_without_options_nothing_is_told(recwarn):
    stability(run(SNOW))
    assert not told(recwarn)


@pytest.mark.parametrize(("preconditioner", "names"), [(None, "ksp_type, mat_mumps_icntl_14"), ("tangent", "ksp_type")])
def test_first_order_methods_have_no_steps_to_solve_for(preconditioner, names, options, recwarn):
    options(ksp_type="cg", mat_mumps_icntl_14=60)
    run(SNOW, ConjugateGradient(preconditioner=preconditioner))
    (message,) = told(recwarn)
    expected = ", ".join(f"-{PREFIX}{name}" for name in names.split(", "))
    assert message.startswith(f"PETSc options have no effect on ConjugateGradient: {expected}. Mend")


@pytest.mark.mpi
def test_path_keeps_its_factorization(options, recwarn):
    state = run(SNOW)
    options(ksp_type="cg", pc_type="jacobi")
    path = equilibrium_path(state, Stage("more", [DistributedLoad((0, 0, -100.0), "fabric")], after="snow"))
    assert len(path.points) > 1
    (message,) = told(recwarn)
    assert "no effect on equilibrium_path: -fx_membrane_ksp_type, -fx_membrane_pc_type" in message


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="compares processes")
def test_options_of_one_process_alone_are_refused(options):
    if MPI.COMM_WORLD.rank == 1:
        options(ksp_type="cg")
    with pytest.raises(ValueError, match="process 1 differs from that of process 0 in: PETSc options"):
        Analysis(sheet())


def test_environment():
    """A program of its own with PETSC_OPTIONS."""
    script = (
        "import numpy as np\n"
        "from fx_membrane import *\n"
        "points, triangles = rectangle(1.0, 1.0, 2, 2)\n"
        "fabric = Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)\n"
        "Analysis(Structure(points, {'fabric': fabric}, [Support(range(4))])).run([Stage('none')])\n"
    )
    environment = os.environ | {"PETSC_OPTIONS": "-fx_membrane_ksp_rtol 0.1 -fx_membrane_ksp_type cg"}
    done = subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ksp_rtol is 0.1" in done.stderr
