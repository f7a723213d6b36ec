"""Relaxed energies against their definition, found by brute force, cell by cell.

Reference: the relaxed energy is the least of (e + b) : C : (e + b) / 2 over wrinkle strains b >= 0, with the total
elastic strain e = E + C^-1 : sigma0 (A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85-99), searched over all directions
of the wrinkles. State: taut where C : e has no negative principal
value, slack where e has no positive one. With stress S(e) and stiffness C, projection on the cone of stresses without
compression bounds any two strains, also across every switch,

    0 <= w(e + d) - w(e) - S(e) : d <= d : C : d / 2,      dS : C^-1 : dS <= d : C : d.

Claim: energy, state, stress and tangent, isotropic and orthotropic, in all states, with sheared prestress; the share
`compression_stiffness` of the full energy, exactly.
Tolerance: energies 1e-9 of the full energy: the search leaves the square of its 1e-8. Fourth-order
central differences of step h = 3e-6: the wrinkled stress bends over strains of 1e-3 where the fabric's stiffnesses are
far apart, (3e-3)^4 = 8e-11; rounding of stresses at strains of 3e-2 is 1e-16 * 3e-2 / h = 1e-12: 1e-9 of the stiffness.
Formulas that must agree but for rounding: 1e-12, and 1e-10 for second derivatives.
"""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from wrinkled import (
    COLUMN,
    COUNT,
    FABRICS,
    PAIR,
    ROW,
    Formula,
    as_woven,
    compliance,
    engineering,
    inner,
    state_of,
    strains,
    stress,
    tensor,
)


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
    """Difference quotient along a direction, fourth order."""
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
    for _ in range(60):  # the line between them is bisected until they are neighbours
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
