"""Relaxed energies of cables, found from the energy alone.

Reference: the closed form of a cable with a cubic force. Tolerance: rounding, 1e-10 of forces, 1e-11 of energies.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Axial,
    Cable,
    Structure,
    Support,
)
from fx_membrane.assembly.problem import Problem
from taylor import remainders
from wrinkled import frequency_and_tangent, run


@dataclass(frozen=True)
class Stiffening:
    EA: float
    k: float

    def energy(self, E, sigma0, parameters):
        e = E[0, 0]
        return sigma0[0, 0] * e + parameters.EA * e**2 / 2 + parameters.k * e**4 / 4

    @property
    def stiffness(self):
        return self.EA


@pytest.mark.parametrize("eta", [1e-4, 1.0])
def test_cable(eta):
    law, rng, count = Stiffening(7000.0, 1e5), np.random.default_rng(3), 40
    N0, E = 300.0 * rng.normal(size=count), 0.08 * rng.normal(size=count)
    points = np.zeros((2 * count, 3))
    points[:, 1], points[1::2, 0] = np.repeat(np.arange(count), 2), 1.0
    u = np.zeros_like(points)
    u[1::2, 0] = np.sqrt(1 + 2 * E) - 1
    cells = np.arange(2 * count).reshape(-1, 2)
    state = run(Cable(cells, prestress=N0, material=law, compression_stiffness=eta), points, u)
    S = N0 + law.EA * E + law.k * E**3
    assert 5 < np.count_nonzero(S < 0) < count - 5
    cable = state.cable("part")
    np.testing.assert_array_equal(cable.slack, (S < 0) & (eta < 1))
    share = np.where((S < 0), eta, 1.0)
    np.testing.assert_allclose(cable.force, share * S * np.sqrt(1 + 2 * E), rtol=0, atol=1e-10 * np.abs(S).max())
    natural = np.array([np.roots([law.k, 0, law.EA, n]) for n in N0])
    natural = natural[np.arange(count), np.abs(natural.imag).argmin(axis=1)].real

    def w(E):
        return N0 * E + law.EA * E**2 / 2 + law.k * E**4 / 4

    density = (1 - eta) * np.where(S < 0, w(natural), w(E)) + eta * w(E)
    assert state.energy == pytest.approx(density.sum(), rel=1e-11)


def test_cable_at_rest_as_the_linear_one():
    points = np.stack([np.linspace(0, 3, 4), np.zeros(4), np.zeros(4)], axis=1)
    cells, supports = [[0, 1], [1, 2], [2, 3]], [Support(0), Support([1, 2, 3], "yz")]
    own, linear = (
        frequency_and_tangent(Structure(points, {"rope": Cable(cells, material=law, mass=2.0)}, supports))
        for law in (Stiffening(7000.0, 1e5), Axial(7000.0))
    )
    np.testing.assert_array_equal(own[0].cable("rope").slack, linear[0].cable("rope").slack)
    np.testing.assert_allclose(own[1], linear[1], rtol=1e-10)
    np.testing.assert_allclose(own[2], linear[2], rtol=0, atol=1e-10 * np.abs(linear[2]).max())


@pytest.mark.parametrize("slack", [False, True])
def test_cable_tangent_is_consistent(slack):
    rng = np.random.default_rng(4)
    points = rng.normal(size=(40, 3))
    part = Cable(np.arange(40).reshape(-1, 2), prestress=100.0, material=Stiffening(7000.0, 1e5))
    problem = Problem(Structure(points, {"part": part}), MPI.COMM_SELF).under()
    x = problem.discretization.to_petsc((-0.1 if slack else 0.1) * points)
    d = problem.discretization.to_petsc(rng.normal(size=points.shape))
    norms = remainders(problem, x, d, 1e-4 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.02)
