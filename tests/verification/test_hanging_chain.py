"""Natural frequencies of a chain that hangs from one end under its own weight.

Reference: omega = j / 2 sqrt(g / L), j the zeros of J0: 2.40482556, 5.52007811, 8.65372791 (D. Bernoulli 1738; H. Lamb,
Dynamics (1914), section 91). The tension m g (L - s) comes from the dead load and vanishes at the free end.
Claim: the frequencies converge from above with second order. The chain may turn about its support, where only its
weight holds it; in the first mode it does nearly that: a rigid rod has sqrt(3 g / (2 L)), which is 1.8 % more.
Tolerance: at the free end, where the tension vanishes, the next term is of third order. In the third mode it is 1e-2
of the error of 2e-4 on 160 elements: that is seen in the order, and the extrapolation leaves a third of it, 7e-7.
"""

import numpy as np
import pytest
from scipy.special import jn_zeros

from fx_membrane import Analysis, Cable, DistributedLoad, Stage, Structure, Support, natural_frequencies

SOURCE = "D. Bernoulli 1738; H. Lamb, Dynamics, 1914, section 91"

L, MASS, G = 3.0, 0.7, 9.81
EXACT = jn_zeros(0, 3) / 2 * np.sqrt(G / L) / (2 * np.pi)


def chain(n):
    """In equilibrium from the start: each element carries the weight below its middle."""
    points = np.linspace([0, 0, 0], [0, 0, -L], n + 1)
    cells = np.stack([np.arange(n), np.arange(1, n + 1)], axis=1)
    tension = MASS * G * L * (1 - (np.arange(n) + 0.5) / n)
    parts = {"chain": Cable(cells, axial_stiffness=2e3, prestress=tension, mass=MASS)}
    structure = Structure(points, parts, [Support(0), Support(np.arange(n + 1), "y")])
    return Analysis(structure).run([Stage("weight", [DistributedLoad((0, 0, -G * MASS), "chain")])])["weight"]


def test_second_order_from_above(verified):
    frequencies = np.array([natural_frequencies(chain(n), 3).frequencies for n in (80, 160, 320)])
    error = frequencies / EXACT - 1
    assert (error > 0).all()
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.015)
    np.testing.assert_allclose((4 * frequencies[2] - frequencies[1]) / 3, EXACT, rtol=7e-7)
    verified("lowest frequency [Hz]", EXACT[0], frequencies[2, 0], np.log2(error[1, 0] / error[2, 0]))
    rod = np.sqrt(3 * G / (2 * L)) / (2 * np.pi)
    assert frequencies[2, 0] / rod == pytest.approx(1 - 0.0182, abs=5e-5)
