"""Relaxed energies found from the energy alone, cell by cell.

References: the formulas of Saint Venant-Kirchhoff membranes, isotropic and woven, for the same energy without its
formula; for a foil with any prestress, a search for the wrinkle strain b = L L^T of least energy.
Tolerance: rounding, 1e-10 of stresses and energies; 1e-8 of energies found by the search.
"""

from dataclasses import asdict, dataclass

import numpy as np
import pytest
from mpi4py import MPI
from scipy.optimize import minimize

from fx_membrane import (
    Fabric,
    Law,
    Membrane,
    MooneyRivlin,
    NeoHooke,
    OrthotropicFabric,
    Structure,
    Support,
    rectangle,
)
from fx_membrane.assembly.problem import Problem
from fx_membrane.assembly.tension_field import natural_strains, wrinkles
from fx_membrane.forms.wrinkling import SLACK, TAUT
from fx_membrane.geometry.sizes import measures
from taylor import remainders
from wrinkled import COLUMN, FABRICS, ROW, STATES, compliance, frequency_and_tangent, run, shapes, strains, tensor


@dataclass(frozen=True)
class Isotropic(Fabric):
    energy = Fabric.energy


@dataclass(frozen=True)
class Woven(OrthotropicFabric):
    energy = OrthotropicFabric.energy


def without_formula(fabric):
    kind = Isotropic if isinstance(fabric, Fabric) else Woven
    return kind(**asdict(fabric))


@pytest.mark.parametrize("name", FABRICS)
def test_same_as_the_formula(name):
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 21)
    points, cells, warp, u = shapes(e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5), 22)
    one, other = (run(Membrane(cells, law, sigma0, warp), points, u) for law in (fabric, without_formula(fabric)))
    expected, found = one.membrane("part"), other.membrane("part")
    np.testing.assert_array_equal(found.state, expected.state)
    scale = np.abs(expected.second_piola_kirchhoff).max()
    np.testing.assert_allclose(
        found.second_piola_kirchhoff, expected.second_piola_kirchhoff, rtol=0, atol=1e-10 * scale
    )
    assert other.energy == pytest.approx(one.energy, rel=1e-10)


FOILS: dict[str, Law] = {
    "neo-Hooke": NeoHooke(500.0),
    "Mooney-Rivlin": MooneyRivlin(200.0, 50.0),
}


def least(law, E, sigma0):
    """Least energy over all wrinkle strains, from several starts; numbers, not arrays, which take ten times longer."""
    (E11, E12), (_, E22) = E.tolist()
    (s11, s12), (_, s22) = sigma0.tolist()
    c10, c01 = (law.Gt / 2, 0.0) if isinstance(law, NeoHooke) else (law.C10t, law.C01t)

    def energy(v):
        a, b, c = map(float, v)  # b = L L^T with L = [[a, 0], [b, c]]
        e11, e12, e22 = E11 + a * a, E12 + a * b, E22 + b * b + c * c
        C11, C22 = 1 + 2 * e11, 1 + 2 * e22
        t, d = C11 + C22, C11 * C22 - 4 * e12 * e12
        return s11 * e11 + 2 * s12 * e12 + s22 * e22 + c10 * (t + 1 / d - 3) + c01 * (t / d + d - 3)

    options = {"xatol": 1e-10, "fatol": 1e-12, "maxiter": 20000, "maxfev": 20000}
    starts = [(0.3, 0.0, 0.3), (0.05, 0.0, 0.6), (0.6, 0.2, 0.05), (0.01, 0.0, 0.01)]
    found = [minimize(energy, start, method="Nelder-Mead", options=options).fun for start in starts]
    return min(*found, energy((0.0, 0.0, 0.0)))


def foil_strains(seed, count):
    """Strains from half to double length, and prestresses in tension and compression of any direction."""
    rng = np.random.default_rng(seed)
    F = np.eye(2) * rng.uniform(0.6, 1.3, size=(count, 1, 1)) + rng.uniform(-0.35, 0.35, size=(count, 2, 2))
    E = (F.swapaxes(1, 2) @ F - np.eye(2)) / 2
    sigma0 = rng.uniform(-40, 90, size=(count, 2, 2))
    return E, (sigma0 + sigma0.swapaxes(1, 2)) / 2


