"""Lowest eigenvalues of given matrices: all of them, also negative, multiple and infinite ones."""

import numpy as np
import pytest
import scipy.linalg
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane.solvers.eigenvalues import lowest, lowest_unsymmetric
from fx_membrane.solvers.factorization import symmetric_part

pytestmark = pytest.mark.mpi

N = 60


def matrix(dense):
    A = PETSc.Mat().createAIJ((N, N), nnz=N, comm=MPI.COMM_WORLD)
    for row in range(*A.getOwnershipRange()):
        A.setValues(row, range(N), dense[row])
    A.assemble()
    return A


def spectrum(*values):
    """Symmetric matrix with these eigenvalues first, then 100, 101, ..."""
    every = np.concatenate([values, 100.0 + np.arange(N - len(values))])
    Q, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(N, N)))
    A = Q @ np.diag(every) @ Q.T
    return (A + A.T) / 2


def positive(seed):
    A = np.random.default_rng(seed).normal(size=(N, N))
    return A @ A.T / N + 0.1 * np.eye(N)


def whole(vector):
    return np.concatenate(MPI.COMM_WORLD.allgather(vector.array_r))


def values(pairs):
    return np.array([pair.value for pair in pairs])


def factorizations():
    return PETSc.Log.Event("MatCholFctrNum").getPerfInfo()["count"]


@pytest.mark.parametrize("K", [positive(3), positive(3) - 0.5 * np.eye(N)], ids=["definite", "indefinite"])
def test_against_a_dense_solver(K):
    M = positive(4)
    exact = scipy.linalg.eigvalsh(K, M)
    pairs, negative = lowest(matrix(K), matrix(M), 8)
    np.testing.assert_allclose(values(pairs), exact[:8], rtol=0, atol=1e-11 * abs(exact).max())
    assert negative == np.count_nonzero(exact < 0)
    phi = np.stack([whole(pair.real) for pair in pairs])
    np.testing.assert_allclose(phi @ M @ phi.T, np.eye(8), rtol=0, atol=1e-10)
    np.testing.assert_allclose(K @ phi.T, M @ phi.T * exact[:8], rtol=0, atol=1e-9 * np.abs(K).max())
    assert not any(whole(pair.imaginary).any() for pair in pairs)


def test_identity_for_no_mass_matrix():
    pairs, negative = lowest(matrix(spectrum(-3.0, 1e-3, 2.0)), None, 3)
    np.testing.assert_allclose(values(pairs), [-3.0, 1e-3, 2.0], rtol=0, atol=1e-12 * 160)
    assert negative == 1


def test_negative_ones_far_from_zero_come_first():
    found, negative = lowest(matrix(spectrum(-1e4, -1e-3, 1e-3, 1.0)), None, 2)
    np.testing.assert_allclose(values(found), [-1e4, -1e-3], rtol=0, atol=1e-12 * 1e4)
    assert negative == 2
    assert lowest(matrix(spectrum(-5.0, -4.0, -3.0)), None, 1)[1] == 3


def test_zero_does_not_cost_the_others_their_digits():
    """The first shift is 1e-12 of a typical eigenvalue below it."""
    found, negative = lowest(matrix(spectrum(0.0, 0.0, 1.0)), None, 3)
    np.testing.assert_allclose(values(found), [0, 0, 1], rtol=0, atol=1e-12)
    assert negative == 0


@pytest.mark.parametrize(("copies", "count"), [(2, 4), (6, 6), (10, 10), (10, 15)])
def test_all_copies_of_a_multiple_eigenvalue(copies, count):
    """One search finds some of the equal chains side by side."""
    size = N // copies
    K = np.kron(np.eye(copies), 2 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1))
    found, _ = lowest(matrix(K), None, count)
    exact = np.repeat(4 * np.sin(np.pi * np.arange(1, size + 1) / (2 * size + 2)) ** 2, copies)[:count]
    np.testing.assert_allclose(values(found), exact, rtol=1e-12)
    phi = np.stack([whole(pair.real) for pair in found])
    np.testing.assert_allclose(phi @ phi.T, np.eye(count), rtol=0, atol=1e-10)


def test_where_there_is_no_mass():
    K, M = positive(3), positive(4)
    M[40:] = M[:, 40:] = 0
    condensed = K[:40, :40] - K[:40, 40:] @ np.linalg.solve(K[40:, 40:], K[40:, :40])
    exact = scipy.linalg.eigvalsh(condensed, M[:40, :40])
    found, negative = lowest(matrix(K), matrix(M), 40)
    np.testing.assert_allclose(values(found), exact, rtol=1e-9)
    assert negative == 0


@pytest.mark.parametrize("value", [0.0, -1.0])
def test_refuses_what_has_neither_mass_nor_stiffness(value):
    K, M = np.eye(N), np.eye(N)
    K[7, 7], M[7, 7] = value, 0.0
    with pytest.raises(ValueError, match=r"singular.*negative.*no mass"):
        lowest(matrix(K), matrix(M), 1)


def test_two_factorizations_where_all_are_positive():
    PETSc.Log.begin()
    before = factorizations()
    lowest(matrix(positive(3)), matrix(positive(4)), 5)
    assert factorizations() == before + 2  # to solve, and to count


def test_unsymmetric_against_a_dense_solver():
    rng = np.random.default_rng(5)
    K, M = positive(3) + 0.3 * rng.normal(size=(N, N)), positive(4)
    exact = scipy.linalg.eigvals(K, M)
    found = lowest_unsymmetric(matrix(K), matrix(M), 10)
    assert np.count_nonzero(values(found).imag) >= 4  # conjugate pairs are tested
    for pair in found:
        assert np.abs(exact - pair.value).min() < 1e-10 * np.abs(exact).max()
        phi = whole(pair.real) + 1j * whole(pair.imaginary)
        np.testing.assert_allclose(K @ phi, pair.value * (M @ phi), rtol=0, atol=1e-9)
        assert (phi.conj() @ M @ phi).real == pytest.approx(1, rel=1e-12)
    assert (np.diff(values(found).real) >= -1e-12).all()
    np.testing.assert_allclose(values(found)[:3].real, np.sort(exact.real)[:3], rtol=1e-9)


def test_symmetric_part():
    K = np.random.default_rng(6).normal(size=(N, N))
    part = symmetric_part(matrix(K))
    first, last = part.getOwnershipRange()
    np.testing.assert_array_equal(part.getValues(range(first, last), range(N)), ((K + K.T) / 2)[first:last])
