"""Directions of steepest descent and conjugate gradients.

On a quadratic energy conjugate gradients with exact steps are those of linear systems; SciPy gives their iterates. On
any other, each step is parallel to the direction of the textbook, Nocedal & Wright (2006), (5.41), (5.44), for any
length.
"""

import numpy as np
import pytest
from scipy import optimize
from scipy.sparse import linalg

from fx_membrane import Cable, ConjugateGradient, SteepestDescent, Structure, Support
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.conjugate_directions import Gradient, fletcher_reeves, polak_ribiere
from models import CENTRE, INCLINED, inclined_sheet, sheet

KINDS = [None, "jacobi", "tangent"]


class Reduced:
    """Energy, gradient and tangent of a problem at its free components, in the user's order of nodes."""

    def __init__(self, structure, loads, elastic=True):
        self.owner = Problem(structure, elastic=elastic)
        self.free = ~structure.supported
        self.problem = self.owner.under(Actions(loads, structure.supported, np.zeros(loads.shape)))
        self.start = np.zeros(self.free.sum())

    def vector(self, values):
        full = np.zeros(self.free.shape)
        full[self.free] = values
        return self.problem.discretization.to_petsc(full)

    def energy(self, values):
        return self.problem.energy(self.vector(values))

    def gradient(self, values):
        b = self.problem.discretization.create_vector()
        self.problem.residual(self.vector(values), b)
        return self.problem.discretization.to_numpy(b)[self.free]

    def tangent(self, values):
        """Assemble column by column, from products with unit vectors."""
        A = self.problem.discretization.create_matrix()
        self.problem.tangent(self.vector(values), A)
        columns = [A * self.vector(row) for row in np.eye(len(values))]
        return np.array([self.problem.discretization.to_numpy(column)[self.free] for column in columns]).T

    def iterates(self, solver, count, **settings):
        """List the iterates of the solver, each by a separate solve that ends there."""
        found = [self.start]
        for most in range(1, count + 1):
            x = self.vector(self.start)
            solver(max_iterations=most, **settings).prepare(self.owner)(self.problem, x)
            found.append(self.problem.discretization.to_numpy(x)[self.free])
        return np.array(found)


def net():
    """Ten nodes along x, tied to each other and to two fixed ones by forces that grow with their length."""
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (12, 3))
    ties = [(i, j) for i in range(12) for j in range(i + 1, 12) if j == i + 1 or rng.random() < 0.3]
    forces = rng.uniform(0.2, 5.0, len(ties))
    structure = Structure(points, {"net": Cable(ties, 1.0, forces)}, [Support([10, 11]), Support(range(10), "yz")])
    return Reduced(structure, np.zeros(points.shape), elastic=False)


def loaded_sheet():
    structure = inclined_sheet()
    loads = np.zeros(INCLINED.shape)
    loads[[CENTRE, 7]] = [(100.0, 50, -300), (0, -40, 200)]
    return Reduced(structure, loads)


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", [None, "jacobi"])
@pytest.mark.parametrize("beta", ["FR", "PR"])
def test_iterates_on_a_quadratic_energy_are_those_of_linear_conjugate_gradients(beta, kind):
    """Ten components, ten steps; the curvature has nine digits, since it is a difference of forces."""
    reduced = net()
    K, f = reduced.tangent(reduced.start), -reduced.gradient(reduced.start)
    expected = [reduced.start]
    M = np.diag(1 / K.diagonal()) if kind else None
    linalg.cg(K, f, M=M, atol=0.0, maxiter=10, callback=lambda x: expected.append(x.copy()))
    found = reduced.iterates(ConjugateGradient, 10, beta=beta, preconditioner=kind)
    solution = np.linalg.solve(K, f)
    count = len(expected)
    assert count >= 9
    errors = np.abs(found - solution).max(axis=1) / np.abs(solution).max()
    assert np.abs(found[:count] - expected).max() < 1e-6 * np.abs(solution).max()
    assert errors[9] > 1e-5
    assert errors[10] < 1e-7