@pytest.mark.filterwarnings("ignore:Stage .* prestress is lost")
@pytest.mark.parametrize("name", FOILS)
def test_least_energy_of_prestressed_foils(name):
    """Energies of few cells at a time: no cell makes up for another."""
    law: Law = FOILS[name]
    few = 5
    E, sigma0 = foil_strains(31, 8 * few)
    points, cells, warp, u = shapes(E, 32)
    eta = 1e-9
    states = set()
    for first in range(0, len(E), few):
        here, rows = slice(first, first + few), slice(3 * first, 3 * (first + few))
        state = run(Membrane(cells[:few], law, sigma0[here], warp[here], eta), points[rows], u[rows])
        a, b, c = points[rows].reshape(few, 3, 3).swapaxes(0, 1)
        areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        expected = areas @ [least(law, *given) for given in zip(E[here], sigma0[here], strict=True)]
        assert state.energy == pytest.approx(expected, abs=1e-8 * law.stiffness * areas.sum()), here
        states |= set(state.membrane("part").state)
    assert states == set(STATES)


def split(law, E, sigma0, seed):
    """Cells of each state: points, cells, warps, displacements, prestresses."""
    points, cells, warp, u = shapes(E, seed)
    state = run(Membrane(cells, law, sigma0, warp), points, u).membrane("part").state
    for number in STATES:
        chosen = np.flatnonzero(state == number)
        rows = (3 * chosen[:, None] + np.arange(3)).ravel()
        yield points[rows], np.arange(len(rows)).reshape(-1, 3), warp[chosen], u[rows], sigma0[chosen]


@pytest.mark.parametrize("name", FOILS)
def test_tangent_is_consistent_in_each_state(name):
    """No cell changes its state within the steps; the next term is smaller by h over the distance to a switch."""
    E, sigma0 = foil_strains(41, 60)
    for points, cells, warp, u, prestress in split(FOILS[name], E, sigma0, 42):
        assert len(cells) >= 5
        problem = Problem(
            Structure(points, {"part": Membrane(cells, FOILS[name], prestress, warp)}), MPI.COMM_SELF
        ).under()
        d = problem.discretization.to_petsc(np.random.default_rng(43).normal(size=u.shape))
        norms = remainders(problem, problem.discretization.to_petsc(u), d, 8e-6 / 2.0 ** np.arange(4))
        np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.02)


@pytest.mark.parametrize("name", FOILS)
def test_residual_is_continuous_across_switches(name):
    E, sigma0 = foil_strains(51, 300)
    points, cells, warp, u = shapes(E, 52)
    problem = Problem(Structure(points, {"part": Membrane(cells, FOILS[name], sigma0, warp)}), MPI.COMM_SELF).under()
    d = problem.discretization.to_petsc(np.random.default_rng(53).normal(size=u.shape))
    norms = remainders(problem, problem.discretization.to_petsc(u), d, 1e-2 / 4.0 ** np.arange(5))
    assert (norms[:-1] / norms[1:] > 4**0.99).all()


def test_energy_and_residual_belong_together():
    """Differences of the energy along a line through all states, against the work of the residual."""
    E, sigma0 = foil_strains(61, 200)
    points, cells, warp, u = shapes(E, 62)
    law = FOILS["Mooney-Rivlin"]
    problem = Problem(Structure(points, {"part": Membrane(cells, law, sigma0, warp)}), MPI.COMM_SELF).under()
    x = problem.discretization.to_petsc(u)
    d = problem.discretization.to_petsc(np.random.default_rng(63).normal(size=u.shape))
    b = x.duplicate()
    problem.residual(x, b)
    h, values = 1e-5, []
    for sign in (1, -1):
        y = x.copy()
        y.axpy(sign * h, d)
        values.append(problem.energy(y))
    assert (values[0] - values[1]) / (2 * h) == pytest.approx(b.dot(d), rel=1e-6)


# Equal stretches and the corner of the three states


