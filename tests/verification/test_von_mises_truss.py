"""Stability and small motions of a von Mises truss: two struts between fixed feet meet at an apex that is pushed down.

Reference: closed form. With the feet at x = -a and a, the apex at the height h at rest and z when pushed, the length L
of the struts at rest and the strain E = (z^2 - h^2) / (2 L^2), the Saint Venant-Kirchhoff law gives the load
2 EA E z / L and the tangent at the apex, diagonal,

    K_xx = 2 EA (E + a^2 / L^2) / L,   K_yy = 2 EA E / L,   K_zz = 2 EA (E + z^2 / L^2) / L.

K_zz changes sign at the limit points z = +-h / sqrt(3), K_yy where the struts come into compression. The mass that
moves with the apex is a third of both struts.
Claim: the eigenvalues of the tangent, their directions, the frequencies and the rates of growth, before, between and
beyond the limit points and at them; the eigenvalue under a load just below the first of them.
Tolerance: the solver's, 1e-12 of each eigenvalue, and rounding, 1e-16 of EA / L in each of some ten operations; as
little as 1/400 of EA / L is left of K_zz, and 1e-12 of its digits. Under a load: Newton's 1e-10 over that share.
"""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Mast,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    natural_frequencies,
    stability,
)

SOURCE = "closed form of a von Mises truss"

SPAN, H, EA, MASS = 1.0, 0.4, 1e5, 3.0
L = np.hypot(SPAN, H)
APEX = 2
LIMIT = H / np.sqrt(3)


def truss(held="y"):
    points = [[-SPAN, 0, 0], [SPAN, 0, 0], [0, 0, H]]
    supports = [Support([0, 1])] + ([Support(APEX, held)] if held else [])
    return Structure(points, {"struts": Mast([[0, APEX], [1, APEX]], EA, mass=MASS)}, supports)


def tangent(z):
    strain = (z**2 - H**2) / (2 * L**2)
    return 2 * EA / L * (strain + np.array([SPAN, 0, z]) ** 2 / L**2)


def pushed(z, held="y"):
    """Put the apex at the height z and release it, also across the truss if not held: loads replace reactions."""
    push = PrescribedDisplacement(APEX, (0, 0, z - H), "z")
    state = Analysis(truss()).run([Stage("push", displacements=[push])])["push"]
    return replace(state, actions=replace(state.actions, held=truss(held).supported))


HEIGHTS = [0.9 * H, 1.01 * LIMIT, 0.99 * LIMIT, 0.0, -0.5 * LIMIT, -1.01 * LIMIT, -1.2 * H]


@pytest.mark.parametrize("z", HEIGHTS)
def test_tangent(z, verified):
    result = stability(pushed(z), 2)
    Kx, _, Kz = tangent(z)
    np.testing.assert_allclose(result.stiffnesses, [Kz, Kx], rtol=1e-12, atol=1e-14 * EA / L)
    assert result.negative == (abs(z) < LIMIT)
    verified("lowest stiffness [N/m]", Kz, result.stiffnesses[0])
    expected = np.zeros((2, 3, 3))
    expected[0, APEX, 2] = expected[1, APEX, 0] = 1
    np.testing.assert_allclose(np.abs(result.directions), expected, rtol=0, atol=1e-12)


@pytest.mark.mpi
def test_at_the_limit_point():
    result = stability(pushed(LIMIT), 2)
    np.testing.assert_allclose(result.stiffnesses, [0, tangent(LIMIT)[0]], rtol=1e-12, atol=1e-14 * EA / L)


@pytest.mark.parametrize("z", [0.9 * H, 0.0, -1.2 * H])
def test_free_out_of_its_plane(z):
    result = stability(pushed(z, held=""), 3)
    np.testing.assert_allclose(result.stiffnesses, np.sort(tangent(z)), rtol=1e-12, atol=1e-14 * EA / L)
    assert result.negative == np.count_nonzero(tangent(z) < 0)


@pytest.mark.mpi_once
@pytest.mark.parametrize("z", HEIGHTS)
def test_small_motions(z):
    modes = natural_frequencies(pushed(z), 2)
    apex = 2 * MASS * L / 3
    square = tangent(z)[[2, 0]] / apex
    stable = square > 0
    np.testing.assert_allclose(modes.frequencies, np.where(stable, np.sqrt(abs(square)), 0) / (2 * np.pi), rtol=1e-12)
    np.testing.assert_allclose(modes.growth, np.where(stable, 0, np.sqrt(abs(square))), rtol=1e-12)
    assert np.abs(modes.shapes).max(axis=(1, 2)) == pytest.approx(apex**-0.5, rel=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("share", [0.9, 0.999])
def test_under_a_load(share):
    """Fractions of the load at the limit point; the height is the largest root of the cubic 2 EA E z / L + load."""
    load = share * EA * LIMIT * (H**2 - LIMIT**2) / L**3
    state = Analysis(truss()).run([Stage("load", [PointLoad(APEX, (0, 0, -load))], increments=4)])["load"]
    z = np.roots([1, 0, -(H**2), load * L**3 / EA]).real.max()
    assert state.position[APEX, 2] == pytest.approx(z, rel=1e-8)
    result = stability(state)
    assert result.stiffnesses == pytest.approx(tangent(z)[2], rel=1e-8)
    assert result.negative == 0
