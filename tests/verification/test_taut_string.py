"""Natural frequencies of a taut string, alone and after it was stretched by its supports.

Reference: f = n / (2 L) sqrt(T / m), each in two directions across the string, and on N elements of the length h with a
consistent mass matrix exactly

    omega^2 = 6 T / (m h^2) (1 - c) / (2 + c),   c = cos(n pi / N),

from above with second order. Stretched to the length s L, the string has the force T' = T s + EA s (s^2 - 1) / 2, by
the Saint Venant-Kirchhoff law, and the mass m / s per length. Along the string s dT'/ds takes the place of T'.
Claim: the discrete frequencies, to the last digits; second order follows.
Tolerance: rounding, 1e-16, times the ratio of the largest omega^2, 12 (EA + T) / (m h^2), to the lowest, 7e4: 1e-11.
Stretched, the force is known as well as Newton's tolerance has it: 1e-9.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    natural_frequencies,
)

SOURCE = "string of linear elements, exact"

N, L, T, EA, MASS = 24, 6.0, 2e3, 2e5, 0.4
TURN, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))


def string(kind, direction=TURN[0], supports=(Support([0, N]),)):
    points = np.linspace(0, L, N + 1)[:, None] * direction
    cells = np.stack([np.arange(N), np.arange(1, N + 1)], axis=1)
    return Structure(points, {"string": kind(cells, EA, T, mass=MASS)}, supports)


def exact(n, force, length=L, mass=MASS):
    c = np.cos(n * np.pi / N)
    return np.sqrt(6 * force / mass * (1 - c) / (2 + c)) * N / length / (2 * np.pi)


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", [Cable, Mast])
def test_taut_string(kind, verified):
    state = Analysis(string(kind)).run([Stage("rest")])["rest"]
    modes = natural_frequencies(state, 8)
    n = np.repeat(np.arange(1, 5), 2)
    np.testing.assert_allclose(modes.frequencies, exact(n, T), rtol=1e-11)
    verified("lowest frequency on 24 elements [Hz]", exact(1, T), modes.frequencies[0])
    assert (modes.frequencies > n / (2 * L) * np.sqrt(T / MASS)).all()
    assert np.abs(modes.shapes @ TURN[0]).max() < 1e-9 * np.abs(modes.shapes).max()  # across


def test_along_the_string():
    upright = string(Mast, np.array([0, 0, 1.0]), [Support([0, N]), Support(np.arange(1, N), "xy")])
    state = Analysis(upright).run([Stage("rest")])["rest"]
    np.testing.assert_allclose(natural_frequencies(state, 3).frequencies, exact(np.arange(1, 4), EA + T), rtol=1e-11)


@pytest.mark.parametrize("s", [1.01, 1.3])
def test_stretched(s):
    pull = PrescribedDisplacement(N, (s - 1) * L * TURN[0])
    state = Analysis(string(Cable, supports=[Support(0)])).run([Stage("pull", displacements=[pull])])["pull"]
    force = T * s + EA * s * (s**2 - 1) / 2
    assert state.cable("string").force == pytest.approx(force, rel=1e-9)
    slope = T * s + EA * s * (3 * s**2 - 1) / 2
    n = np.arange(1, 5)
    across, along = exact(n, force, s * L, MASS / s), exact(n, slope, s * L, MASS / s)
    expected = np.sort(np.concatenate([across, across, along]))
    np.testing.assert_allclose(natural_frequencies(state).frequencies, expected[:6], rtol=1e-9)
