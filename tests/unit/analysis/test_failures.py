"""Results and message after a load increment without equilibrium."""

import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DistributedLoad,
    Mast,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    UnstableStateWarning,
)
from fx_membrane.analysis.increments import LIMITS
from fx_membrane.solvers import newton
from fx_membrane.solvers.convergence import Patience
from models import LIFT, LIMIT, POINTS, SNOW, TOO_MUCH, arch, rotation, same_state, sheet

PLAIN = Newton(line_search=False)


@pytest.mark.mpi_once
@pytest.mark.parametrize("R", [np.eye(3), *map(rotation, range(4))], ids=["z=0", *(f"turned {i}" for i in range(4))])
def test_flat_membrane_without_prestress_has_no_stiffness_across(R):
    # Without the line search and its shift; see the test after this one.
    structure = sheet(prestress=0.0, points=POINTS @ R.T)
    load = DistributedLoad(R @ [0, 0, -200.0], "fabric")
    with pytest.raises(
        ConvergenceError,
        match=r"'snow'.*load factor 0\.5 \(the last.*0\).*singular.* node 6 .*prestress",
    ) as error:
        Analysis(structure, PLAIN).run([Stage("snow", [load], increments=2)])
    assert len(error.value.failed.iterations) == 1
    assert not error.value.last.displacement.any()


@pytest.mark.parametrize("R", [np.eye(3), rotation(0)], ids=["z=0", "turned"])
def test_flat_membrane_without_prestress_carries_load_all_the_same(R):
    def snow(R):
        load = DistributedLoad(R @ [0, 0, -200.0], "fabric")
        return Analysis(sheet(prestress=0.0, points=POINTS @ R.T)).run([Stage("snow", [load])])["snow"]

    flat, result = snow(np.eye(3)), snow(R)
    assert flat.displacement[12, 2] < -0.05
    assert result.reactions.sum(axis=0) == pytest.approx(R @ [0, 0, 800.0], abs=1e-9 * 800)
    assert result.equilibrium.residual <= 1e-9 * np.abs(result.reactions).max()
    largest = np.abs(flat.displacement).max()
    assert result.displacement == pytest.approx(flat.displacement @ R.T, abs=1e-9 * largest)


def test_failure_keeps_the_completed_stages_and_the_state_before(analysis):
    short = Analysis(sheet(), Newton(max_iterations=4, line_search=False))
    first = Stage("first", [DistributedLoad((0, 0, -20.0), "fabric")])
    with pytest.raises(ConvergenceError, match=r"^Stage 'snow'.*no equilibrium.*load factor") as error:
        short.run([first, Stage("other"), Stage("snow", [TOO_MUCH], [LIFT], after="first"), Stage("never")])
    failure = error.value
    expected = analysis.run([first])["first"]
    assert list(failure.results) == ["first", "other"]
    assert same_state(failure.results["first"], expected)
    assert failure.last.name == "snow"
    assert failure.last.increments == ()
    assert same_state(failure.last, expected)
    assert failure.last.equilibrium.residual <= 1e-9 * np.abs(expected.reactions).max()
    assert failure.failed.load_factor == 1 / 2**LIMITS.halvings
    assert len(failure.failed.iterations) == 5


@pytest.mark.mpi
def test_failure_in_a_later_step_keeps_the_steps_before():
    # So close to the limit load there is little stiffness left, and displacements have fewer digits than forces.
    analysis = Analysis(arch(), Newton(rtol=1e-13, max_iterations=12, line_search=False))
    with pytest.raises(ConvergenceError, match=r"\(the last.*0\.83") as error:
        analysis.run([Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], increments=8)])
    failure = error.value
    factors = [increment.load_factor for increment in failure.last.increments]
    assert factors[:6] == [0.125, 0.25, 0.375, 0.5, 0.625, 0.75]
    # The limit load lies between the last state and the failed one; both are within the shortest increment.
    assert factors[-1] < 1 / 1.2 < failure.failed.load_factor <= factors[-1] + 0.125 / 2**LIMITS.halvings
    load = factors[-1] * 1.2 * LIMIT
    part = analysis.run([Stage("push", [PointLoad(1, (0, 0, -load))], increments=6)])["push"]
    assert same_state(failure.last, part)
    assert failure.last.energy == pytest.approx(part.energy, rel=1e-12)
    assert failure.last.mast("arch").force == pytest.approx(part.mast("arch").force, rel=1e-9)
    assert failure.last.equilibrium.residual <= 1e-9 * LIMIT
    z = 0.3 + failure.last.displacement[1, 2]
    assert 1e6 * (0.3**2 - z**2) * z / 1.09**1.5 == pytest.approx(load, rel=1e-9)


def test_load_above_the_largest_snaps_through():
    load = 1.2 * LIMIT
    with pytest.warns(UnstableStateWarning, match=r"between load factors 0\.832031 and 0\.835938 .*snapped"):
        result = Analysis(arch()).run([Stage("push", [PointLoad(1, (0, 0, -load))])])["push"]
    z = 0.3 + result.displacement[1, 2]
    assert z < -0.3  # the bars are stretched
    assert 1e6 * (0.3**2 - z**2) * z / 1.09**1.5 == pytest.approx(load, rel=1e-9)


