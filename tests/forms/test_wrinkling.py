"""Relaxed energies against their definition, found by brute force, cell by cell.

Reference: the relaxed energy is the least of (e + b) : C : (e + b) / 2 over wrinkle strains b >= 0, with the total
elastic strain e = E + C^-1 : sigma0 (A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85-99), searched over all directions
of the wrinkles. State: taut where C : e has no negative principal
value, slack where e has no positive one. With stress S(e) and stiffness C, projection on the
cone of stresses without compression gives bounds for any two strains, so across every switch too,

    0 <= w(e + d) - w(e) - S(e) : d <= d : C : d / 2,      dS : C^-1 : dS <= d : C : d.

Claim: energy, state, stress and tangent, isotropic and orthotropic, in all states, with sheared prestress; the share
`compression_stiffness` of the full energy, exactly.
Tolerance: energies 1e-9 of the full energy: the search leaves the square of its 1e-8. Fourth-order
central differences of step h = 3e-6: the wrinkled stress bends over strains of 1e-3 where the fabric's stiffnesses are
far apart, (3e-3)^4 = 8e-11; rounding of stresses at strains of 3e-2 is 1e-16 * 3e-2 / h = 1e-12: 1e-9 of the stiffness.
Formulas that must agree but for rounding: 1e-12, and 1e-10 for second derivatives.
"""

import itertools

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    _dolfinx,
    tension_field,
)
from fx_membrane.forms import wrinkling
from fx_membrane.geometry import normals
from fx_membrane.problem import Problem

FABRICS = {
    "isotropic": Fabric(5000.0, 0.3),
    "isotropic, nu 0.5": Fabric(5000.0, 0.5),
    "isotropic, nu -0.6": Fabric(5000.0, -0.6),
    "woven": OrthotropicFabric(8000.0, 3000.0, nu=0.4, Gt=500.0),
    "woven, weft stiffer": OrthotropicFabric(1000.0, 8000.0, nu=0.2, Gt=100.0),
}
PAIR = ("isotropic", "woven")
STATES = np.array(["taut", "wrinkled", "slack"])
COUNT = 60  # cells in each state
ROW, COLUMN = np.array([0, 1, 0]), np.array([0, 1, 1])  # components 11, 22, 12


def as_woven(fabric):
    """The same fabric, as an orthotropic one."""
    if isinstance(fabric, OrthotropicFabric):
        return fabric
    return OrthotropicFabric(fabric.Et, fabric.Et, fabric.nu, fabric.Et / (2 * (1 + fabric.nu)))


def compliance(fabric):
    """C^-1 for stresses 11, 22, 12 and strains 11, 22, 2 x 12."""
    f = as_woven(fabric)
    mixed = -f.nu / f.Et_warp
    return np.array([[1 / f.Et_warp, mixed, 0], [mixed, 1 / f.Et_weft, 0], [0, 0, 1 / f.Gt]])


def tensor(v, shear=1.0):
    """Tensors (n, 2, 2) of components 11, 22, 12, the last times `shear`."""
    return np.stack([v[:, 0], shear * v[:, 2], shear * v[:, 2], v[:, 1]], axis=-1).reshape(-1, 2, 2)


def engineering(e):
    """Strains 11, 22, 2 x 12 of tensors."""
    return e[:, ROW, COLUMN] * [1, 1, 2]


def stress(e, fabric):
    """C : e as tensors."""
    return tensor(engineering(e) @ np.linalg.inv(compliance(fabric)))


def inner(a, b):
    return np.einsum("nij,nij->n", a, b)


def state_of(e, fabric):
    taut = np.linalg.eigvalsh(stress(e, fabric))[:, 0] >= 0
    slack = np.linalg.eigvalsh(e)[:, 1] <= 0
    return np.where(taut, 0, np.where(slack, 2, 1))


