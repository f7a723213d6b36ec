"""Sentences on failures: the node, the direction, the remedy."""

import re

import numpy as np
import pytest
from mpi4py import MPI
from petsc4py import PETSc

from fx_membrane import Cable, Fabric, Mast, Membrane, Rope, Structure, Support
from fx_membrane.assembly.actions import Actions
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.base import max_norm
from fx_membrane.solvers.diagnosis import (
    linear_failure,
    loose_nodes,
    mechanism,
    slack_mechanism,
    stagnation_message,
    swung_masts,
    unlikely_units,
)
from models import EDGE, POINTS, TRIANGLES, rotation
from models import sheet as square

INSIDE = np.setdiff1d(np.arange(25), EDGE)


def first_tangent(structure):
    problem = Problem(structure).under()
    A, b, x = (make() for make in [problem.discretization.create_matrix] + 2 * [problem.discretization.create_vector])
    problem.tangent(x, A)
    problem.constraints.constrain_tangent(x, A, b)
    return problem, A


def sheet(prestress, points=POINTS):
    return square(prestress=prestress, points=points)


@pytest.mark.mpi_once
@pytest.mark.parametrize("R", [np.eye(3), rotation(1), rotation(2)], ids=["z=0", "turned 1", "turned 2"])
def test_flat_sheet_without_prestress_is_loose_across(R):
    loose = loose_nodes(*first_tangent(sheet(0.0, POINTS @ R.T)))
    assert [node for node, _ in loose] == INSIDE.tolist()
    for _, direction in loose:
        assert abs(np.dot(direction, R[:, 2])) == pytest.approx(1, rel=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize("R", [np.eye(3), rotation(1)], ids=["z=0", "turned"])
@pytest.mark.parametrize("prestress", [1.0, 1e3])
def test_sheet_with_prestress_is_not_loose(R, prestress):
    assert loose_nodes(*first_tangent(sheet(prestress, POINTS @ R.T))) == []


@pytest.mark.mpi
def test_linear_failure_names_node_direction_and_prestress():
    message = linear_failure(*first_tangent(sheet(0.0)))
    assert "singular" in message
    assert rf"node {INSIDE[0]} (and {len(INSIDE) - 1} more nodes) in the direction (0, 0, 1)" in message
    assert "small prestress" in message


def test_linear_failure_of_one_node():
    points = np.linspace([0.0, 0, 0], [2, 0, 0], 3)
    structure = Structure(points, {"cable": Cable([[0, 1], [1, 2]], 1e6)}, [Support([0, 2]), Support(1, "y")])
    message = linear_failure(*first_tangent(structure))
    assert "node 1 in the direction (0, 0, 1)" in message
    assert "straight cable without prestress" in message
    assert "membrane" not in message


def test_linear_failure_of_masts_in_line_tells_of_no_membrane():
    parts = {"strut": Mast([[0, 1], [1, 2]], 1e6), "cable": Cable([[0, 2]], 1e6)}  # the cable is elsewhere
    structure = Structure(np.linspace([0.0, 0, 0], [2, 0, 0], 3), parts, [Support([0, 2])])
    message = linear_failure(*first_tangent(structure))
    assert "node 1 in the direction" in message
    assert "masts in line" in message
    assert "prestress" not in message


def test_linear_failure_of_a_rope_tells_that_it_slides():
    line = Structure([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], {"rope": Rope([0, 1, 2], 1e6)}, [Support([0, 2])])
    message = linear_failure(*first_tangent(line))
    assert "node 1" in message
    assert "A straight rope without prestress" in message
    assert "slides" in message


def test_linear_failure_where_membrane_and_cable_meet():
    sheet_and_cable = {"fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3)), "cable": Cable([[11, 12], [12, 13]], 1e6)}
    message = linear_failure(*first_tangent(Structure(POINTS, sheet_and_cable, [Support(np.delete(range(25), 12))])))
    assert re.search(r"node 12 in the direction \(0, 0, 1\).*membrane.*cable", message)


def test_linear_failure_of_a_mechanism_without_a_loose_node():
    points = [[0.0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]  # a frame of three hinged bars, held in its plane
    structure = Structure(
        points, {"frame": Mast([[0, 1], [1, 2], [2, 3]], 1e6)}, [Support([0, 3]), Support([1, 2], "z")]
    )
    problem, A = first_tangent(structure)
    assert loose_nodes(problem, A) == []
    assert "mechanism" in linear_failure(problem, A)


def lifted(height):
    """Solve with a prescribed displacement of one corner alone."""
    displacement = np.zeros(POINTS.shape)
    displacement[0, 2] = height
    return Actions(np.zeros(POINTS.shape), sheet(1e3).supported, displacement)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("displacement", "words"),
    [
        (0.1, "unbalanced force is still 2.5"),
        (1e6, "1e+06 in a structure of size 2"),
        (np.nan, "diverged"),
    ],
)
def test_stalled(displacement, words):
    problem = Problem(sheet(1e3)).under(lifted(1e-3))
    x = problem.discretization.to_petsc(np.full(POINTS.shape, displacement))
    message = stagnation_message(problem, x, iterations=30, residual=2.5, at_rounding=False)
    assert words in message
    assert "more increments" in message


def test_more_steps_are_not_advised_where_nothing_is_applied():
    owner = Problem(sheet(1e3))
    problem = owner.under(lifted(0.0))
    x, A = problem.discretization.create_vector(), problem.discretization.create_matrix()
    message = stagnation_message(problem, x, iterations=30, residual=2.5, at_rounding=False)
    assert "the loads in more increments" not in message
    assert "nothing is applied" in message
    assert "force_density" in message
    problem.tangent(x, A)
    assert "increment" not in linear_failure(problem, A)
    assert "increment" in linear_failure(owner.under(lifted(1e-3)), A)


def test_stalled_at_rounding_advises_another_tolerance():
    problem = Problem(sheet(1e3)).under()
    message = stagnation_message(
        problem, problem.discretization.create_vector(), iterations=30, residual=1e-9, at_rounding=True
    )
    assert "Newton(rtol=...)" in message
    assert "increment" not in message


@pytest.mark.mpi
@pytest.mark.parametrize("process", range(3))
def test_every_process_sees_what_is_not_a_number_on_one(process):
    comm = MPI.COMM_WORLD
    vector = PETSc.Vec().createMPI((2, PETSc.DECIDE), comm=comm)
    vector.array[:] = -1.0 - comm.rank
    assert max_norm(vector) == comm.size
    vector.array[0] = np.nan if comm.rank == process % comm.size else 0.0
    assert all(comm.allgather(np.isnan(max_norm(vector))))


@pytest.mark.mpi
def test_mechanism_names_the_node_that_moves_and_where():
    points = [[0.0, 0, 0], [0, 1, 0], [1, 1, 0], [1, 0, 0]]
    frame = Structure(points, {"frame": Mast([[0, 1], [1, 2], [2, 3]], 1e6)}, [Support([0, 3]), Support([1, 2], "z")])
    problem = Problem(frame).under()
    found = mechanism(problem, problem.discretization.create_vector())
    assert found is not None
    motion, words = found
    assert "node 1 moves freely" in words or "node 2 moves freely" in words
    assert "1 more node" in words
    np.testing.assert_allclose(np.abs(motion), [[0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0]], rtol=0, atol=1e-9)


def test_mast_that_slack_cables_hold_is_a_mechanism_but_for_them():
    points = [[0.0, 0, 0], [0, 0, 4], [3, 0, 0], [-2, 2, 0], [-2, -2, 0]]
    for prestress, free in ((-1e4, True), (1e3, False)):
        parts = {"mast": Mast([[0, 1]], 2e8), "guys": Cable([[1, 2], [1, 3], [1, 4]], 12e6, prestress)}
        problem = Problem(Structure(points, parts, [Support([0, 2, 3, 4])])).under()
        x = problem.discretization.create_vector()
        assert mechanism(problem, x) is None
        found = slack_mechanism(problem, x)
        assert (found is not None) == free
        if found:
            assert re.search("mechanism.*slack.*node 1 ", found.words)
            assert np.abs(found.motion[1, 2]) < 1e-6


@pytest.mark.mpi
def test_mast_beside_slack_fabric_that_is_softer_is_found():
    points = [*POINTS, [9.0, 0, 0], [9, 0, 4], [12, 0, 0], [7, 2, 0], [7, -2, 0]]
    fabric = Membrane(TRIANGLES, Fabric(1e5, 0.3), prestress=-10.0)
    guys = Cable([[26, 27], [26, 28], [26, 29]], 12e6, -1e3)
    parts = {"fabric": fabric, "pole": Mast([[25, 26]], 2e8), "guys": guys}
    problem = Problem(Structure(points, parts, [Support([*EDGE, 25, 27, 28, 29])])).under()
    found = slack_mechanism(problem, problem.discretization.create_vector())
    assert found is not None
    assert "node 26 moves freely" in found.words
    assert "mast 'pole' (cell 0) by the tension of 'guys': no load is safe" in found.words


@pytest.mark.mpi_once
@pytest.mark.parametrize(("angle", "said"), [(0.4, False), (0.6, True), (2.5, True)])
def test_mast_that_has_turned_far_is_named(angle, said):
    points = [[0.0, 0, 0], [0, 0, 4], [3, 0, 0], [5, 0, 0], [5, 0, 2]]
    parts = {"pole": Mast([[3, 4], [0, 1]], 2e8), "guy": Cable([[1, 2], [4, 2]], 12e6)}
    problem = Problem(Structure(points, parts, [Support([0, 2, 3])])).under()
    moved = np.zeros((5, 3))
    moved[1] = 4 * np.sin(angle), 0, 4 * np.cos(angle) - 4
    words = swung_masts(problem, problem.discretization.to_petsc(moved), 0.5, "tried")
    assert bool(words) == said
    if said:
        assert f"mast 'pole' (cell 1, at node 1) has turned by {np.degrees(angle):.3g} degrees in the" in words


def test_slack_fabric_is_no_mechanism():
    problem = Problem(sheet(0.0)).under()
    assert slack_mechanism(problem, problem.discretization.to_petsc(-0.01 * POINTS)) is None


def test_taut_sheet_is_no_mechanism():
    problem = Problem(sheet(1e3)).under()
    assert mechanism(problem, problem.discretization.create_vector()) is None


@pytest.mark.parametrize(("load", "said"), [(1e3, False), (1e9, True)])
def test_loads_out_of_proportion_point_to_the_units(load, said):
    structure = sheet(1e3)
    loads = np.zeros(POINTS.shape)
    loads[12, 2] = load
    problem = Problem(structure).under(Actions(loads, structure.supported, np.zeros(POINTS.shape)))
    words = unlikely_units(problem, problem.discretization.create_vector())
    share = load / (problem.magnitudes.stiffness * structure.size)
    assert bool(words) == said == (f" {share:.2g} " in words)
