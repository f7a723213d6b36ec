"""Direct factorization: signs of the pivots, and number of factorizations of a matrix."""

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane import Analysis, DistributedLoad, Newton, Pressure, Stage
from fx_membrane.solvers.factorization import choose, pivots
from models import SNOW, sheet

NUMERIC, SYMBOLIC = ("MatCholFctrNum", "MatLUFactorNum"), ("MatCholFctrSym", "MatLUFactorSym")


@pytest.fixture(scope="module", autouse=True)
def log():
    PETSc.Log.begin()


def count(events):
    return sum(PETSc.Log.Event(name).getPerfInfo()["count"] for name in events)


def matrix(dense):
    """Matrix distributed over the processes."""
    A = PETSc.Mat().createAIJ(dense.shape, nnz=dense.shape, comm=MPI.COMM_WORLD)
    for i in range(*A.getOwnershipRange()):
        A.setValues(i, range(len(dense)), dense[i])
    A.assemble()
    A.setOption(PETSc.Mat.Option.SYMMETRIC, bool((dense == dense.T).all()))
    return A


def factored(dense):
    A = matrix(dense)
    ksp = PETSc.KSP().create(MPI.COMM_WORLD)
    choose(ksp, A, symmetric=bool((dense == dense.T).all()))
    ksp.setUp()
    return ksp, A


def symmetric(eigenvalues, seed):
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=2 * [len(eigenvalues)]))
    A = Q @ np.diag(eigenvalues) @ Q.T
    return (A + A.T) / 2


@pytest.mark.mpi_once
@pytest.mark.parametrize("negative", [0, 1, 5, 12])
def test_negative_pivots_of_a_diagonal_matrix(negative):
    diagonal = np.arange(1.0, 13) * np.where(np.arange(12) < negative, -1, 1)
    ksp, _ = factored(np.diag(diagonal))
    assert pivots(ksp) == (negative, 0)


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("negative", [0, 1, 7, 30])
def test_negative_pivots_are_as_many_as_negative_eigenvalues(negative, seed):
    # Sylvester's law of inertia.
    sizes = 10.0 ** np.random.default_rng(seed).uniform(-3, 3, 30)
    ksp, _ = factored(symmetric(np.where(np.arange(30) < negative, -sizes, sizes), seed))
    assert pivots(ksp) == (negative, 0)


@pytest.mark.mpi_once
@pytest.mark.parametrize(("positive", "negative", "zero"), [(8, 0, 1), (5, 3, 1), (4, 2, 3), (0, 0, 4)])
def test_zero_pivots_of_a_diagonal_matrix(positive, negative, zero):
    ksp, _ = factored(np.diag(np.repeat([2.0, -3.0, 0.0], [positive, negative, zero])))
    assert pivots(ksp) == (negative, zero)


@pytest.mark.mpi
@pytest.mark.parametrize("free", [1, 2])
def test_zero_pivots_are_as_many_as_free_motions(free):
    # Unsupported chains of springs.
    chain = 2 * np.eye(6) - np.eye(6, k=1) - np.eye(6, k=-1)
    chain[0, 0] = chain[-1, -1] = 1.0
    ksp, _ = factored(np.kron(np.eye(free), chain))
    assert pivots(ksp) == (0, free)


@pytest.mark.mpi
def test_no_new_factorization_for_another_right_hand_side():
    dense = symmetric(np.linspace(1.0, 5.0, 12), 1)
    before = count(NUMERIC)
    ksp, A = factored(dense)
    b, x = A.createVecs()
    for value in (1.0, 2.0, 3.0):
        b.set(value)
        ksp.solve(b, x)
        expected = np.linalg.solve(dense, np.full(12, value))
        assert x.array == pytest.approx(expected[slice(*x.getOwnershipRange())], rel=1e-12)
    assert count(NUMERIC) - before == 1


@pytest.mark.mpi
def test_new_factorization_for_another_matrix_but_no_new_analysis():
    before, analyses = count(NUMERIC), count(SYMBOLIC)
    ksp, A = factored(np.diag(np.arange(1.0, 13)))
    b, x = A.createVecs()
    for shift in (0.0, -4.5, 3.0):
        A.shift(shift)
        choose(ksp, A, symmetric=True)
        ksp.solve(b, x)
        negative = {0.0: 0, -4.5: 4, 3.0: 1}[shift]
        assert pivots(ksp) == (negative, 0)
    assert count(NUMERIC) - before == 3
    assert count(SYMBOLIC) - analyses == 1


@pytest.mark.mpi
def test_matrix_that_is_not_symmetric_is_solved():
    dense = np.random.default_rng(2).normal(size=(9, 9)) + 5 * np.eye(9)
    ksp, A = factored(dense)
    b, x = A.createVecs()
    b.set(1.0)
    ksp.solve(b, x)
    assert x.array == pytest.approx(np.linalg.solve(dense, np.ones(9))[slice(*x.getOwnershipRange())], rel=1e-12)


AIR = Pressure(300.0, "fabric")


@pytest.mark.mpi_once
@pytest.mark.parametrize("solver", [Newton(), Newton(line_search=False)], ids=["line search", "plain"])
@pytest.mark.parametrize("load", [SNOW, AIR], ids=["symmetric", "not symmetric"])
def test_newton_factors_once_for_each_step(load, solver):
    analysis = Analysis(sheet(), solver)
    before, analyses = count(NUMERIC), count(SYMBOLIC)
    result = analysis.run([Stage("load", [load], increments=2)])["load"]
    steps = [entry for _, entry in result.history if entry.step]
    assert len(steps) > 4
    assert all(entry.shift == 0 for entry in steps)
    assert count(NUMERIC) - before == len(steps)
    assert count(SYMBOLIC) - analyses == 1


@pytest.mark.mpi
def test_newton_factors_again_where_it_adds_tension():
    # The first tangent is singular; then each step begins with the shift of the last, which suffices here.
    analysis = Analysis(sheet(prestress=0.0))
    before = count(NUMERIC)
    snow = analysis.run([Stage("snow", [DistributedLoad((0, 0, -200.0), "fabric")])])["snow"]
    steps = [entry for _, entry in snow.history if entry.step]
    assert steps[0].shift > 0
    assert count(NUMERIC) - before == len(steps) + 1