def strains(fabric, seed, count=COUNT, margin=0.05):
    """Random total strains, `count` in each state, and prestresses; none within `margin` of a switch."""
    rng = np.random.default_rng(seed)
    stresses = tensor(rng.normal(size=(400 * count, 3)) * [1.0, 1.0, 0.7])
    e = tensor(engineering(stresses) @ compliance(fabric), 0.5)
    e = np.where(rng.random(len(e))[:, None, None] < 0.5, e, tensor(rng.normal(size=(len(e), 3))))
    e *= 0.03 * rng.uniform(0.3, 1, len(e))[:, None, None] / np.abs(e).max(axis=(1, 2))[:, None, None]
    values = np.concatenate([np.linalg.eigvalsh(stress(e, fabric)), np.linalg.eigvalsh(e)], axis=1)
    scale = np.repeat([np.abs(values[:, :2]).max(axis=1), np.abs(values[:, 2:]).max(axis=1)], 2, axis=0).T
    clear = (np.abs(values) > margin * scale).all(axis=1)
    state = state_of(e, fabric)
    chosen = np.concatenate([np.flatnonzero(clear & (state == k))[:count] for k in range(3)])
    assert len(chosen) == 3 * count
    sigma0 = stress(tensor(0.01 * rng.normal(size=(3 * count, 3))), fabric)
    return e[chosen], sigma0


def cells_in_space(count, seed):
    """Triangles that share no node, anywhere."""
    rng = np.random.default_rng(seed)
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 0.8, 0]]) + 0.1 * rng.normal(size=(count, 3, 3)) * [1, 1, 0]
    turned = np.einsum("nij,nkj->nki", Rotation.random(count, random_state=seed).as_matrix(), flat)
    return (turned + rng.normal(size=(count, 1, 3))).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


class Formula:
    """Energy, state, stress and tangent of a fabric as the formulas give them, for strains cell by cell."""

    def __init__(self, fabric, count):
        points, cells = cells_in_space(count, 0)
        self.fabric, self.mesh = fabric, _dolfinx.create_mesh(points, cells)
        self.order = _dolfinx.cell_order(self.mesh)
        self.e, self.s, self.angle = self._field(4), self._field(4), self._field(1)
        sigma0 = ufl.as_matrix([[self.s[0], self.s[1]], [self.s[2], self.s[3]]])
        E = ufl.variable(ufl.as_matrix([[self.e[0], self.e[1]], [self.e[2], self.e[3]]]))
        if isinstance(fabric, Fabric):
            relaxed = wrinkling.isotropic(E, sigma0, ufl.as_ufl(fabric.Et), ufl.as_ufl(fabric.nu))
        else:
            moduli = [ufl.as_ufl(v) for v in (fabric.Et_warp, fabric.Et_weft, fabric.nu, fabric.Gt)]
            relaxed = wrinkling.orthotropic(E, sigma0, *moduli, self.angle[0])
        S = ufl.variable(ufl.diff(relaxed.energy, E))
        C = ufl.diff(S, E)
        pairs = list(itertools.product(range(2), repeat=2))
        derivatives = [*(S[ij] for ij in pairs), *(C[ij + kl] for ij in pairs for kl in pairs)]
        values = ufl.as_vector([relaxed.energy, relaxed.state, *derivatives])
        self.expression = _dolfinx.cell_expression(values, self.mesh)

    def _field(self, size):
        return fem.Function(_dolfinx.functionspace(self.mesh, "DG", 0, size))

    def __call__(self, E, sigma0):
        """Energy counted from e = 0, state, stress and tangent."""
        stored = tensor(sigma0[:, ROW, COLUMN] @ compliance(self.fabric), 0.5)
        if isinstance(self.fabric, OrthotropicFabric):
            e = E + stored
            self.angle.x.array[:] = tension_field.direction(e[:, ROW, COLUMN], self.fabric)[self.order]
        self.e.x.array[:] = E[self.order].ravel()
        self.s.x.array[:] = sigma0[self.order].ravel()
        values = np.empty((len(E), 22))
        values[self.order] = self.expression()
        energy = values[:, 0] + inner(sigma0, stored) / 2
        C = values[:, 6:].reshape(-1, 2, 2, 2, 2)
        C = (C + C.swapaxes(3, 4)) / 2  # for symmetric changes of strain
        return energy, values[:, 1].astype(int), values[:, 2:6].reshape(-1, 2, 2), C