def test_failure_after_moving_supports_keeps_their_position():
    # With more iterations one of them can find the shape after the snap-through.
    analysis = Analysis(arch([Support(0), Support(1, "y")]), Newton(max_iterations=6, line_search=False))
    hold = Stage("hold", displacements=[PrescribedDisplacement(2, (0, 0, 0))])
    push = PointLoad(1, (0, 0, -1.2 * LIMIT))
    spread = PrescribedDisplacement([2], (0.01, 0, 0))
    with pytest.raises(ConvergenceError) as error:
        analysis.run([hold, Stage("push", [push], [spread], increments=8, after="hold")])
    last = error.value.last
    factor = last.increments[-1].load_factor
    assert 0 < factor < 1
    assert last.displacement[2] == pytest.approx([factor * 0.01, 0, 0], rel=1e-14)
    assert last.loads[1, 2] == pytest.approx(-factor * 1.2 * LIMIT)
    assert last.equilibrium.residual <= 1e-9 * LIMIT


@pytest.mark.mpi
def test_analysis_can_go_on_after_a_failure(analysis):
    short = Analysis(sheet(), Newton(max_iterations=4, line_search=False))
    mild = [Stage("mild", [DistributedLoad((0, 0, -20.0), "fabric")])]
    with pytest.raises(ConvergenceError):
        short.run([Stage("snow", [TOO_MUCH], [LIFT])])
    assert same_state(short.run(mild)["mild"], analysis.run(mild)["mild"])


def test_bad_stage_is_refused_before_anything_is_solved():
    short = Analysis(sheet(), Newton(max_iterations=1, line_search=False))  # would fail in the first stage
    with pytest.raises(ValueError, match="node 99"):
        short.run([Stage("snow", [SNOW]), Stage("wind", [PointLoad(99, (0, 0, 1))])])


@pytest.mark.mpi_once
@pytest.mark.parametrize("masts", [2, 4])
def test_frame_that_sways_is_given_up_after_one_try(masts, monkeypatch):
    """Hinged masts with cables between their tops: pushed aside they fall, at every load."""
    feet = np.array([[0.0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0]])[:masts]
    tops = np.arange(masts, 2 * masts)
    ties = np.column_stack([tops, np.roll(tops, -1)])[: 1 if masts == 2 else 4]
    parts = {
        "masts": Mast(np.column_stack([np.arange(masts), tops]), 1e6),
        "ties": Cable(ties, 1e5, prestress=0.0 if masts == 2 else 100.0),
    }
    supports = [Support(range(masts)), *([Support(tops, "y")] if masts == 2 else [])]
    structure = Structure(np.vstack([feet, np.add(feet, [0, 0, 3.0])]), parts, supports)
    monkeypatch.setattr(newton, "stabilized_start", lambda *_: pytest.fail("is of no use here"))
    with pytest.raises(ConvergenceError, match=r"structure.*mechanism: node \d moves freely") as error:
        Analysis(structure).run([Stage("push", [PointLoad(masts, (10.0, 0, 0))])])
    motion = error.value.motion
    assert np.linalg.norm(motion, axis=1).max() == pytest.approx(1)
    assert motion[:masts] == pytest.approx(0)  # the feet
    # Lengths are constant to first order.
    for part in parts.values():
        ends = structure.points[part.cells], motion[part.cells]
        along, apart = (np.diff(end, axis=1)[:, 0] for end in ends)
        np.testing.assert_allclose(np.sum(along * apart, axis=1), 0, rtol=0, atol=1e-6)
    assert error.value.failed.load_factor == 1
    assert len(error.value.failed.iterations) == 1 + Patience().usual(Newton().max_iterations)


@pytest.mark.mpi
def test_column_that_falls_over_is_reported():
    column = Mast([[0, 1], [1, 2]], 1e6)
    supports = [Support(0), Support(2, "xy"), Support(1, "y")]
    structure = Structure([[0, 0, 0], [0, 0, 1.0], [0, 0, 2.0]], {"column": column}, supports)
    with pytest.warns(UnstableStateWarning, match=r"moved by .*fallen"):
        Analysis(structure).run([Stage("load", [PointLoad(2, (0, 0, -100.0))])])


def test_soft_cable_that_is_stretched_far_is_reported_once():
    points = np.linspace([0.0, 0, 0], [4, 0, 0], 9)
    rope = Cable(np.column_stack([range(8), range(1, 9)]), 1e3)
    structure = Structure(points, {"rope": rope}, [Support([0, 8])])
    stage = Stage("weight", [DistributedLoad((0, 0, -1e7), "rope")], increments=4)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        result = Analysis(structure).run([stage])["weight"]
    said = [str(entry.message) for entry in caught if entry.category is UnstableStateWarning]
    assert len(result.increments) == 4  # it moves by more than 2 in each
    assert len(said) == 1
    for fact in ("load factor 1 ", "node 4", "hung down", "units", "stiffness"):
        assert fact in said[0]
