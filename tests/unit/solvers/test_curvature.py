"""The lowest mode of a state, and the test of stability."""

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane import Cable, Fabric, Mast, Membrane, Structure, Support
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.curvature import MODES, lowest_mode, negative_curvature_direction
from models import EDGE, POINTS, TRIANGLES


def sheet(prestress, **data):
    membrane = Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3), prestress=prestress, **data)
    return Structure(POINTS, {"fabric": membrane}, [Support(EDGE)])


def frame():
    """Three hinged bars in a row, held in their plane: they sway."""
    points = [[0.0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]
    bars = Mast([[0, 1], [1, 2], [2, 3]], 1e6)
    return Structure(points, {"frame": bars}, [Support([0, 3]), Support([1, 2], "z")])


def found(structure, tension=MODES.free, displacement=None):
    problem = Problem(structure).under()
    x = problem.discretization.create_vector()
    if displacement is not None:
        problem.discretization.to_petsc(displacement).copy(x)
    result = lowest_mode(problem, x, tension)
    return result, problem.discretization.to_numpy(result.motion)


@pytest.mark.mpi
def test_frame_sways_to_the_side():
    result, motion = found(frame())
    assert abs(result.stiffness) < MODES.free
    assert motion[1] == pytest.approx(motion[2], abs=1e-7)
    assert np.abs(motion[1]) == pytest.approx([0.5**0.5, 0, 0], abs=1e-7)
    assert not motion[[0, 3]].any()


def test_lowest_mode_of_a_taut_sheet_is_across():
    # T has Et in place of the prestress N: a motion across has the stiffness N / Et.
    result, motion = found(sheet(1e3))
    assert result.negative == 0
    assert result.stiffness == pytest.approx(1e3 / 1e5, rel=1e-9)
    assert np.linalg.norm(motion[:, 2]) == pytest.approx(1, abs=1e-6)


@pytest.mark.mpi
def test_compressed_mast_in_the_middle_of_a_weak_cable_is_unstable():
    # Two struts in a row under 10 N, held across by nothing: each direction across is negative.
    struts = Mast([[0, 1], [1, 2]], 1e6, prestress=-10.0)
    structure = Structure([[0, 0, 0], [1, 0, 0], [2, 0, 0]], {"struts": struts}, [Support([0, 2])])
    result, motion = found(structure)
    assert result.negative == 2
    assert result.stiffness == pytest.approx(-10 / 1e6, rel=1e-6)
    assert abs(motion[1, 0]) < 1e-6


def dense(problem, A):
    """Entries of a matrix for the free components, in the user's order."""
    discretization = problem.discretization
    b, free = discretization.create_vector(), ~discretization.structure.supported
    columns = []
    for component in np.flatnonzero(free):
        unit = np.zeros(free.shape)
        unit.flat[component] = 1.0
        A.mult(discretization.to_petsc(unit), b)
        columns.append(discretization.to_numpy(b)[free])
    return np.stack(columns, axis=1)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("held", "negative"), [([0, 4, 20, 24], 0), (EDGE[POINTS[EDGE, 0] < -0.9], 1)], ids=["corners", "one side"]
)
def test_pressure_counts_by_its_symmetric_part(held, negative):
    # Pressure forces at free edges make the tangent A unsymmetric. Its own eigenvalues are positive in both cases; of
    # its lower triangle alone, which a factorization might read, one is negative in both.
    structure = Structure(POINTS, sheet(1e3).parts, [Support(held)])
    zero = np.zeros(POINTS.shape)
    actions = Actions(zero, structure.supported, zero, {"fabric": np.full(len(TRIANGLES), 1.2e4)})
    problem = Problem(structure).under(actions)
    x = problem.discretization.create_vector()
    result = lowest_mode(problem, x, 0.0)
    A, T = dense(problem, problem.tangent(x)), dense(problem, problem.stabilizer.matrix("aij"))
    symmetric, free = (A + A.T) / 2, ~structure.supported
    eigenvalues = np.linalg.eigvalsh(symmetric)
    assert np.count_nonzero(eigenvalues < 0) == negative == result.negative
    v = np.random.default_rng(0).normal(size=free.shape)[free]
    for _ in range(MODES.steps):  # inverse iteration
        v = np.linalg.solve(symmetric, v)
        v /= np.linalg.norm(v)
    np.testing.assert_allclose(problem.discretization.to_numpy(result.motion)[free], v, rtol=0, atol=1e-9)
    assert result.stiffness == pytest.approx(v @ symmetric @ v / (v @ T @ v), rel=1e-9)
    assert v @ symmetric @ v == pytest.approx(np.abs(eigenvalues).min(), rel=1e-4)
    assert (np.linalg.eigvals(A).real > 0).all()
    lower = np.tril(A) + np.tril(A, -1).T
    assert np.count_nonzero(np.linalg.eigvalsh(lower) < 0) == 1