@pytest.fixture(scope="module", params=list(FABRICS))
def case(request):
    """A fabric, its formulas, total strains and prestresses."""
    fabric = FABRICS[request.param]
    e, sigma0 = strains(fabric, len(request.param))
    return fabric, Formula(fabric, len(e)), e, sigma0, e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5)


def least_energy(e, fabric):
    """min over b >= 0 of (e + b) : C : (e + b) / 2 for one strain e11, e22, 2 e12.

    A wrinkle strain of rank two may be changed in every direction, so that no stress is left at the minimum: then
    b = -e. Others are b = beta n n, with the best beta >= 0 in closed form for each direction n.
    """
    if np.linalg.eigvalsh([[e[0], e[2] / 2], [e[2] / 2, e[1]]])[1] <= 0:
        return 0.0
    C = np.linalg.inv(compliance(fabric))

    def gain(angle):
        c, s = np.cos(angle), np.sin(angle)
        n = np.stack([c**2, s**2, 2 * c * s])
        return np.minimum(n.T @ C @ e, 0) ** 2 / (2 * np.sum(n * (C @ n), axis=0))

    step = np.pi / 720
    angles = np.arange(720) * step
    around = [gain(angles + shift) for shift in (-step, 0, step)]
    peaks = angles[(around[1] >= around[0]) & (around[1] >= around[2]) & (around[1] > 0)]
    found = [
        minimize_scalar(lambda angle: -gain(np.array([angle]))[0], bounds=(peak - step, peak + step), method="bounded",
                        options={"xatol": 1e-12}).fun
        for peak in peaks
    ]  # fmt: skip
    return e @ C @ e / 2 + min(found, default=0.0)


def test_energy_is_the_least_over_all_wrinkle_strains(case):
    fabric, formula, e, sigma0, E = case
    energy, state, _, _ = formula(E, sigma0)
    full = inner(stress(e, fabric), e) / 2
    expected = np.array([least_energy(v, fabric) for v in engineering(e)])
    assert np.abs(energy - expected).max() <= 1e-9 * full.max()
    np.testing.assert_allclose(energy / full, expected / full, rtol=0, atol=1e-9)
    np.testing.assert_array_equal(state, state_of(e, fabric))
    np.testing.assert_array_equal(np.bincount(state), COUNT)


def test_taut_energy_is_the_full_one_and_slack_none(case):
    fabric, formula, e, sigma0, E = case
    energy, state, S, _ = formula(E, sigma0)
    full = inner(stress(e, fabric), e) / 2
    np.testing.assert_allclose(energy[state == 0], full[state == 0], rtol=1e-12, atol=1e-12 * full.max())
    np.testing.assert_allclose(S[state == 0], stress(e, fabric)[state == 0], rtol=0, atol=1e-12 * np.abs(S).max())
    np.testing.assert_allclose(energy[state == 2], 0, atol=1e-12 * full.max())
    assert not S[state == 2].any()
    principal = np.linalg.eigvalsh(S[state == 1])
    np.testing.assert_allclose(principal[:, 0], 0, atol=1e-12 * np.abs(S).max())
    assert (principal[:, 1] > 0).all()


def difference(function, E, direction, h=3e-6):
    """Derivative along a direction, fourth order."""
    a, b, c, d = (function(E + k * h * direction) for k in (-2, -1, 1, 2))
    return (a - 8 * b + 8 * c - d) / (12 * h)


@pytest.mark.parametrize("direction", [[[1, 0], [0, 0]], [[0, 0], [0, 1]], [[0, 0.5], [0.5, 0]]])
def test_stress_and_tangent_are_derivatives(case, direction):
    fabric, formula, _, sigma0, E = case
    direction = np.array(direction, dtype=float)
    _, _, S, C = formula(E, sigma0)
    stiffness = np.linalg.inv(compliance(fabric)).max()
    slope = difference(lambda E: formula(E, sigma0)[0], E, direction)
    np.testing.assert_allclose(np.einsum("nij,ij->n", S, direction), slope, rtol=0, atol=1e-9 * stiffness * 0.03)
    change = difference(lambda E: formula(E, sigma0)[2], E, direction)
    np.testing.assert_allclose(np.einsum("nijkl,kl->nij", C, direction), change, rtol=0, atol=1e-9 * stiffness)


