"""Modes and stiffnesses under follower pressure, against dense matrices."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    natural_frequencies,
    rectangle,
    stability,
)
from fx_membrane.assembly.problem import Problem


def matrices(state):
    """Dense tangent and mass matrix of the free components, on this process alone."""
    problem = Problem(state.structure, MPI.COMM_SELF)
    K = problem.under(state.actions).tangent(problem.to_petsc(state.displacement))
    M = problem.mass()
    free = problem.discretization.dofs(~state.actions.held)
    user = np.argsort(problem.discretization.block_of_node)
    place = (3 * user[:, None] + np.arange(3)).ravel()[free]
    return K.getValues(free, free), M.getValues(free, free), place


def inflated(pressure, held=None):
    """Twisted sheet under a pressure: no equilibrium, but a tangent."""
    points, triangles = rectangle(2.0, 1.0, 6, 3, "right")
    points[:, 2] = 0.1 * points[:, 0] * points[:, 1] + 0.2 * points[:, 0] ** 2
    fabric = Membrane(triangles, Fabric(1e3, 0.3), 50.0, mass=1.0)
    all_held = Structure(points, {"fabric": fabric}, [Support(np.arange(len(points)))])
    state = Analysis(all_held).run([Stage("rest", [Pressure(pressure, "fabric")])])["rest"]
    edge = np.unique(boundary_edges(triangles)) if held is None else held(points)
    free = replace(all_held, supports=[Support(edge)])
    return replace(state, structure=free, actions=replace(state.actions, held=free.supported))


@pytest.mark.mpi
def test_pressure_within_held_edges_has_a_potential():
    state = inflated(100.0)
    K, M, _ = matrices(state)
    assert np.abs(K - K.T).max() < 1e-15 * np.abs(K).max()
    exact = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)[:6]
    modes = natural_frequencies(state)
    omega = np.where(modes.growth > 0, 1j * modes.growth, 2 * np.pi * modes.frequencies)
    np.testing.assert_allclose((omega**2).real, exact, rtol=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize(("pressure", "flutter"), [(50.0, False), (200.0, True)])
def test_pressure_on_free_edges_has_none(pressure, flutter):
    state = inflated(pressure, held=lambda points: np.flatnonzero(points[:, 0] == -1))
    K, M, place = matrices(state)
    assert np.abs(K - K.T).max() > 1e-3 * np.abs(K).max()
    modes = natural_frequencies(state)
    motion = modes.shapes.reshape(6, -1)[:, place]
    assert (modes.growth[:2] > 1).all() == flutter
    assert not modes.growth[2:].any()
    if flutter:  # the growing motion, and its real and imaginary part
        assert modes.frequencies[0] == pytest.approx(modes.frequencies[1], rel=1e-12)
        motion = np.concatenate([[motion[0] + 1j * motion[1]], motion[2:]])
        omega = 2 * np.pi * modes.frequencies - 1j * modes.growth
        omega = omega[[0, 2, 3, 4, 5]]
    else:
        omega = 2 * np.pi * modes.frequencies
    left, right = K @ motion.T, M @ motion.T * omega**2
    np.testing.assert_allclose(left, right, rtol=0, atol=1e-8 * np.abs(left).max())
    np.testing.assert_allclose(np.einsum("ai,ij,aj->a", motion.conj(), M, motion), 1, rtol=1e-9)


@pytest.mark.mpi
def test_stability_under_pressure_is_that_of_the_symmetric_part():
    state = inflated(200.0, held=lambda points: np.flatnonzero(points[:, 0] == -1))
    K, _, _ = matrices(state)
    exact = np.linalg.eigvalsh((K + K.T) / 2)
    result = stability(state, 3)
    np.testing.assert_allclose(result.stiffnesses, exact[:3], rtol=1e-9)
    assert result.negative == np.count_nonzero(exact < 0)
