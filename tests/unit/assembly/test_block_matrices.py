"""Block matrices hold the tangent that a general matrix holds, on one process and several."""

import numpy as np
import pytest
from petsc4py import PETSc

from fx_membrane import (
    Cable,
    Fabric,
    Mast,
    Membrane,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers import factorization

pytestmark = pytest.mark.mpi


def tent() -> Structure:
    """Membrane with a cable along its edge and a mast outside of it."""
    points, triangles = rectangle(2.0, 1.0, 5, 4)
    points = np.vstack([points, [[0.0, 0.0, -1.0]]])
    points[:, 2] += 0.1 * np.sin(points[:, 0]) + 0.05 * points[:, 1]
    edges = boundary_edges(triangles)
    middle = int(np.argmin(np.linalg.norm(points[:-1, :2], axis=1)))
    parts = {
        "fabric": Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3),
        "cable": Cable(edges, 1e6, prestress=2e3),
        "mast": Mast([[middle, len(points) - 1]], 1e7),
    }
    return Structure(
        points, parts, [Support([24, 29], "xyz"), Support([0, 5], "xy"), Support([len(points) - 1], "xyz")]
    )


def actions(problem: Problem, pressure: float):
    moved = PrescribedDisplacement([0, 5], (0.0, 0.0, 0.02))
    loads = [Pressure(pressure, "fabric")] if pressure else []
    return problem.actions_of(Stage("move", loads, [moved]))


@pytest.fixture
def problem() -> Problem:
    return Problem(tent())


@pytest.fixture
def state(problem) -> PETSc.Vec:
    return problem.to_petsc(0.01 * np.random.default_rng(1).normal(size=problem.structure.points.shape))


@pytest.mark.parametrize(("kind", "pressure"), [("sbaij", 0.0), ("baij", 0.0), ("baij", 200.0)])
def test_constrained_and_stabilized_system_is_that_of_a_general_matrix(problem, state, kind, pressure):
    view = problem.under(actions(problem, pressure))
    v = problem.to_petsc(np.random.default_rng(2).normal(size=problem.structure.points.shape))
    found = {}
    for name in ("aij", kind):
        A, b, product = problem.discretization.create_matrix(name), problem.create_vector(), problem.create_vector()
        view.residual(state, b)
        view.tangent(state, A)
        view.constraints.constrain_tangent(state, A, b)
        view.stiffen(state, A, b, 0.3)
        A.mult(v, product)
        found[name] = problem.to_numpy(product), problem.to_numpy(b)
        assert A.getInfo()["mallocs"] == 0
    for ours, expected in zip(found[kind], found["aij"], strict=True):
        assert np.allclose(ours, expected, rtol=0, atol=1e-13 * np.abs(expected).max())


def test_constraints_act_as_those_of_petsc(problem, state):
    view = problem.under(actions(problem, 200.0))
    rows, gap = view.constraints.constrained, problem.create_vector()
    gap.array[view.constraints.rows] = state.array_r[view.constraints.rows] - view.constraints.prescribed
    systems = []
    for ours in (True, False):
        A, b = view.tangent(state), view.residual(state)
        if ours:
            view.constraints.constrain_tangent(state, A, b)
        else:
            A.zeroRowsColumns(rows, diag=view.constraints.stiffness, x=gap, b=b)
        systems.append((A, b))
    (A, b), (B, c) = systems
    size = B.norm(), c.norm()
    A.axpy(-1.0, B, PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
    b.axpy(-1.0, c)
    assert A.norm() <= 1e-14 * size[0]
    assert b.norm() <= 1e-14 * size[1]


def test_upper_triangle_has_the_inertia_and_the_solution_of_a_general_matrix(problem, state):
    view, found = problem.under(), []
    for kind in ("aij", "sbaij"):
        A, b, x = problem.discretization.create_matrix(kind), view.residual(state), problem.create_vector()
        view.tangent(state, A)
        view.stiffen(state, A, b, -0.05)  # negative curvature
        ksp = PETSc.KSP().create(problem.comm)
        factorization.choose(ksp, A, symmetric=True)
        ksp.solve(b, x)
        found.append((factorization.pivots(ksp), problem.to_numpy(x)))
        ksp.destroy()
    assert found[0][0] == found[1][0]
    assert found[0][0].negative > 0
    assert np.allclose(found[1][1], found[0][1], rtol=0, atol=1e-10 * np.abs(found[0][1]).max())


@pytest.mark.parametrize("pressure", [0.0, 200.0])
def test_asymmetry_of_a_block_matrix_is_seen(problem, state, pressure):
    view = problem.under(actions(problem, pressure))
    A = view.tangent(state, problem.discretization.create_matrix("baij"))
    assert factorization.is_symmetric(view.constraints.close(A)) == (pressure == 0)
