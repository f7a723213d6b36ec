"""Newton's method converges quadratically; energy, residual and tangent are derivatives of each other.

Reference: Taylor's theorem. For a state x and a direction d, with residual R and tangent K,

    Pi(x + h d) - Pi(x) - h R.d = O(h^2),    ... - h^2/2 d.K d = O(h^3),    R(x + h d) - R(x) - h K d = O(h^2),

and near a solution with a regular tangent the error of a Newton step is of the order of the square of the last one.
Claim: the orders 2, 3, 2 and 2 on a saddle of fabric with edge cables and a mast, in a random deformed state.
Tolerance: the remainders are polynomials in h of degree 4 (3 for the residual), since the strains are quadratic in u;
the next term spoils the observed order by its share, of the relative size h times 10, below 0.05 for the h used.
Rounding, 1e-16 of the energy against h^3 = 1e-9 of it, does so less. Order of Newton: with r' = c r^2 from step to
step, the ratio of logarithms of three residuals is 2 + log(c'/c) / log(r'/r); for a factor c that changes by 3 while
the residual falls by 40 that is 2 within 0.3.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DeadLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    Stage,
    Structure,
    Support,
    rectangle,
)
from fx_membrane.problem import Actions, Problem

N = 6
CENTRE = (N + 1) * (N // 2) + N // 2
STEPS = 2e-3 / 2.0 ** np.arange(4)


def saddle(material, prestress):
    """A saddle with edge cables, held at three corners, the fourth on a mast with two stays."""
    points, triangles = rectangle(2.0, 2.0, N, N)
    points[:, 2] = 0.6 * points[:, 0] * points[:, 1]
    grid = np.arange(len(points)).reshape(N + 1, N + 1)
    sides = [grid[0], grid[-1], grid[:, 0], grid[:, -1]]
    edges = np.concatenate([np.stack([side[:-1], side[1:]], axis=-1) for side in sides])
    top, foot = grid[-1, -1], len(points)
    points = np.vstack([points, [[0.8, 0.8, -1.0], [2.2, 1.1, -1.0], [1.1, 2.2, -1.0]]])
    stays = np.array([[top, foot + 1], [top, foot + 2]])
    parts = {
        "sail": Membrane(triangles, material, prestress, warp=(1.0, 0.5, 0.0)),
        "edges": Cable(edges, 5e3, 60.0),
        "stays": Cable(stays, 5e3, 60.0),
        "mast": Mast(np.array([[foot, top]]), 5e4, -50.0),
    }
    return Structure(points, parts, [Support([grid[0, 0], grid[0, -1], grid[-1, 0], foot, foot + 1, foot + 2])])


WOVEN = OrthotropicFabric(1000.0, 600.0, nu=0.3, Gt=100.0)
SADDLES = {
    "isotropic": saddle(Fabric(1000.0, 0.3), 100.0),
    "woven": saddle(WOVEN, np.array([[125.0, 20.0], [20.0, 75.0]])),
}


@pytest.mark.parametrize("name", SADDLES)
@pytest.mark.parametrize(
    "load", [PointLoad(CENTRE, (4.0, 2.0, -15.0)), DeadLoad((0.0, 0.0, -20.0), "sail")], ids=["point", "dead"]
)
def test_newton_is_quadratic(name, load):
    stages = [Stage("prestress"), Stage("load", loads=[load], after="prestress")]
    state = Analysis(SADDLES[name]).run(stages)["load"]
    residuals = np.array([iteration.residual for _, iteration in state.history])
    residuals = residuals[residuals > 1e-12 * np.abs(state.reactions).max()]  # below is rounding
    orders = np.log(residuals[2:] / residuals[1:-1]) / np.log(residuals[1:-1] / residuals[:-2])
    assert residuals[-1] < 1e-6
    assert residuals[-1] < residuals[-2] / 40 < residuals[-3] / 40**2
    assert orders[-1] == pytest.approx(2, abs=0.3)


@pytest.fixture(scope="module", params=list(SADDLES))
def taylor(request):
    """Remainders for each step: of energy after one and two terms, of the residual after one."""
    structure = SADDLES[request.param]
    rng = np.random.default_rng(3)
    problem = Problem(structure)
    zero = np.zeros(structure.points.shape)
    problem.apply(Actions(rng.normal(size=zero.shape), structure.supported, zero))
    distribute, create = problem.discretization.distribute, problem.discretization.create_vector
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


@pytest.mark.parametrize(
    ("row", "order"), [(0, 2), (1, 3), (2, 2)], ids=["energy, residual", "energy, tangent", "residual, tangent"]
)
def test_taylor_remainders(taylor, row, order):
    remainder = taylor[row]
    np.testing.assert_allclose(np.log2(remainder[:-1] / remainder[1:]), order, rtol=0, atol=0.05)


@pytest.mark.parametrize("name", SADDLES)
def test_tangent_is_symmetric(name):
    """All forces have a potential here."""
    problem = Problem(SADDLES[name])
    rng = np.random.default_rng(4)
    x, a, b = (problem.discretization.distribute(rng.normal(size=SADDLES[name].points.shape)) for _ in range(3))
    A, Ka, Kb = problem.discretization.create_matrix(), a.duplicate(), b.duplicate()
    problem.tangent(x, A)
    A.mult(a, Ka)
    A.mult(b, Kb)
    assert b.dot(Ka) == pytest.approx(a.dot(Kb), rel=1e-12, abs=1e-12 * A.norm())
