"""Stabilization, shifts of the tangent, and imposed displacements."""

import numpy as np
import pytest

from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from models import FOOT, MIXED
from taylor import remainders

pytestmark = pytest.mark.mpi

POINTS = MIXED.points
TENSION = 0.3


@pytest.fixture
def structure():
    return MIXED


@pytest.fixture
def problem():
    return Problem(MIXED).under()


def state(seed, size=0.1):
    return size * np.random.default_rng(seed).normal(size=POINTS.shape)


def laplacian(structure):
    """Laplacian by hand: stiffness times gradients of the hat functions, over areas and lengths, (n, n) [N/m]."""
    L = np.zeros(2 * [len(POINTS)])
    for name, k in {"fabric": 2e3, "woven": 3e3, "edge": 5e3, "mast": 9e3}.items():
        for cell in structure.parts[name].cells:
            if len(cell) == 2:
                local = np.array([[1, -1], [-1, 1]]) / np.linalg.norm(np.subtract(*POINTS[cell]))
            else:
                across = np.roll(POINTS[cell], -1, axis=0) - np.roll(POINTS[cell], 1, axis=0)  # opposite each node
                area = np.linalg.norm(np.cross(across[0], across[1])) / 2
                local = across @ across.T / (4 * area)
            L[np.ix_(cell, cell)] += k * local
    return L


def product(problem, A, vector):
    b = problem.discretization.create_vector()
    A.mult(problem.discretization.to_petsc(vector), b)
    return problem.discretization.to_numpy(b)


def residual(problem, at):
    b = problem.discretization.create_vector()
    problem.residual(problem.discretization.to_petsc(at), b)
    return problem.discretization.to_numpy(b)


def close(a, b):
    return a == pytest.approx(b, abs=1e-12 * np.abs(b).max())


def held_tangent(problem, x):
    A, b = problem.discretization.create_matrix(), problem.discretization.create_vector()
    problem.residual(x, b)
    problem.constraints.constrain_residual(x, b)
    problem.tangent(x, A)
    problem.constraints.constrain_tangent(x, A, b)
    return A, b


def test_tension_in_the_structure_is_a_stiffness_against_gradients(structure, problem):
    at = state(1)
    before = residual(problem, at), problem.energy(problem.discretization.to_petsc(at))
    problem = problem.with_stabilization(TENSION)
    force = TENSION * laplacian(structure) @ (POINTS + at)
    assert close(residual(problem, at) - before[0], force)
    energy = problem.energy(problem.discretization.to_petsc(at)) - before[1]
    assert energy == pytest.approx(np.sum(force * (POINTS + at)) / 2, rel=1e-12)


def test_tangent_with_tension_in_the_structure_is_consistent(problem):
    problem = problem.with_stabilization(TENSION)
    x, d = (problem.discretization.to_petsc(state(seed)) for seed in (1, 2))
    norms = remainders(problem, x, d, [1e-2, 5e-3, 2.5e-3])
    assert np.log2(norms[:-1] / norms[1:]) == pytest.approx([2, 2], abs=0.1)


def test_tension_in_the_structure_leaves_nothing_behind(problem):
    before = residual(problem, state(1))
    assert not close(residual(problem.with_stabilization(TENSION), state(1)), before)
    assert close(residual(problem, state(1)), before)


@pytest.mark.parametrize("portions", [[TENSION], [0.1, 0.5, TENSION - 0.6]])
def test_stiffen_adds_the_same_stiffness_to_a_tangent_that_is_held(structure, portions):
    held = structure.supported
    problem = Problem(MIXED).under(Actions(np.zeros(POINTS.shape), held, state(7)))
    x = problem.discretization.to_petsc(state(1))
    A, b = held_tangent(problem, x)
    before = problem.discretization.to_numpy(b)
    K, _ = held_tangent(problem, x)
    for portion in portions:
        problem.stiffen(x, A, b, portion)
    free = np.where(held, 0.0, state(3))
    added = np.where(held, 0.0, TENSION * laplacian(structure) @ free)
    assert close(product(problem, A, free), product(problem, K, free) + added)
    gap = np.where(held, state(1) - state(7), 0.0)
    assert close(product(problem, A, gap), problem.magnitudes.stiffness * gap)
    # The added stiffness couples the constrained components to the right-hand side of the others.
    effect = np.where(held, 0.0, TENSION * laplacian(structure) @ gap)
    assert close(problem.discretization.to_numpy(b), before - effect)


def test_stiffened_system_is_that_of_the_tangent_with_tension(structure):
    """Stiffness of a tension and no force of it: the solution differs from that of the structure under tension."""
    problem = Problem(MIXED).under(Actions(np.zeros(POINTS.shape), structure.supported, state(7)))
    x = problem.discretization.to_petsc(state(1))
    A, b = held_tangent(problem, x)
    problem.stiffen(x, A, b, TENSION)
    B, c = held_tangent(problem.with_stabilization(TENSION), x)
    B.axpy(-1.0, A)
    assert B.norm() <= 1e-13 * A.norm()
    forces = TENSION * laplacian(structure) @ (POINTS + state(1))
    expected = problem.discretization.to_numpy(b) + np.where(structure.supported, 0.0, forces)
    assert close(problem.discretization.to_numpy(c), expected)


def test_bring_puts_held_components_in_place_and_tells_if_they_were_not(structure):
    held, prescribed = structure.supported, state(7)
    problem = Problem(MIXED).under(Actions(np.zeros(POINTS.shape), held, prescribed))
    x = problem.discretization.to_petsc(state(1))
    assert problem.constraints.impose(x) is True
    expected = np.where(held, prescribed, state(1))
    assert np.array_equal(problem.discretization.to_numpy(x), expected)
    assert problem.constraints.impose(x) is False
    assert np.array_equal(problem.discretization.to_numpy(x), expected)


def test_one_component_out_of_place_is_told_to_all_processes(problem):
    away = np.zeros(POINTS.shape)
    away[FOOT, 1] = 1e-12
    assert problem.constraints.impose(problem.discretization.to_petsc(away)) is True
    away[FOOT] = (0, 0, 5.0)  # is free
    assert problem.constraints.impose(problem.discretization.to_petsc(away)) is False


def test_release_makes_held_components_zero(structure, problem):
    v = problem.discretization.to_petsc(state(1))
    problem.constraints.zero_constrained(v)
    assert np.array_equal(problem.discretization.to_numpy(v), np.where(structure.supported, 0.0, state(1)))