def test_tangent_has_no_negative_stiffness(case):
    """The energy is convex, and softer than the full one."""
    fabric, formula, _, sigma0, E = case
    _, state, _, C = formula(E, sigma0)
    K = np.array([[C[:, ROW[i], COLUMN[i], ROW[k], COLUMN[k]] for k in range(3)] for i in range(3)]).transpose(2, 0, 1)
    np.testing.assert_allclose(K, K.swapaxes(1, 2), rtol=0, atol=1e-10 * K.max())
    assert (np.linalg.eigvalsh(K) > -1e-12 * K.max()).all()
    assert (np.linalg.eigvalsh(np.linalg.inv(compliance(fabric)) - K) > -1e-9 * K.max()).all()
    np.testing.assert_array_equal(np.linalg.matrix_rank(K[state < 2], tol=1e-6 * K.max()), [3] * COUNT + [2] * COUNT)


@pytest.mark.parametrize("name", ["isotropic", "isotropic, nu 0.5", "isotropic, nu -0.6"])
def test_orthotropic_with_isotropic_constants(name):
    """The isotropic formula uses principal strains, the other the direction of tension."""
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 5)
    E = e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5)
    one, other = Formula(fabric, len(e))(E, sigma0), Formula(as_woven(fabric), len(e))(E, sigma0)
    np.testing.assert_array_equal(one[1], other[1])
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, b, rtol=0, atol=1e-10 * np.abs(a).max())


@pytest.mark.parametrize("lower", [0, 1], ids=["taut | wrinkled", "wrinkled | slack"])
def test_energy_and_stress_are_continuous_across_switches(case, lower):
    fabric, formula, e, sigma0, _ = case
    state = state_of(e, fabric)
    zero = np.zeros_like(sigma0)
    a, b = e[state == lower].copy(), e[state == lower + 1].copy()
    for _ in range(60):  # the line between them is halved until they are neighbours
        middle = (a + b) / 2
        here = (state_of(middle, fabric) <= lower)[:, None, None]
        a, b = np.where(here, middle, a), np.where(here, b, middle)
    rng = np.random.default_rng(lower)
    pad = np.repeat(a[:1], len(e) - 2 * COUNT, axis=0)
    for distance in (1e-3, 1e-5, 1e-7, 1e-9, 1e-11):
        d = distance * tensor(rng.normal(size=(COUNT, 3)))
        both = formula(np.concatenate([a - d, a + d, pad]), zero)
        energy, _, S, _ = (v.reshape(3, COUNT, *v.shape[1:]) for v in both)
        bound = inner(stress(2 * d, fabric), 2 * d)
        rounding = 1e-14 * inner(stress(a, fabric), a).max()
        gain = energy[1] - energy[0] - inner(S[0], 2 * d)
        assert (gain >= -rounding).all()
        assert (gain <= bound / 2 + rounding).all()
        dS = (S[1] - S[0])[:, ROW, COLUMN]
        jump = np.sqrt(np.einsum("ni,ij,nj->n", dS, compliance(fabric), dS))
        assert (jump <= np.sqrt(bound) * (1 + 1e-9) + np.sqrt(rounding) * 1e-5).all()
    states = formula(np.concatenate([a - 1e-3 * (b - a), a, pad]), zero)[1]
    assert set(states[:COUNT]) <= {lower, lower + 1}


def test_bounds_between_any_two_strains(case):
    fabric, formula, e, sigma0, _ = case
    one, other = formula(e, 0 * sigma0), formula(np.roll(e, 7, axis=0)[::-1], 0 * sigma0)
    d = np.roll(e, 7, axis=0)[::-1] - e
    bound = inner(stress(d, fabric), d)
    gain = other[0] - one[0] - inner(one[2], d)
    dS = (other[2] - one[2])[:, ROW, COLUMN]
    assert (gain >= -1e-12 * bound.max()).all()
    assert (gain <= bound / 2 * (1 + 1e-12)).all()
    assert (np.einsum("ni,ij,nj->n", dS, compliance(fabric), dS) <= bound * (1 + 1e-12)).all()


