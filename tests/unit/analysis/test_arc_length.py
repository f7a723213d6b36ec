"""Equilibrium paths: starts, ends, and results after a failure."""

import re
import warnings

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    LargeStrainWarning,
    Mast,
    Newton,
    PathError,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    UnstableStateWarning,
    equilibrium_path,
    stability,
)
from fx_membrane.analysis.step_control import StepControl
from fx_membrane.solvers.bordered_newton import BorderedNewton
from models import LIFT, LIMIT, SNOW, arch, close, inclined_sheet, same_state, sheet

PUSH = Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], increments=8)
PART = Pressure(400.0, "fabric", range(9))  # not uniform: it has no potential


@pytest.mark.mpi
@pytest.mark.parametrize(
    "loads",
    [([SNOW], []), ([Pressure(400.0, "fabric")], []), ([PART], []), ([SNOW, PART], [LIFT]), ([], [LIFT])],
    ids=["fixed direction", "pressure", "pressure without potential", "all", "displacement"],
)
def test_ends_where_an_analysis_does(loads):
    structure, stage = inclined_sheet(), Stage("load", loads[0], loads[1], increments=3, after="rest")
    rest = Stage("rest")
    results = Analysis(structure, Newton(rtol=1e-13)).run([rest, stage])
    path = equilibrium_path(results["rest"], stage, rtol=1e-13)
    assert path.complete
    assert same_state(path.state(-1), results["load"])
    assert np.array_equal(path.points[0].displacement, results["rest"].displacement)
    assert (path.negative_pivots is None) == (PART in loads[0])


def test_goes_on_from_a_loaded_state_and_keeps_its_loads():
    structure = inclined_sheet()
    first = Stage("first", [SNOW, PART], [LIFT])
    wind = DistributedLoad((30.0, 0, 250.0), "fabric")
    second = Stage("second", [wind], increments=2, after="first")
    results = Analysis(structure, Newton(rtol=1e-13)).run([first, second])
    path = equilibrium_path(results["first"], second, rtol=1e-13)
    assert same_state(path.state(0), results["first"])
    assert close(path.state(-1).displacement, results["second"].displacement)


@pytest.mark.mpi
def test_same_path_on_any_number_of_processes():
    stage = Stage("air", [Pressure(400.0, "fabric"), SNOW], increments=5, after="rest")
    paths = []
    for comm in (MPI.COMM_WORLD, MPI.COMM_SELF):
        start = Analysis(inclined_sheet(), comm=comm).run([Stage("rest")])["rest"]
        paths.append(equilibrium_path(start, stage, comm=comm))
    together, alone = paths
    assert np.array_equal(together.negative_pivots, alone.negative_pivots)
    assert together.load_factors == pytest.approx(alone.load_factors, rel=1e-9)
    assert close(together.displacements, alone.displacements)
    every = MPI.COMM_WORLD.allgather(together.displacements)
    assert all(np.array_equal(other, together.displacements) for other in every)
    assert close(together.state(-1).reactions, alone.state(-1, MPI.COMM_SELF).reactions)


@pytest.mark.mpi
def test_negative_pivots_are_negative_eigenvalues():
    path = equilibrium_path(arch(), PUSH)
    assert set(path.negative_pivots) == {0, 1}
    for number in range(0, len(path.points), 5):
        assert stability(path.state(number)).negative == path.negative_pivots[number]


def test_steps_are_the_largest_change_of_the_load_factor():
    changes = np.abs(np.diff(equilibrium_path(arch(), PUSH).load_factors))
    assert changes[0] == pytest.approx(1 / 8, rel=0.1)
    assert changes.max() <= 1.5 / 8


@pytest.mark.parametrize("value", [0.0, -1e-300, 1e-300])
def test_a_displacement_at_the_start_is_no_end_there(value):
    path = equilibrium_path(arch(), PUSH, None, (1, "z", value), max_points=4)
    assert len(path.points) == 4
    assert not path.complete


@pytest.mark.mpi
def test_a_limit_point_is_the_last_point_allowed():
    found = equilibrium_path(arch(), PUSH).limit_points[0]
    path = equilibrium_path(arch(), PUSH, max_points=found + 1)
    assert path.limit_points.tolist() == [found]


def test_ends_with_the_last_point_allowed():
    path = equilibrium_path(arch(), PUSH, max_points=6)
    assert len(path.points) == 6
    assert not path.complete
    factors = path.load_factors
    assert re.search(
        rf"6 points.*max_points.*load factor {factors[-1]:.6g};.* 0 and {factors.max():.6g}\.", path.reason
    )
    assert repr(path) == f"EquilibriumPath('push', 6 points, load factor {path.load_factors[-1]:.4g}, complete=False)"


@pytest.mark.mpi
def test_ends_at_what_comes_first():
    both = equilibrium_path(arch(), PUSH, 0.5, (1, "z", -0.2))
    assert both.load_factors[-1] == pytest.approx(0.5, rel=1e-15)
    assert both.displacements[-1, 1, 2] > -0.2
    both = equilibrium_path(arch(), PUSH, 0.5, (1, "z", -0.01))
    assert both.displacements[-1, 1, 2] == pytest.approx(-0.01, rel=1e-12)
    assert both.load_factors[-1] < 0.5


def test_ends_just_before_a_limit_point():
    """Passed twice within a step, there and back."""
    path = equilibrium_path(arch(), PUSH, 0.9999 / 1.2)
    assert path.load_factors[-1] == pytest.approx(0.9999 / 1.2, rel=1e-15)
    assert (np.diff(path.load_factors) > 0).all()
    assert path.complete
    assert path.reason == "complete"


