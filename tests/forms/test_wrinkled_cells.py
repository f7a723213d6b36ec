"""Wrinkling and slack cables through the package: structures of cells that share no node.

Claim: results are those of the formulas, which `test_wrinkling` compares with their definition; consistent tangent.
Tolerance: rounding, 1e-11 of stresses; orders of remainders as given at the tests.
"""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fx_membrane import (
    Cable,
    Membrane,
    Structure,
)
from fx_membrane.assembly.problem import Problem
from taylor import remainders
from wrinkled import (
    COLUMN,
    COUNT,
    FABRICS,
    PAIR,
    ROW,
    STATES,
    compliance,
    inner,
    run,
    shapes,
    state_of,
    strains,
    stress,
    tensor,
)


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


def along_random(problem, u, seed, steps):
    """Remainders along a random displacement."""
    d = np.random.default_rng(seed).normal(size=u.shape)
    return remainders(problem, problem.discretization.to_petsc(u), problem.discretization.to_petsc(d), steps)


@pytest.mark.parametrize("number", range(3), ids=STATES)
@pytest.mark.parametrize("name", PAIR)
def test_tangent_is_consistent_in_each_state(name, number):
    """The next term of the remainder is smaller by h over the strain of the next switch, 1e-3 for the step 1e-6.

    The orders are 2 within 0.01.
    """
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 11)
    chosen = state_of(e, fabric) == number
    e, sigma0 = e[chosen], sigma0[chosen]
    points, cells, warp, u = shapes(e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5), 5)
    problem = Problem(Structure(points, {"part": Membrane(cells, fabric, sigma0, warp)}), MPI.COMM_SELF).under()
    norms = along_random(problem, u, 6, 8e-6 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.01)


@pytest.mark.parametrize("name", PAIR)
def test_residual_is_continuous_across_switches(name):
    """Steps of decreasing size over cells at random distances from their switches: the remainder is a first-order
    one in the few cells that change, never one of order zero."""
    fabric = FABRICS[name]
    e, sigma0 = strains(fabric, 12, margin=0.0)
    points, cells, warp, u = shapes(e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5), 5)
    problem = Problem(Structure(points, {"part": Membrane(cells, fabric, sigma0, warp)}), MPI.COMM_SELF).under()
    steps = 1e-2 / 4.0 ** np.arange(5)
    norms = along_random(problem, u, 6, steps)
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
    problem = Problem(Structure(points, {"part": Cable(cells, 7000.0, 100.0)}), MPI.COMM_SELF).under()
    norms = along_random(problem, u, 7, 1e-4 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.02)


def test_cable_at_the_switch():
    """A cable without force has the stiffness EA in tension, and its kept fraction in compression."""
    points, cells = np.array([[0.0, 0, 0], [2.0, 0, 0]]), np.array([[0, 1]])
    for push in (1e-3, 1e-6, 1e-9):
        for sign, share in ((1, 1.0), (-1, 1e-4)):
            u = np.array([[0.0, 0, 0], [2.0 * sign * push, 0, 0]])
            force = run(Cable(cells, 7000.0), points, u).cable("part").force[0]
            assert force == pytest.approx(sign * share * 7000.0 * push, rel=2 * push + 1e-6)