@pytest.mark.parametrize("prestress", [0.0, 50.0])
@pytest.mark.parametrize("strain", [0.0, 0.01, -0.02])
@pytest.mark.parametrize("name", PAIR)
def test_equal_principal_strains_have_a_tangent(name, strain, prestress):
    fabric = FABRICS[name]
    formula = Formula(fabric, 1)
    result = formula(np.array([strain * np.eye(2)]), np.array([prestress * np.eye(2)]))
    assert all(np.isfinite(values).all() for values in result)
    full = np.linalg.inv(compliance(fabric))
    C = result[3][0]
    K = np.array([[C[ROW[i], COLUMN[i], ROW[k], COLUMN[k]] for k in range(3)] for i in range(3)])
    if result[1][0] == 0:
        np.testing.assert_allclose(K[:2, :2], full[:2, :2], rtol=1e-12)
    assert result[1][0] == (2 if strain < 0 and (strain * full[:2, :2].sum(axis=1) < -prestress).all() else 0)


# The same through the package: structures of cells that share no node


def shapes(E, seed):
    """Points, cells, warps and displacements of cells with the strains E, turned anyhow."""
    points, cells = cells_in_space(len(E), seed)
    rng = np.random.default_rng(seed)
    warp = rng.normal(size=(len(E), 3))
    n = normals(points, cells)
    t = warp - np.sum(warp * n, axis=1, keepdims=True) * n
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    T = np.stack([t, np.cross(n, t)], axis=-1)
    values, vectors = np.linalg.eigh(np.eye(2) + 2 * E)
    U = np.einsum("nij,nj,nkj->nik", vectors, np.sqrt(values), vectors)
    F = Rotation.random(len(E), random_state=seed + 1).as_matrix() @ T @ U
    X = points[cells] - points[cells[:, :1]]
    x = np.einsum("nij,njk,nlk->nli", F, T.swapaxes(1, 2), X)
    return points, cells, warp, (x - X).reshape(-1, 3)


def run(part, points, u):
    structure = Structure(points, {"part": part})
    hold = PrescribedDisplacement(np.arange(len(points)), u)
    return Analysis(structure, comm=MPI.COMM_SELF).run([Stage("moved", displacements=[hold])])["moved"]


@pytest.mark.parametrize("eta", [1e-4, 0.2])
def test_results_are_the_blend_of_relaxed_and_full(case, eta):
    fabric, formula, e, sigma0, E = case
    points, cells, warp, u = shapes(E, 4)
    state = run(Membrane(cells, fabric, sigma0, warp, compression_stiffness=eta), points, u)
    full = run(Membrane(cells, fabric, sigma0, warp, compression_stiffness=1.0), points, u)
    result, whole = state.membrane("part"), full.membrane("part")
    energy, number, S, _ = formula(E, sigma0)
    scale = np.abs(stress(e, fabric)).max()

    np.testing.assert_allclose(result.strain, E, rtol=0, atol=1e-14)
    np.testing.assert_allclose(whole.second_piola_kirchhoff, stress(e, fabric), rtol=0, atol=1e-11 * scale)
    blended = (1 - eta) * S + eta * stress(e, fabric)
    np.testing.assert_allclose(result.second_piola_kirchhoff, blended, rtol=0, atol=1e-11 * scale)
    np.testing.assert_array_equal(result.state, STATES[number])
    assert set(whole.state) == {"taut"}
    side = np.diff(points[cells], axis=1)
    area = np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1) / 2
    counted = (1 - eta) * energy + eta * inner(stress(e, fabric), e) / 2
    stored = inner(sigma0, tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5)) / 2
    assert state.energy == pytest.approx(np.sum(area * (counted - stored)), rel=1e-11)

    # The least principal value of a sum is no less than the sum of the least ones.
    least = result.principal[:, 1]
    assert (least >= eta * np.minimum(whole.principal[:, 1], 0) - 1e-12 * scale).all()
    assert (least[number == 2] < 0).all()