def test_a_coarse_path_does_not_miss_the_limit_points():
    path = equilibrium_path(arch(), Stage("push", PUSH.loads))
    assert len(path.limit_points) == 2
    assert 1 in path.negative_pivots


def test_cables_that_slacken():
    """A kink: two stays hold a node, and a load across slackens one of them."""
    parts = {"stays": Cable([[0, 1], [1, 2]], 1e5, 100.0), "spring": Cable([[1, 3]], 1e3, 1.0)}
    points = [[-1.0, 0, 0], [0, 0, 0], [1, 0, 0], [0, 1, 0]]
    structure = Structure(points, parts, [Support([0, 2, 3]), Support(1, "z")])
    pull = Stage("pull", [PointLoad(1, (500.0, 0, 0))], increments=4, after="rest")
    expected = Analysis(structure, Newton(rtol=1e-13)).run([Stage("rest"), pull])
    path = equilibrium_path(expected["rest"], pull, rtol=1e-13)
    last = path.state(-1)
    assert path.complete
    assert last.cable("stays").slack.tolist() == [False, True]
    assert close(last.displacement, expected["pull"].displacement)
    assert len(path.points) <= 6  # no step is rejected for the kink


@pytest.mark.mpi
def test_start_that_is_not_stable_is_reported():
    """Masts in line, pressed together by a spring force, held across by a cable that is too soft."""
    parts = {"column": Mast([[0, 1], [1, 2]], 1e6, prestress=-1e3), "stay": Cable([[1, 3]], 1e3, prestress=1e-3)}
    points = [[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0]]
    structure = Structure(points, parts, [Support([0, 2, 3]), Support(1, "z")])
    stage = Stage("push", [PointLoad(1, (0, 1.0, 0))], increments=4)
    with pytest.warns(UnstableStateWarning, match=r"'push' starts from .* not stable \(negative pivots: 1\)") as found:
        path = equilibrium_path(structure, stage, max_points=2)
    assert path.negative_pivots[0] == 1
    assert [entry.filename for entry in found] == [__file__, __file__]
    assert "mast 'column' (cell 0, at node 1) is not held" in str(found[1].message)  # at the points of the path


def test_stable_start_is_not_reported():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        equilibrium_path(arch(), PUSH, max_points=2)
        equilibrium_path(inclined_sheet(), Stage("load", [SNOW]), max_points=2)


def test_prestress_beyond_the_material_law_is_reported():
    if MPI.COMM_WORLD.rank:  # the first process warns for all
        equilibrium_path(sheet(prestress=1e6), Stage("load", [SNOW]), max_points=2)
        return
    with pytest.warns(LargeStrainWarning, match="^Part 'fabric' is prestressed by") as found:
        equilibrium_path(sheet(prestress=1e6), Stage("load", [SNOW]), max_points=2)
    assert found[0].filename == __file__


@pytest.mark.mpi
def test_path_that_is_lost_is_kept(monkeypatch):
    find, calls = BorderedNewton.find, []

    def only_some(self, guess, plane):
        calls.append(guess)
        return find(self, guess, plane) if len(calls) < 5 else None

    monkeypatch.setattr(BorderedNewton, "find", only_some)
    with pytest.raises(PathError, match=r"'push'.*lost after 4 points.*load factor 0\.36.*increments") as error:
        equilibrium_path(arch(), PUSH)
    path = error.value.path
    assert len(calls) == 4 + StepControl().halvings + 1
    assert len(path.points) == 4
    assert path.state(-1).equilibrium.residual < 1e-8 * LIMIT
    assert not path.complete
    assert path.reason == str(error.value)


@pytest.mark.mpi
def test_factorizations_are_one_for_each_iteration_and_one_for_each_point(monkeypatch):
    """The tangent of a point gives its pivots and the direction to the next one."""
    count = []
    linearize = BorderedNewton.linearize
    monkeypatch.setattr(BorderedNewton, "linearize", lambda *args: count.append(1) or linearize(*args))
    path = equilibrium_path(arch(), Stage("push", PUSH.loads, increments=40), 0.5, max_points=10)
    iterations = sum(len(point.iterations) - 1 for point in path.points)
    assert len(count) == iterations + len(path.points)


def test_ends_where_a_component_is_that_the_stage_moves():
    drive = Stage("drive", displacements=[PrescribedDisplacement(1, (0, 0, -0.6), "z")], increments=5)
    path = equilibrium_path(arch(), drive, displacement=(1, "z", -0.45))
    assert path.complete
    assert path.load_factors[-1] == pytest.approx(0.75, rel=1e-13)


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [7, 10, 16])  # with 7 and 10 the sum is one up to rounding
def test_last_point_comes_once(steps):
    drive = Stage("drive", displacements=[PrescribedDisplacement(1, (0, 0, -0.6), "z")], increments=steps)
    path = equilibrium_path(arch(), drive)
    assert path.complete
    assert path.load_factors == pytest.approx(np.arange(steps + 1) / steps, abs=1e-14)
    assert path.load_factors[-1] == 1.0


@pytest.mark.mpi
def test_displacement_driven_stage_holds_what_it_moves():
    drive = Stage("drive", displacements=[PrescribedDisplacement(1, (0, 0, -0.6), "z")], increments=5)
    path = equilibrium_path(arch(), drive)
    assert path.displacements[:, 1, 2] == pytest.approx(-0.6 * path.load_factors, rel=1e-13)
    reactions = [path.state(number).reactions[1, 2] for number in range(len(path.points))]
    z = 0.3 + path.displacements[:, 1, 2]
    assert -np.array(reactions) == pytest.approx(1e6 * z * (0.3**2 - z**2) / 1.09**1.5, abs=1e-9 * LIMIT)
    assert (path.negative_pivots == 0).all()
