"""Energy, residual and tangent of all parts together."""

import numpy as np
import pytest

from fx_membrane import Cable, Structure, Support
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from fx_membrane.geometry.sizes import measures
from models import MIXED, sheet

pytestmark = pytest.mark.mpi

POINTS = MIXED.points


@pytest.fixture
def structure():
    return MIXED


@pytest.fixture
def problem():
    return Problem(MIXED).under()


def state(seed, size):
    return size * np.random.default_rng(seed).normal(size=POINTS.shape)


def loaded(structure, forces):
    return Actions(forces, structure.supported, np.zeros(POINTS.shape))


def residual(problem, displacement):
    b = problem.discretization.create_vector()
    problem.residual(problem.discretization.to_petsc(displacement), b)
    return problem.discretization.to_numpy(b)


def energy(problem, displacement):
    return problem.energy(problem.discretization.to_petsc(displacement))


def test_reference_shape_has_no_energy(problem):
    assert energy(problem, np.zeros(POINTS.shape)) == 0


def test_residual_is_the_gradient_of_the_energy(structure):
    problem = Problem(MIXED).under(loaded(structure, state(3, 20.0)))
    at = state(1, 0.05)

    def along(shape):
        return energy(problem, np.reshape(shape, POINTS.shape))

    h = 1e-5
    central = [(along(at.ravel() + h * e) - along(at.ravel() - h * e)) / (2 * h) for e in np.eye(at.size)]
    exact = residual(problem, at)
    assert exact.ravel() == pytest.approx(np.array(central), abs=1e-7 * np.abs(exact).max())


def test_tangent_is_the_derivative_of_the_residual_and_symmetric(problem):
    discretization = problem.discretization
    at, h = state(1, 0.05), 1e-5
    A, x = discretization.create_matrix(), discretization.to_petsc(at)
    problem.tangent(x, A)
    for seed in range(3):
        direction = state(10 + seed, 1.0)
        b = discretization.create_vector()
        A.mult(discretization.to_petsc(direction), b)
        central = (residual(problem, at + h * direction) - residual(problem, at - h * direction)) / (2 * h)
        exact = discretization.to_numpy(b)
        assert exact == pytest.approx(central, abs=1e-7 * np.abs(exact).max())
    difference = A.copy()
    difference.axpy(-1.0, A.copy().transpose())
    assert difference.norm() <= 1e-13 * A.norm()


def test_tangent_is_made_anew_each_time(problem):
    discretization = problem.discretization
    A, B = discretization.create_matrix(), discretization.create_matrix()
    problem.tangent(discretization.to_petsc(state(1, 0.2)), A)
    for matrix in (A, B):
        problem.tangent(discretization.to_petsc(state(2, 0.05)), matrix)
    B.axpy(-1.0, A)
    assert B.norm() <= 1e-14 * A.norm()


def test_internal_forces_balance(problem):
    forces, position = residual(problem, state(1, 0.05)), POINTS + state(1, 0.05)
    assert forces.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * np.abs(forces).sum())
    assert np.cross(position, forces).sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * np.abs(forces).sum())


def test_bar_by_hand():
    structure = Structure([[0.0, 0, 0], [2, 0, 0]], {"cable": Cable([[0, 1]], 1e4, prestress=300.0)}, [Support(0)])
    displacement = np.array([[0.0, 0, 0], [1, 4, 0]])  # from length 2 to length 5, along (3, 4, 0)
    E = ((5 / 2) ** 2 - 1) / 2
    force = (300.0 + 1e4 * E) * 5 / 2
    problem = Problem(structure).under()
    assert residual(problem, displacement)[1] == pytest.approx(force * np.array([0.6, 0.8, 0]), rel=1e-13)
    assert energy(problem, displacement) == pytest.approx(2 * (300.0 * E + 1e4 * E**2 / 2), rel=1e-13)


def test_loads_lower_the_energy_by_their_work(structure, problem):
    forces, at = state(3, 20.0), state(1, 0.05)
    before = energy(problem, at)
    problem = Problem(MIXED).under(loaded(structure, forces))
    assert energy(problem, at) - before == pytest.approx(-np.sum(forces * at), rel=1e-11)


def test_distributed_loads_go_to_the_nodes_of_their_cells(structure, problem):
    load = np.array([1.0, -2.0, 3.0])
    for name in ("fabric", "edge", "mast"):
        part = structure.parts[name]
        q = np.zeros((len(part.cells), 3))
        q[-1] = load
        nodal = problem.assembler.nodal_loads({name: q})
        size = measures(POINTS, part.cells)[-1]
        expected = np.zeros(POINTS.shape)
        expected[part.cells[-1]] = load * size / len(part.cells[-1])
        assert nodal == pytest.approx(expected, rel=1e-13, abs=1e-15)


def test_distributed_loads_of_two_parts_add_up_and_do_not_stay(structure, problem):
    def ones(name):
        return {name: np.ones((len(structure.parts[name].cells), 3))}

    both = problem.assembler.nodal_loads(ones("fabric") | ones("edge"))
    separate = problem.assembler.nodal_loads(ones("fabric")) + problem.assembler.nodal_loads(ones("edge"))
    assert both == pytest.approx(separate, rel=1e-13, abs=1e-15)
    assert not problem.assembler.nodal_loads({}).any()


def test_held_components_close_their_gap_in_one_step(structure):
    prescribed, at = state(5, 0.1), state(1, 0.05)
    problem = Problem(MIXED).under(Actions(np.zeros(POINTS.shape), structure.supported, prescribed))
    discretization = problem.discretization
    A, b, x = discretization.create_matrix(), discretization.create_vector(), discretization.to_petsc(at)
    problem.residual(x, b)
    problem.constraints.constrain_residual(x, b)
    held, gap = structure.supported, at - prescribed
    assert discretization.to_numpy(b)[held] == pytest.approx(problem.magnitudes.stiffness * gap[held], rel=1e-13)

    free_forces = residual(problem, at)
    K_gap = discretization.create_vector()
    problem.tangent(x, A)
    A.mult(discretization.to_petsc(np.where(held, gap, 0)), K_gap)
    problem.constraints.constrain_tangent(x, A, b)
    expected = np.where(held, problem.magnitudes.stiffness * gap, free_forces - discretization.to_numpy(K_gap))
    assert discretization.to_numpy(b) == pytest.approx(expected, abs=1e-13 * np.abs(expected).max())
    dx = np.where(held, gap, 0)  # a vector that moves held components only is not coupled to the others
    A.mult(discretization.to_petsc(dx), b)
    assert discretization.to_numpy(b) == pytest.approx(
        problem.magnitudes.stiffness * dx, abs=1e-13 * np.abs(expected).max()
    )


def test_mass_matrix_without_mass_is_told(recwarn):
    problem = Problem(sheet())
    assert problem.mass().norm() == 0
    told = [str(warning.message) for warning in recwarn]
    assert [words.startswith("The mass matrix is zero. No part has mass; give mass=") for words in told] == (
        [True] if problem.comm.rank == 0 else []
    )