def test_ripples_are_no_instability():
    """Edges moved in by 1 % buckle a sheet: the compression stiffness of slack cells has negative curvature."""
    problem = Problem(sheet(0.0)).under()
    x = problem.discretization.to_petsc(-0.01 * POINTS)
    assert lowest_mode(problem, x, MODES.free).negative > 0
    assert negative_curvature_direction(problem, x).negative == 0
    full = Problem(sheet(0.0, compression_stiffness=1.0)).under()
    assert negative_curvature_direction(full, x).negative > 0


@pytest.mark.mpi_once
@pytest.mark.parametrize("kept", [1e-6, 1e-4, 1.0])
@pytest.mark.parametrize(("load", "negative"), [(-100.0, 0), (100.0, 1)])
def test_mast_between_two_stays_stands_by_uplift_only(load, negative, kept):
    """Out of the plane of its stays, a mast of length L under the load Q has the stiffness -Q / L.

    The compression stiffness of the stays has no influence: they are not slack.
    """
    stays = Cable([[1, 2], [1, 3]], 1e7, prestress=1e4, compression_stiffness=kept)
    mast = Mast([[0, 1]], 1e9, prestress=-(2e4 / 2**0.5 + load))
    points = [[0.0, 0, 0], [0, 0, 4], [4, 0, 0], [-4, 0, 0]]
    problem = Problem(Structure(points, {"mast": mast, "stays": stays}, [Support([0, 2, 3])])).under()
    result = negative_curvature_direction(problem, problem.discretization.create_vector())
    assert result.negative == negative
    motion = problem.discretization.to_numpy(result.motion)
    assert np.abs(motion[1]) == pytest.approx([0, 1, 0], abs=1e-6)
    assert result.stiffness * problem.stabilizer.work(result.motion) == pytest.approx(-load / 4, rel=1e-6)


@pytest.mark.mpi
def test_the_motion_downhill_is_the_steepest_of_several():
    # Chains of struts of 1 m under 10 and 30 N: their middles give way, the second with three times the curvature.
    points = [[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
    struts = Mast([[0, 1], [1, 2], [3, 4], [4, 5]], 1e6, prestress=[-10.0, -10.0, -30.0, -30.0])
    problem = Problem(Structure(points, {"struts": struts}, [Support([0, 2, 3, 5])])).under()
    result = negative_curvature_direction(problem, problem.discretization.create_vector())
    assert result.negative == 4
    assert result.stiffness == pytest.approx(-30 / 1e6, rel=1e-9)
    motion = problem.discretization.to_numpy(result.motion)
    assert np.linalg.norm(motion[4]) == pytest.approx(1, abs=1e-9)
    assert motion[4, 0] == pytest.approx(0, abs=1e-9)


@pytest.mark.mpi
@pytest.mark.parametrize("count", [3, 12])
def test_direction_of_a_double_mode_is_the_same_on_any_number_of_processes(count):
    """A straight strut buckles to any side, in a lowest mode of many that are negative."""
    x = np.linspace(0, 1, count + 1)
    points = np.column_stack([x, 0 * x, 0 * x])
    strut = Mast(np.column_stack([np.arange(count), np.arange(1, count + 1)]), 1e6, prestress=-1e4)
    structure = Structure(points, {"strut": strut}, [Support([0, count])])
    motions = []
    for comm in (MPI.COMM_WORLD, MPI.COMM_SELF):
        problem = Problem(structure, comm).under()
        result = negative_curvature_direction(problem, problem.discretization.create_vector())
        assert result.negative == 2 * (count - 1)
        assert result.stiffness == pytest.approx(-1e-2, rel=1e-9)
        motions.append(problem.discretization.to_numpy(result.motion))
    assert np.abs(motions[0][:, 1:]).max(axis=0).min() > 1e-3
    np.testing.assert_allclose(motions[0], motions[1], rtol=0, atol=1e-6)


def test_direction_takes_few_factorizations():
    """Of a chain of struts with a curvature far from zero: a count of pivots, a search for the value, the direction."""
    points = np.column_stack([np.linspace(0, 1, 9), np.zeros((9, 2))])
    strut = Mast(np.column_stack([np.arange(8), np.arange(1, 9)]), 1e6, prestress=-1e4)
    problem = Problem(Structure(points, {"strut": strut}, [Support([0, 8])])).under()
    PETSc.Log.begin()
    event = PETSc.Log.Event("MatCholFctrNum")
    before = event.getPerfInfo()["count"]
    negative_curvature_direction(problem, problem.discretization.create_vector())
    assert event.getPerfInfo()["count"] - before <= 8  # shifts that grow fourfold from 1e-9 would take 13
