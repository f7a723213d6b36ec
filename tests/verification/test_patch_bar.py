"""Straight chains of cables and of masts: axial force against stretch.

Reference: closed form. A bar of the stretch lambda has E = (lambda^2 - 1) / 2, S = N0 + EA E and the axial force
N = S lambda (Gil 2006, (19) and (32) for d = 1, where F = lambda t and J = lambda, so F S F^T / J = S lambda t t^T).
A given N belongs to the largest real root of EA lambda^3 / 2 + (N0 - EA / 2) lambda - N = 0: at the turning point
lambda^2 = (1 - 2 N0 / EA) / 3, far from 1, the others begin.
Claim: force, displacement and energy of a chain of unequal bars, for a prescribed elongation, a force at its end and
a force between its ends.
Tolerance: linear elements contain the solution, and Newton stops below 1e-13 of the forces; the rest is rounding
(1e-16) times stiffness over force (20) and the condition of the tangent (1e2): 1e-12.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from fx_membrane import Analysis, Cable, Mast, Newton, PointLoad, PrescribedDisplacement, Stage, Structure, Support

SOURCE = "Gil 2006, (19) and (32) for d = 1"

EA = 5000.0
KNOTS = np.array([0.0, 0.7, 1.1, 2.3, 2.8, 4.0])  # bars of unequal length
CELLS = np.stack([np.arange(5), np.arange(1, 6)], axis=-1)
SOLVER = Newton(rtol=1e-13)
DIRECTIONS = [*Rotation.random(3, random_state=2).apply([1.0, 0.0, 0.0])]


def force(stretch, N0):
    return (N0 + EA * (stretch**2 - 1) / 2) * stretch


def stretch_under(N, N0):
    roots = np.roots([EA / 2, 0, N0 - EA / 2, -N])
    return roots.real[np.abs(roots.imag) < 1e-9].max()


def energy_density(stretch, N0):
    E = (stretch**2 - 1) / 2
    return N0 * E + EA * E**2 / 2


@pytest.mark.mpi_once
@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize(("kind", "N0", "stretch"), [(Cable, 50.0, 1.08), (Mast, 50.0, 1.08), (Mast, -50.0, 0.93)])
def test_prescribed_elongation(kind, N0, stretch, direction, verified):
    points = np.array([1.0, 2.0, -1.0]) + np.outer(KNOTS, direction)
    u = (stretch - 1) * np.outer(KNOTS, direction)
    structure = Structure(points, {"chain": kind(CELLS, EA, N0)}, [Support(0)])
    # Full steps stay straight; in compression, that is an unstable state, and a line search would leave it.
    straight = replace(SOLVER, line_search=False)
    state = Analysis(structure, straight).run([Stage("pull", displacements=[PrescribedDisplacement(5, u[5])])])["pull"]
    chain = state.parts["chain"]

    np.testing.assert_allclose(state.displacement, u, rtol=0, atol=1e-12)
    np.testing.assert_allclose(chain.strain, (stretch**2 - 1) / 2, rtol=1e-12)
    np.testing.assert_allclose(chain.force, force(stretch, N0), rtol=1e-12)
    verified("axial force [N]", force(stretch, N0), chain.force[0])
    np.testing.assert_allclose(state.reactions[5], force(stretch, N0) * direction, rtol=0, atol=1e-12 * EA)
    assert state.energy == pytest.approx(KNOTS[-1] * energy_density(stretch, N0), rel=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize(("kind", "N"), [(Cable, 600.0), (Mast, 600.0), (Mast, -400.0)])
def test_force_at_the_end(kind, N, axis):
    along = np.eye(3)[axis]
    N0 = np.array([40.0, 10.0, 0.0, -5.0, 25.0])  # each bar has its own prestress, the force is common
    across = "xyz".replace("xyz"[axis], "")
    supports = [Support(0), Support(np.arange(1, 6), across)]
    structure = Structure(np.outer(KNOTS, along), {"chain": kind(CELLS, EA, N0)}, supports)
    state = Analysis(structure, SOLVER).run([Stage("pull", loads=[PointLoad(5, N * along)])])["pull"]
    stretch = np.array([stretch_under(N, n0) for n0 in N0])
    u = np.concatenate([[0], np.cumsum((stretch - 1) * np.diff(KNOTS))])

    np.testing.assert_allclose(state.parts["chain"].force, N, rtol=1e-12)
    np.testing.assert_allclose(state.displacement, np.outer(u, along), rtol=0, atol=1e-12)
    expected = np.sum(np.diff(KNOTS) * energy_density(stretch, N0)) - N * u[5]
    assert state.energy == pytest.approx(expected, rel=1e-12)


@pytest.mark.mpi_once
@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("kind", [Cable, Mast])
def test_force_between_the_ends(kind, direction):
    P, N0, left, right = 80.0, 300.0, KNOTS[2], KNOTS[5] - KNOTS[2]

    def unbalanced(shift):
        return force(1 + shift / left, N0) - force(1 - shift / right, N0) - P

    shift = brentq(unbalanced, 0, 0.5, xtol=1e-15, rtol=1e-14)
    structure = Structure(np.outer(KNOTS, direction), {"chain": kind(CELLS, EA, N0)}, [Support([0, 5])])
    state = Analysis(structure, SOLVER).run([Stage("push", loads=[PointLoad(2, P * direction)])])["push"]

    np.testing.assert_allclose(state.displacement[2], shift * direction, rtol=0, atol=1e-12)
    expected = np.repeat([force(1 + shift / left, N0), force(1 - shift / right, N0)], [2, 3])
    np.testing.assert_allclose(state.parts["chain"].force, expected, rtol=1e-12)