def remainders(problem, u, seed, steps):
    """Norms of R(u + h d) - R(u) - h K d."""
    rng = np.random.default_rng(seed)
    x, d = (problem.discretization.distribute(v) for v in (u, rng.normal(size=u.shape)))
    R, Kd, r = (x.duplicate() for _ in range(3))
    A = problem.discretization.create_matrix()
    problem.residual(x, R)
    problem.tangent(x, A)
    A.mult(d, Kd)
    norms = []
    for h in steps:
        y = x.copy()
        y.axpy(h, d)
        problem.residual(y, r)
        r.axpy(-1.0, R)
        r.axpy(-h, Kd)
        norms.append(r.norm())
    return np.array(norms)


@pytest.mark.parametrize("number", range(3), ids=STATES)
@pytest.mark.parametrize("name", PAIR)
def test_tangent_is_consistent_in_each_state(name, number):
    """The next term of the remainder is smaller by h over the strain at which the state would change, 1e-3 for
    the step 1e-6: the orders are 2 within 0.01."""
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 11)
    chosen = state_of(e, fabric) == number
    e, sigma0 = e[chosen], sigma0[chosen]
    points, cells, warp, u = shapes(e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5), 5)
    problem = Problem(Structure(points, {"part": Membrane(cells, fabric, sigma0, warp)}), MPI.COMM_SELF)
    norms = remainders(problem, u, 6, 8e-6 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.01)


@pytest.mark.parametrize("name", PAIR)
def test_residual_is_continuous_across_switches(name):
    """Steps of decreasing size over cells at random distances from their switches: the remainder is a first-order
    one in the few cells that change, never one of order zero."""
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 12, margin=0.0)
    points, cells, warp, u = shapes(e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5), 5)
    problem = Problem(Structure(points, {"part": Membrane(cells, fabric, sigma0, warp)}), MPI.COMM_SELF)
    steps = 1e-2 / 4.0 ** np.arange(5)
    norms = remainders(problem, u, 6, steps)
    assert (norms[:-1] / norms[1:] > 4**0.99).all()


@pytest.mark.parametrize("eta", [1e-4, 0.2, 1.0])
def test_cable(eta):
    """S = <N0 + EA E>, blended; its energy is <N0 + EA E>^2 / (2 EA) - N0^2 / (2 EA)."""
    EA, rng = 7000.0, np.random.default_rng(3)
    N0 = 200.0 * rng.normal(size=COUNT)
    E = 0.05 * rng.normal(size=COUNT)
    points = rng.normal(size=(2 * COUNT, 3))
    cells = np.arange(2 * COUNT).reshape(-1, 2)
    along = np.diff(points[cells], axis=1)[:, 0]
    length, stretch = np.linalg.norm(along, axis=1), np.sqrt(1 + 2 * E)
    u = np.zeros((COUNT, 2, 3))
    u[:, 1] = stretch[:, None] * Rotation.random(COUNT, random_state=1).apply(along) - along
    state = run(Cable(cells, EA, N0, compression_stiffness=eta), points, u.reshape(-1, 3))

    S = N0 + EA * E
    tension = np.maximum(S, 0)
    cable = state.cable("part")
    assert 0 < np.count_nonzero(S < 0) < COUNT
    np.testing.assert_array_equal(cable.slack, (S < 0) & (eta < 1))
    np.testing.assert_allclose(cable.force, ((1 - eta) * tension + eta * S) * stretch, rtol=0, atol=1e-10)
    density = ((1 - eta) * tension**2 + eta * S**2 - N0**2) / (2 * EA)
    assert state.energy == pytest.approx(np.sum(length * density), rel=1e-11)


@pytest.mark.parametrize("slack", [False, True])
def test_cable_tangent_is_consistent(slack):
    rng = np.random.default_rng(4)
    points = rng.normal(size=(2 * COUNT, 3))
    cells = np.arange(2 * COUNT).reshape(-1, 2)
    u = (-0.1 if slack else 0.1) * points
    problem = Problem(Structure(points, {"part": Cable(cells, 7000.0, 100.0)}), MPI.COMM_SELF)
    norms = remainders(problem, u, 7, 1e-4 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.02)