@pytest.mark.parametrize("stretch", [0.5, 0.9, 1 - 1e-9, 1.0, 1 + 1e-9, 1.1, 2.0])
def test_equal_stretches(stretch):
    """No stress below one, equal principal stresses above, and the tangent in closed form.

    W = Gt / 2 (l1^2 + l2^2 + (l1 l2)^-2 - 3): along a stretch of both by 1 + h its second derivative in h is
    Gt (2 l^2 + 10 l^-4); along 1 + h and 1 - h, and along a shear, 2 Gt (l^2 + l^-4). Slack cells keep a fraction.
    """
    law = NeoHooke(500.0)
    points, cells, warp, u = shapes(np.eye(2)[None] * (stretch**2 - 1) / 2, 71)
    result = run(Membrane(cells, law, 0.0, warp, 1e-9), points, u).membrane("part")
    expected = max(law.Gt * (stretch - stretch**-5), 0.0) / stretch
    np.testing.assert_allclose(result.principal, [[expected, expected]], rtol=1e-8, atol=1e-7 * law.Gt)
    if abs(stretch - 1) > 1e-8:
        assert result.state[0] == ("slack" if stretch < 1 else "taut")
    problem = Problem(Structure(points, {"part": Membrane(cells, law)}), MPI.COMM_SELF)
    A = problem.under().tangent(problem.to_petsc(u))
    x = (points + u)[cells[0]]
    x -= x.mean(axis=0)
    first, second = np.linalg.svd(x)[2][:2]  # in the plane of the cell
    a, b = x @ first, x @ second
    motions = np.zeros((3, *points.shape))
    motions[:, cells[0]] = [
        x, np.outer(a, first) - np.outer(b, second), np.outer(a, second) + np.outer(b, first),
    ]  # fmt: skip
    products = [[problem.to_petsc(one).dot(A * problem.to_petsc(other)) for other in motions] for one in motions]
    kept = 1.0 if stretch >= 1 else 1e-4
    both, shear = 2 * stretch**2 + 10 / stretch**4, 2 * (stretch**2 + stretch**-4)
    expected = kept * law.Gt * np.diag([both, shear, shear]) * measures(points, cells)[0]
    np.testing.assert_allclose(products, expected, rtol=1e-9, atol=1e-9 * expected.max())


# At rest: the strain without stress


AT_REST: dict[str, Law] = {
    "neo-Hooke": NeoHooke(500.0),
    "Mooney-Rivlin": MooneyRivlin(200.0, 50.0),
    "Saint Venant-Kirchhoff": Isotropic(1500.0, 0.5),
}


@pytest.mark.parametrize("name", AT_REST)
def test_at_rest_as_the_fabric_of_the_same_modulus(name):
    """Et = 3 Gt, nu = 0.5: state, tangent and frequency of an unstressed sheet that moves in its plane."""
    points, cells = rectangle(1.0, 0.6, 4, 3)
    supports = [Support(np.flatnonzero(points[:, 0] == 0)), Support(np.arange(len(points)), "z")]
    foil, fabric = (
        frequency_and_tangent(Structure(points, {"sheet": Membrane(cells, law, mass=0.5)}, supports))
        for law in (AT_REST[name], Fabric(1500.0, 0.5))
    )
    assert set(fabric[0].membrane("sheet").state) == {"taut"}
    np.testing.assert_array_equal(foil[0].membrane("sheet").state, fabric[0].membrane("sheet").state)
    np.testing.assert_allclose(foil[1], fabric[1], rtol=1e-9)
    np.testing.assert_allclose(foil[2], fabric[2], rtol=0, atol=1e-10 * np.abs(fabric[2]).max())


@pytest.mark.parametrize("prestress", [0.0, -40.0])
def test_rounding_does_not_decide_at_rest(prestress):
    """The strain without stress, found or moved by rounding, is taut; one clearly below it is slack."""
    size = 5000.0 * np.array([[1.0, 0.3, 0.0], [0.3, 1.0, 0.0], [0.0, 0.0, 1.0]])

    def derivatives(cells, E):
        return E @ size + prestress * np.array([1.0, 1.0, 0.0]), np.tile(size, (len(cells), 1, 1))

    natural = natural_strains(derivatives, 100, 3)
    assert np.linalg.norm(derivatives(np.arange(100), natural)[0]) < 1e-10
    noise = 2e-16 * np.random.default_rng(82).uniform(-1, 1, natural.shape)
    assert (wrinkles(derivatives, natural + noise, natural).state == TAUT).all()
    assert (wrinkles(derivatives, natural - [1e-12, 1e-12, 0.0], natural).state == SLACK).all()
