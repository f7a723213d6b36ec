"""Stages: kept loads, shared states, starts; supports and loads."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
)
from models import CENTRE, EDGE, FABRIC, LIFT, POINTS, SNOW, TRIANGLES, WIND, close, same_state, sheet

# Supports


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    "structure",
    [
        Structure(POINTS, {"fabric": Membrane(TRIANGLES, FABRIC, 1e3)}),
        sheet(Support(range(25), "z")),
        sheet(Support(CENTRE)),
        Structure(
            np.vstack([POINTS, POINTS + np.array([0, 0, 1])]),
            {"low": Membrane(TRIANGLES, FABRIC, 1e3), "high": Membrane(TRIANGLES + 25, FABRIC, 1e3)},
            [Support(EDGE)],
        ),
    ],
    ids=["no support", "only z held", "one node pinned", "one of two pieces unsupported"],
)
def test_structure_without_enough_supports(structure):
    with pytest.raises(ValueError, match=r"not supported enough.*piece.*node \d+ \(25 nodes: Membrane '\w+'\)"):
        Analysis(structure).run([Stage("rest")])


@pytest.mark.mpi
def test_piece_without_supports_is_named():
    points = np.vstack([POINTS, POINTS + np.array([0, 0, 1])])
    parts = {"low": Membrane(TRIANGLES, FABRIC, 1e3), "high": Membrane(TRIANGLES + 25, FABRIC, 1e3)}
    with pytest.raises(ValueError, match=r"piece.*node 25 \(25 nodes: Membrane 'high'\)"):
        Analysis(Structure(points, parts, [Support(EDGE)])).run([Stage("rest")])


def test_cable_pinned_at_both_ends_carries_a_load_across():
    structure = Structure(
        [[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], {"cable": Cable([[0, 1], [1, 2]], 1e6, 1e3)}, [Support([0, 2])]
    )
    result = Analysis(structure).run([Stage("load", [PointLoad(1, (0, -30.0, -40.0))])])["load"]
    (_, y, z), force = result.displacement[1], result.cable("cable").force[0]
    sine = np.hypot(y, z) / np.sqrt(1 + y**2 + z**2)
    assert (y, z) == pytest.approx((0.75 * z, z), rel=1e-9)
    assert 2 * force * sine == pytest.approx(50.0, rel=1e-9)


@pytest.mark.mpi
def test_prescribed_displacements_support_their_stage_and_those_after_it():
    banner = Analysis(sheet(Support(0)))
    hold = [PrescribedDisplacement([4, 20, 24], (0, 0, 0))]
    stages = [Stage("hold", displacements=hold), Stage("load", [SNOW], after="hold")]
    assert set(banner.run(stages)) == {"hold", "load"}
    with pytest.raises(ValueError, match="not supported enough"):
        banner.run([*stages, Stage("alone", [SNOW])])


# Stages


def test_after_keeps_loads_and_prescribed_displacements(analysis):
    results = analysis.run(
        [
            Stage("lift", [SNOW], [LIFT]),
            Stage("wind", [WIND], after="lift"),
            Stage("at once", [SNOW, WIND], [LIFT]),
        ]
    )
    assert same_state(results["wind"], results["at once"])
    assert results["wind"].displacement[CENTRE] == pytest.approx(LIFT.displacement, rel=1e-14)
    assert not same_state(results["wind"], results["lift"])


def test_without_after_a_stage_starts_from_the_reference_shape(analysis):
    results = analysis.run([Stage("snow", [SNOW], [LIFT]), Stage("rest"), Stage("wind", [WIND])])
    assert not results["rest"].displacement.any()
    assert not results["rest"].loads.any()
    assert same_state(results["wind"], analysis.run([Stage("wind", [WIND])])["wind"])


@pytest.mark.mpi
def test_branches_do_not_see_each_other(analysis):
    lift, snow, wind = (
        Stage("lift", displacements=[LIFT]),
        Stage("snow", [SNOW], after="lift"),
        Stage("wind", [WIND], [PrescribedDisplacement(8, (0, 0, 0.1), "z")], after="lift"),
    )
    both, turned, alone = analysis.run([lift, snow, wind]), analysis.run([lift, wind, snow]), analysis.run([lift, wind])
    for name in ("lift", "snow", "wind"):
        assert same_state(both[name], turned[name])
    assert same_state(both["wind"], alone["wind"])
    assert both["snow"].reactions[8].tolist() == [0, 0, 0]
    assert not same_state(both["snow"], both["wind"])


@pytest.mark.parametrize("name", ["prestress", "0"])
def test_stage_that_adds_nothing_starts_in_equilibrium(analysis, name):
    results = analysis.run([Stage(name, [SNOW], [LIFT]), Stage("same", after=name)])
    assert results["same"].history[0][1].residual <= 1e-9 * np.abs(results[name].reactions).max()
    assert same_state(results["same"], results[name])


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [2, 5])
def test_result_does_not_depend_on_the_number_of_steps(analysis, steps):
    results = analysis.run(
        [
            Stage("one", [SNOW, WIND], [LIFT]),
            Stage("many", [SNOW, WIND], [LIFT], increments=steps),
            Stage("one more", [SNOW], after="one"),
            Stage("many more", [SNOW], after="many", increments=steps),
        ]
    )
    assert [i.load_factor for i in results["many"].increments] == [(k + 1) / steps for k in range(steps)]
    assert same_state(results["many"], results["one"])
    assert same_state(results["many more"], results["one more"])
    assert results["many"].energy == pytest.approx(results["one"].energy, rel=1e-12)


def test_result_of_a_stage_that_was_not_run(analysis):
    results = analysis.run([Stage("rest"), Stage("snow", [SNOW])])
    with pytest.raises(KeyError, match=r"no stage.*'wind'.*results.*\['rest', 'snow'\]"):
        results["wind"]
    assert "wind" not in results
    assert results.get("wind") is None


def test_stage_without_a_name_is_refused():
    with pytest.raises(ValueError, match=r"name.*stage is ''"):
        Stage("")


# Loads


@pytest.mark.mpi
def test_load_on_a_support_goes_into_its_reaction(analysis):
    force = np.array([3.0, -4.0, 5.0])
    results = analysis.run([Stage("snow", [SNOW]), Stage("both", [SNOW, PointLoad(0, force)])])
    assert close(results["both"].displacement, results["snow"].displacement)
    change = results["both"].reactions - results["snow"].reactions
    assert change[0] == pytest.approx(-force, abs=1e-9)
    assert np.delete(change, 0, axis=0) == pytest.approx(np.zeros((24, 3)), abs=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize(("cells", "area"), [(None, 4.0), ([0, 1, 5], 3 * 0.125), (7, 0.125)])
def test_distributed_load_sums_to_load_times_area(analysis, cells, area):
    result = analysis.run([Stage("snow", [DistributedLoad((1.0, 2.0, -3.0), "fabric", cells)])])["snow"]
    assert result.loads.sum(axis=0) == pytest.approx(area * np.array([1, 2, -3]), rel=1e-13, abs=1e-15)
    assert result.equilibrium.loads == pytest.approx(result.loads.sum(axis=0))


def test_distributed_load_on_cables_sums_to_load_times_length():
    structure = Structure(
        [[0.0, 0, 0], [3, 4, 0], [3, 4, 2]], {"cable": Cable([[0, 1], [1, 2]], 1e6, 1e3)}, [Support([0, 1, 2])]
    )
    result = Analysis(structure).run([Stage("ice", [DistributedLoad((0, 0, -2.0), "cable")])])["ice"]
    assert result.loads[:, 2] == pytest.approx([-5, -5 - 2, -2], rel=1e-13)


@pytest.mark.parametrize(
    "loads",
    [
        [PointLoad(CENTRE, (0, 0, -50.0)), PointLoad(CENTRE, (0, 0, -50.0))],
        [
            PointLoad(CENTRE, (0, 0, -100.0)),
            DistributedLoad((0, 0, 7.0), "fabric"),
            DistributedLoad((0, 0, -7.0), "fabric"),
        ],
    ],
    ids=["two loads", "two distributed loads that cancel"],
)
def test_loads_add_up(analysis, loads):
    once = analysis.run([Stage("load", [PointLoad(CENTRE, (0, 0, -100.0))])])["load"]
    result = analysis.run([Stage("load", loads)])["load"]
    assert result.loads == pytest.approx(once.loads, abs=1e-12)
    assert close(result.displacement, once.displacement)


def test_loads_of_stages_add_up(analysis):
    stages = [Stage("half", [SNOW]), Stage("full", [SNOW], after="half")]
    double = DistributedLoad(2 * SNOW.load, "fabric")
    assert same_state(analysis.run(stages)["full"], analysis.run([Stage("full", [double])])["full"])


def test_run_can_be_repeated(analysis):
    stages = [Stage("lift", displacements=[LIFT]), Stage("snow", [SNOW], after="lift")]
    first, second = analysis.run(stages), analysis.run(stages)
    for name in first:
        assert same_state(first[name], second[name])
        assert first[name].energy == pytest.approx(second[name].energy, rel=1e-12)