def test_cable_at_the_switch():
    """A cable without force has the stiffness EA when it is pulled, and the share of it when it is pushed."""
    points, cells = np.array([[0.0, 0, 0], [2.0, 0, 0]]), np.array([[0, 1]])
    for push in (1e-3, 1e-6, 1e-9):
        for sign, share in ((1, 1.0), (-1, 1e-4)):
            u = np.array([[0.0, 0, 0], [2.0 * sign * push, 0, 0]])
            force = run(Cable(cells, 7000.0), points, u).cable("part").force[0]
            assert force == pytest.approx(sign * share * 7000.0 * push, rel=2 * push + 1e-6)


# The direction of tension in a woven fabric


def random_fabrics(rng, count, low, high):
    """Stiffnesses that differ by up to 20, shear stiffness down to 1/50, nu between shares of its limit."""
    for _ in range(count):
        weft = 1000.0 * 20.0 ** rng.uniform(-1, 1)
        nu = rng.uniform(low, high) * np.sqrt(1000.0 / weft)
        yield OrthotropicFabric(1000.0, weft, nu, rng.choice([1000.0, weft]) * 50.0 ** rng.uniform(-1, 0))


def random_strains(rng, kind, fabric, count=400):
    components = rng.normal(size=(count, 3))
    if kind == "strains":
        return tensor(components)
    if kind == "stresses":
        H = compliance(fabric)
        return tensor(components / np.sqrt(np.diag(H)) @ H, 0.5)
    # Nearly slack: only a narrow cone of directions is extended.
    angle, small = rng.uniform(0, np.pi, count), 10.0 ** rng.uniform(-8, -1, count)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]).transpose(2, 0, 1)
    return turn @ (np.stack([small, -np.ones(count)], axis=-1)[:, :, None] * turn.swapaxes(1, 2))


@pytest.mark.parametrize("kind", ["strains", "stresses", "nearly slack"])
@pytest.mark.parametrize(("low", "high"), [(-0.999, -0.7), (-0.7, 0.0), (0.0, 0.7), (0.7, 0.999)])
def test_direction_of_tension_is_stationary_and_the_best(low, high, kind):
    """Optimal where the wrinkle strain b = C^-1 : S - e is normal to the tension and not negative; the problem is
    convex, so that is enough. Dense sampling says the same: no direction has more energy."""
    rng = np.random.default_rng(21)
    c, s = np.cos(np.linspace(0, np.pi, 1001)), np.sin(np.linspace(0, np.pi, 1001))
    fan = np.array([c**2, s**2, c * s])
    for fabric in random_fabrics(rng, 100, low, high):
        H, e = compliance(fabric), random_strains(rng, kind, fabric)
        e = e[state_of(e, fabric) == 1]
        angle = tension_field.direction(e[:, ROW, COLUMN], fabric)
        t = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        n = np.stack([-t[:, 1], t[:, 0]], axis=-1)
        tt = np.stack([t[:, 0] ** 2, t[:, 1] ** 2, t[:, 0] * t[:, 1]], axis=-1)
        e_tt, H_tt = np.einsum("ni,nij,nj->n", t, e, t), np.einsum("ni,ij,nj->n", tt, H, tt)
        elastic = tensor((e_tt / H_tt)[:, None] * tt @ H, 0.5)
        b = elastic - e
        scale = np.abs(e).max(axis=(1, 2)) + np.abs(elastic).max(axis=(1, 2))
        along, across = np.einsum("ni,nij,nj->n", t, b, n) / scale, np.einsum("ni,nij,nj->n", n, b, n) / scale
        assert np.abs(along).max() <= 1e-12, fabric
        assert across.min() >= -1e-12, fabric
        assert (e_tt > 0).all(), fabric
        # Where e_tt is a small difference of large terms, rounding is in it: 1e-15 of the strain.
        sampled = np.maximum(engineering(e) @ fan, 0) / np.sqrt(np.einsum("ik,ij,jk->k", fan, H, fan))
        rounding = 1e-15 * np.abs(e).max(axis=(1, 2)) / np.sqrt(H_tt)
        assert (sampled.max(axis=1) <= e_tt / np.sqrt(H_tt) * (1 + 1e-12) + rounding).all(), fabric