@pytest.mark.mpi
def test_tangent_as_preconditioner_solves_a_quadratic_energy_in_one_step():
    reduced = net()
    solution = np.linalg.solve(reduced.tangent(reduced.start), -reduced.gradient(reduced.start))
    for solver in (ConjugateGradient, SteepestDescent):
        found = reduced.iterates(solver, 1, preconditioner="tangent")[1]
        assert np.abs(found - solution).max() < 1e-8 * np.abs(solution).max()


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("beta", ["FR", "PR", None])
def test_steps_follow_the_directions_of_the_textbook(beta, kind):
    reduced = loaded_sheet()
    given = {"preconditioner": kind} if beta is None else {"beta": beta, "preconditioner": kind}
    x = reduced.iterates(ConjugateGradient if beta else SteepestDescent, 7, **given)
    K = reduced.tangent(reduced.start)
    M = {None: np.eye(len(K)), "jacobi": np.diag(K.diagonal()), "tangent": K}[kind]
    g = np.array([reduced.gradient(row) for row in x])
    s = np.linalg.solve(M, g.T).T
    d, shares = -s[0], []
    for k in range(7):
        step = x[k + 1] - x[k]
        assert step @ d > (1 - 1e-10) * np.linalg.norm(step) * np.linalg.norm(d)
        fr, pr = g[k + 1] @ s[k + 1] / (g[k] @ s[k]), (g[k + 1] - g[k]) @ s[k + 1] / (g[k] @ s[k])
        shares.append((fr, pr))
        d = {"FR": fr, "PR": pr, None: 0.0}[beta] * d - s[k + 1]
        if d @ g[k + 1] >= 0:
            d = -s[k + 1]
    assert np.abs(np.subtract(*np.transpose(shares))).max() > 0.05  # the two formulas differ here


def test_the_two_formulas():
    """Gil (77) on random vectors, with a preconditioner that differs from one."""
    problem = Problem(sheet())
    rng = np.random.default_rng(0)
    (g0, s0, g1, s1) = arrays = rng.normal(size=(4, *INCLINED.shape))
    vectors = [problem.discretization.to_petsc(array) for array in arrays]
    before, now = Gradient(*vectors[:2]), Gradient(*vectors[2:])
    assert fletcher_reeves(now, before) == pytest.approx((g1 * s1).sum() / (g0 * s0).sum(), rel=1e-12)
    assert polak_ribiere(now, before) == pytest.approx(((g1 - g0) * s1).sum() / (g0 * s0).sum(), rel=1e-12)


@pytest.mark.mpi
def test_same_state_as_an_independent_implementation():
    """SciPy's conjugate gradients (Polak-Ribiere, its own line search)."""
    reduced = loaded_sheet()
    found = optimize.minimize(reduced.energy, reduced.start, jac=reduced.gradient, method="CG", options={"gtol": 1e-3})
    assert found.success
    x = reduced.vector(reduced.start)
    solution = ConjugateGradient("PR").prepare(reduced.owner)(reduced.problem, x)
    assert solution.converged
    ours = reduced.problem.discretization.to_numpy(x)[reduced.free]
    assert np.abs(ours).max() > 0.01
    # gtol over the lowest stiffness
    lowest_mode = np.linalg.eigvalsh(reduced.tangent(ours))[0]
    assert np.linalg.norm(ours - found.x) < 1e-3 * len(ours) ** 0.5 / lowest_mode


def test_monitor_is_told_each_iterate():
    reduced, told = loaded_sheet(), []
    solve = ConjugateGradient().prepare(reduced.owner)
    solution = solve(
        reduced.problem, reduced.vector(reduced.start), lambda number, iterate: told.append((number, iterate))
    )
    assert told == list(enumerate(solution.iterations))
    again = solve(reduced.problem, reduced.vector(reduced.start))
    assert len(told) == len(solution.iterations)
    assert again.iterations[1].energy == pytest.approx(solution.iterations[1].energy, rel=1e-12)
