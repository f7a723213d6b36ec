"""Energy, residual and tangent are derivatives of each other.

Reference: Taylor's theorem. For a state x and a direction d, with residual R and tangent K,

    Pi(x + h d) - Pi(x) - h R.d = O(h^2),    ... - h^2/2 d.K d = O(h^3),    R(x + h d) - R(x) - h K d = O(h^2).

Claim: the orders 2, 3 and 2 on a saddle of fabric with edge cables and a mast, in a random deformed state; also with a
pressure that follows the fabric.
Tolerance: the remainders are polynomials in h of degree 4 (3 for the residual), since the strains are quadratic in u;
the next term spoils the observed order by its share, of the relative size h times 10, below 0.05 for the h used.
Rounding, 1e-16 of the energy against h^3 = 1e-9 of it, does so less.
"""

import numpy as np
import pytest

from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from saddles import SADDLES
from taylor import remainders

SOURCE = "Taylor's theorem"

STEPS = 2e-3 / 2.0 ** np.arange(4)


@pytest.fixture(scope="module", params=list(SADDLES))
def taylor(request):
    """Remainders for each step: of energy after one and two terms, of the residual after one."""
    structure = SADDLES[request.param]
    rng = np.random.default_rng(3)
    zero = np.zeros(structure.points.shape)
    problem = Problem(structure).under(Actions(rng.normal(size=zero.shape), structure.supported, zero))
    distribute, create = problem.discretization.to_petsc, problem.discretization.create_vector
    x = distribute(0.05 * rng.normal(size=zero.shape))
    d = distribute(rng.normal(size=zero.shape))
    A = problem.discretization.create_matrix()
    R, Kd = create(), create()
    energy = problem.energy(x)
    problem.residual(x, R)
    problem.tangent(x, A)
    A.mult(d, Kd)
    slope, curvature = R.dot(d), Kd.dot(d)

    first, second, third = [], [], []
    for h in STEPS:
        y, r = x.copy(), create()
        y.axpy(h, d)
        change = problem.energy(y) - energy
        first.append(abs(change - h * slope))
        second.append(abs(change - h * slope - h**2 / 2 * curvature))
        problem.residual(y, r)
        r.axpy(-1.0, R)
        r.axpy(-h, Kd)
        third.append(r.norm())
    return np.array([first, second, third])


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("row", "order"), [(0, 2), (1, 3), (2, 2)], ids=["energy, residual", "energy, tangent", "residual, tangent"]
)
def test_taylor_remainders(taylor, row, order, verified):
    remainder = taylor[row]
    observed = np.log2(remainder[:-1] / remainder[1:])
    np.testing.assert_allclose(observed, order, rtol=0, atol=0.05)
    verified("order of a Taylor remainder", order, observed[-1])


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", SADDLES)
def test_tangent_is_symmetric(name):
    """All forces have a potential here."""
    problem = Problem(SADDLES[name]).under()
    rng = np.random.default_rng(4)
    x, a, b = (problem.discretization.to_petsc(rng.normal(size=SADDLES[name].points.shape)) for _ in range(3))
    A, Ka, Kb = problem.discretization.create_matrix(), a.duplicate(), b.duplicate()
    problem.tangent(x, A)
    A.mult(a, Ka)
    A.mult(b, Kb)
    assert b.dot(Ka) == pytest.approx(a.dot(Kb), rel=1e-12, abs=1e-12 * A.norm())


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", SADDLES)
def test_tangent_with_pressure_is_consistent_and_not_symmetric(name):
    structure, rng = SADDLES[name], np.random.default_rng(5)
    zero = np.zeros(structure.points.shape)
    count = len(structure.parts["sail"].cells)
    actions = Actions(zero, structure.supported, zero, {"sail": 100.0 * rng.normal(size=count)})
    problem = Problem(structure).under(actions)
    assert not problem.symmetric
    x, d, e = (problem.discretization.to_petsc(a * rng.normal(size=zero.shape)) for a in (0.05, 1.0, 1.0))
    norms = remainders(problem, x, d, STEPS)
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.05)
    Kd, Ke = x.duplicate(), x.duplicate()
    A = problem.discretization.create_matrix()
    problem.tangent(x, A)
    A.mult(d, Kd)
    A.mult(e, Ke)
    assert abs(e.dot(Kd) - d.dot(Ke)) > 1e-6 * A.norm()
