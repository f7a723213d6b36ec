"""Stages: what they keep, what they share, where they start, and what is left when one fails."""

import contextlib
import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DeadLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary,
    rectangle,
)
from fx_membrane.analysis import HALVINGS
from fx_membrane.solver import Iteration, Solution

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
EDGE = np.unique(boundary(TRIANGLES))
CENTRE = 12
FABRIC = Fabric(Et=1e5, nu=0.3)
SNOW = DeadLoad((0, 0, -200.0), "fabric")
WIND = DeadLoad((30.0, 0, 250.0), "fabric", range(8))
TOO_MUCH = DeadLoad((0, 0, -1e12), "fabric")
LIFT = PrescribedDisplacement(CENTRE, (0.01, 0, 0.1))


def rotation(seed):
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return Q * np.sign(np.linalg.det(Q))


def sheet(*supports, prestress=1e3, points=POINTS):
    return Structure(points, {"fabric": Membrane(TRIANGLES, FABRIC, prestress=prestress)}, supports or [Support(EDGE)])


@pytest.fixture(scope="module")
def analysis():
    return Analysis(sheet())


def close(a, b):
    return a == pytest.approx(b, abs=1e-9 * np.abs(b).max())


def same_state(a, b):
    return close(a.displacement, b.displacement) and close(a.reactions, b.reactions) and close(a.loads, b.loads)


# Supports


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
    with pytest.raises(
        ValueError, match=r"not supported enough: the piece with node \d+ \(25 nodes: Membrane '\w+'\) can"
    ):
        Analysis(structure).run([Stage("rest")])


def test_piece_without_supports_is_named():
    points = np.vstack([POINTS, POINTS + np.array([0, 0, 1])])
    parts = {"low": Membrane(TRIANGLES, FABRIC, 1e3), "high": Membrane(TRIANGLES + 25, FABRIC, 1e3)}
    with pytest.raises(ValueError, match=r"the piece with node 25 \(25 nodes: Membrane 'high'\)"):
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


def test_prescribed_displacements_support_their_stage_and_those_after_it():
    banner = Analysis(sheet(Support(0)))
    hold = [PrescribedDisplacement([4, 20, 24], (0, 0, 0))]
    stages = [Stage("hold", displacements=hold), Stage("load", [SNOW], after="hold")]
    assert set(banner.run(stages)) == {"hold", "load"}
    with pytest.raises(ValueError, match="not supported enough"):
        banner.run([*stages, Stage("alone", [SNOW])])


# Failures


@pytest.mark.parametrize("R", [np.eye(3), *map(rotation, range(4))], ids=["z=0", *(f"turned {i}" for i in range(4))])
def test_flat_membrane_without_prestress_has_no_stiffness_across(R):
    structure = sheet(prestress=0.0, points=POINTS @ R.T)
    load = DeadLoad(R @ [0, 0, -200.0], "fabric")
    with pytest.raises(
        ConvergenceError,
        match=r"'snow' .* load factor 0\.5 \(the last found is at 0\): .* singular.* node 6 .*prestress",
    ) as error:
        Analysis(structure).run([Stage("snow", [load], steps=2)])
    assert len(error.value.failed.iterations) == 1
    assert not error.value.last.displacement.any()


def test_failure_keeps_the_completed_stages_and_the_state_before(analysis):
    short = Analysis(sheet(), Newton(max_iterations=4))
    first = Stage("first", [DeadLoad((0, 0, -20.0), "fabric")])
    with pytest.raises(ConvergenceError, match=r"^Stage 'snow' found no equilibrium at load factor ") as error:
        short.run([first, Stage("other"), Stage("snow", [TOO_MUCH], [LIFT], after="first"), Stage("never")])
    failure = error.value
    expected = analysis.run([first])["first"]
    assert list(failure.results) == ["first", "other"]
    assert same_state(failure.results["first"], expected)
    assert failure.last.name == "snow"
    assert failure.last.increments == ()
    assert same_state(failure.last, expected)
    assert failure.last.equilibrium.residual <= 1e-9 * np.abs(expected.reactions).max()
    assert failure.failed.load_factor == 1 / 2**HALVINGS
    assert len(failure.failed.iterations) == 5


def arch(supports=(Support([0, 2]), Support(1, "y"))):
    """Two bars that snap through, held in their plane."""
    parts = {"arch": Mast([[0, 1], [1, 2]], 1e6)}
    return Structure([[-1.0, 0, 0], [0, 0, 0.3], [1, 0, 0]], parts, supports)


LIMIT = (
    2 / 3**1.5 * 1e6 * 0.3**3 / 1.09**1.5
)  # largest load: the force EA (h^2 - z^2) / l^2 z / l, twice, at z = h / sqrt(3)


def test_failure_in_a_later_step_keeps_the_steps_before():
    # So near the largest load there is little stiffness left, and displacements have fewer digits than forces.
    analysis = Analysis(arch(), Newton(rtol=1e-13, max_iterations=12))
    with pytest.raises(ConvergenceError, match=r"\(the last found is at 0\.83") as error:
        analysis.run([Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], steps=8)])
    failure = error.value
    factors = [increment.load_factor for increment in failure.last.increments]
    assert factors[:6] == [0.125, 0.25, 0.375, 0.5, 0.625, 0.75]
    # Between the last state and the one that is not found lies the largest load; both within the shortest increment.
    assert factors[-1] < 1 / 1.2 < failure.failed.load_factor <= factors[-1] + 0.125 / 2**HALVINGS
    load = factors[-1] * 1.2 * LIMIT
    part = analysis.run([Stage("push", [PointLoad(1, (0, 0, -load))], steps=6)])["push"]
    assert same_state(failure.last, part)
    assert failure.last.energy == pytest.approx(part.energy, rel=1e-12)
    assert failure.last.mast("arch").force == pytest.approx(part.mast("arch").force, rel=1e-9)
    assert failure.last.equilibrium.residual <= 1e-9 * LIMIT
    z = 0.3 + failure.last.displacement[1, 2]
    assert 1e6 * (0.3**2 - z**2) * z / 1.09**1.5 == pytest.approx(load, rel=1e-9)


def test_failure_after_moving_supports_keeps_their_position():
    # With more iterations one of them can land on the shape that has snapped through.
    analysis = Analysis(arch([Support(0), Support(1, "y")]), Newton(max_iterations=6))
    hold = Stage("hold", displacements=[PrescribedDisplacement(2, (0, 0, 0))])
    push = PointLoad(1, (0, 0, -1.2 * LIMIT))
    spread = PrescribedDisplacement([2], (0.01, 0, 0))
    with pytest.raises(ConvergenceError) as error:
        analysis.run([hold, Stage("push", [push], [spread], steps=8, after="hold")])
    last = error.value.last
    factor = last.increments[-1].load_factor
    assert 0 < factor < 1
    assert last.displacement[2] == pytest.approx([factor * 0.01, 0, 0], rel=1e-14)
    assert last.loads[1, 2] == pytest.approx(-factor * 1.2 * LIMIT)
    assert last.equilibrium.residual <= 1e-9 * LIMIT


def test_analysis_can_go_on_after_a_failure(analysis):
    short = Analysis(sheet(), Newton(max_iterations=4))
    mild = [Stage("mild", [DeadLoad((0, 0, -20.0), "fabric")])]
    with pytest.raises(ConvergenceError):
        short.run([Stage("snow", [TOO_MUCH], [LIFT])])
    assert same_state(short.run(mild)["mild"], analysis.run(mild)["mild"])


def test_bad_stage_is_refused_before_anything_is_solved():
    short = Analysis(sheet(), Newton(max_iterations=1))  # would fail in the first stage
    with pytest.raises(ValueError, match="node 99"):
        short.run([Stage("snow", [SNOW]), Stage("wind", [PointLoad(99, (0, 0, 1))])])


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


@pytest.mark.parametrize("steps", [2, 5])
def test_result_does_not_depend_on_the_number_of_steps(analysis, steps):
    results = analysis.run(
        [
            Stage("one", [SNOW, WIND], [LIFT]),
            Stage("many", [SNOW, WIND], [LIFT], steps=steps),
            Stage("one more", [SNOW], after="one"),
            Stage("many more", [SNOW], after="many", steps=steps),
        ]
    )
    assert [i.load_factor for i in results["many"].increments] == [(k + 1) / steps for k in range(steps)]
    assert same_state(results["many"], results["one"])
    assert same_state(results["many more"], results["one more"])
    assert results["many"].energy == pytest.approx(results["one"].energy, rel=1e-12)


def test_stage_without_a_name_is_refused():
    with pytest.raises(ValueError, match="name of a stage is ''"):
        Stage("")


# Prescribed displacements


def test_prescribed_displacement_is_reached_and_its_reaction_is_the_force_needed(analysis):
    lifted = analysis.run([Stage("lift", [SNOW], [LIFT], steps=2)])["lift"]
    assert lifted.displacement[CENTRE] == pytest.approx(LIFT.displacement, rel=1e-14)
    force = PointLoad(CENTRE, lifted.reactions[CENTRE])
    assert np.abs(lifted.reactions[CENTRE]).max() > 100
    pushed = analysis.run([Stage("push", [SNOW, force])])["push"]
    assert close(pushed.displacement, lifted.displacement)
    assert pushed.reactions[CENTRE].tolist() == [0, 0, 0]


def test_components_that_are_not_prescribed_stay_free(analysis):
    stage = Stage("lift", [WIND], [PrescribedDisplacement(CENTRE, (9, 9, 0.1), "z")])
    result = analysis.run([stage])["lift"]
    assert result.displacement[CENTRE, 2] == pytest.approx(0.1, rel=1e-14)
    assert np.abs(result.displacement[CENTRE, :2]).max() < 0.05
    assert (result.reactions[CENTRE] != 0).tolist() == [False, False, True]


def test_held_nodes_can_be_moved():
    sides = {side: EDGE[POINTS[EDGE, 0] == side] for side in (-1.0, 1.0)}
    rest = np.setdiff1d(EDGE, np.concatenate(list(sides.values())))
    hold = [PrescribedDisplacement(nodes, (0, 0, 0)) for nodes in sides.values()]
    apart = [PrescribedDisplacement(nodes, (side * 0.01, 0, 0)) for side, nodes in sides.items()]
    stages = [Stage("hold", displacements=hold), Stage("stretch", displacements=apart, after="hold")]
    result = Analysis(sheet(Support(rest))).run(stages)["stretch"]
    assert result.displacement[POINTS[:, 0] == 1.0, 0] == pytest.approx(0.01, rel=1e-14)
    assert result.displacement[POINTS[:, 0] == -1.0, 0] == pytest.approx(-0.01, rel=1e-14)
    assert result.membrane("fabric").cauchy[:, 0, 0].min() > 1e3


def test_each_node_can_have_its_own_displacement(analysis):
    own = np.array([[0.01, 0, 0.1], [0, 0.02, -0.05]])
    both = PrescribedDisplacement([CENTRE, 8], own, "xz")
    apart = [PrescribedDisplacement(CENTRE, own[0], "xz"), PrescribedDisplacement(8, own[1], "xz")]
    results = analysis.run([Stage("both", displacements=[both]), Stage("apart", displacements=apart)])
    assert results["both"].displacement[[CENTRE, 8]][:, [0, 2]] == pytest.approx(own[:, [0, 2]], rel=1e-14, abs=1e-16)
    assert same_state(results["both"], results["apart"])


def test_later_prescribed_displacement_replaces_the_one_before(analysis):
    back = PrescribedDisplacement(CENTRE, (0, 0, -0.1))
    results = analysis.run(
        [
            Stage("up", displacements=[LIFT]),
            Stage("down", displacements=[back], after="up", steps=3),
            Stage("alone", displacements=[back]),
        ]
    )
    assert results["down"].displacement[CENTRE] == pytest.approx([0, 0, -0.1], abs=1e-15)
    assert same_state(results["down"], results["alone"])


def test_node_taken_hold_of_where_it_is_needs_no_force(analysis):
    snow = Stage("snow", [SNOW])
    where = analysis.run([snow])["snow"].displacement[CENTRE]
    hold = Stage("hold", displacements=[PrescribedDisplacement(CENTRE, where)], after="snow", steps=3)
    results = analysis.run([snow, hold])
    small = 1e-9 * np.abs(results["snow"].reactions).max()
    assert all(entry.residual <= small for _, entry in results["hold"].history)
    assert np.abs(results["hold"].reactions[CENTRE]).max() <= small


def test_node_taken_hold_of_moves_in_equal_steps_from_where_it_is():
    push = Stage("push", [PointLoad(1, (0, 0, -0.5 * LIMIT))])
    back = Stage("back", displacements=[PrescribedDisplacement(1, (0, 0, 0), "z")], after="push", steps=4)
    results = Analysis(arch()).run([push, back])
    assert results["push"].displacement[1, 2] < -0.01
    # At the start of a step: what is left of the way, times a stiffness that is the same in all steps.
    gaps = [increment.iterations[0].residual for increment in results["back"].increments]
    assert gaps == pytest.approx([gaps[0]] * 4, rel=1e-9)
    assert gaps[0] > 0


# Loads


def test_load_on_a_support_goes_into_its_reaction(analysis):
    force = np.array([3.0, -4.0, 5.0])
    results = analysis.run([Stage("snow", [SNOW]), Stage("both", [SNOW, PointLoad(0, force)])])
    assert close(results["both"].displacement, results["snow"].displacement)
    change = results["both"].reactions - results["snow"].reactions
    assert change[0] == pytest.approx(-force, abs=1e-9)
    assert np.delete(change, 0, axis=0) == pytest.approx(np.zeros((24, 3)), abs=1e-9)


@pytest.mark.parametrize(("cells", "area"), [(None, 4.0), ([0, 1, 5], 3 * 0.125), (7, 0.125)])
def test_dead_load_sums_to_load_times_area(analysis, cells, area):
    result = analysis.run([Stage("snow", [DeadLoad((1.0, 2.0, -3.0), "fabric", cells)])])["snow"]
    assert result.loads.sum(axis=0) == pytest.approx(area * np.array([1, 2, -3]), rel=1e-13, abs=1e-15)
    assert result.equilibrium.loads == pytest.approx(result.loads.sum(axis=0))


def test_dead_load_on_cables_sums_to_load_times_length():
    structure = Structure(
        [[0.0, 0, 0], [3, 4, 0], [3, 4, 2]], {"cable": Cable([[0, 1], [1, 2]], 1e6, 1e3)}, [Support([0, 1, 2])]
    )
    result = Analysis(structure).run([Stage("ice", [DeadLoad((0, 0, -2.0), "cable")])])["ice"]
    assert result.loads[:, 2] == pytest.approx([-5, -5 - 2, -2], rel=1e-13)


@pytest.mark.parametrize(
    "loads",
    [
        [PointLoad(CENTRE, (0, 0, -50.0)), PointLoad(CENTRE, (0, 0, -50.0))],
        [PointLoad(CENTRE, (0, 0, -100.0)), DeadLoad((0, 0, 7.0), "fabric"), DeadLoad((0, 0, -7.0), "fabric")],
    ],
    ids=["two loads", "two dead loads that cancel"],
)
def test_loads_add_up(analysis, loads):
    once = analysis.run([Stage("load", [PointLoad(CENTRE, (0, 0, -100.0))])])["load"]
    result = analysis.run([Stage("load", loads)])["load"]
    assert result.loads == pytest.approx(once.loads, abs=1e-12)
    assert close(result.displacement, once.displacement)


def test_loads_of_stages_add_up(analysis):
    stages = [Stage("half", [SNOW]), Stage("full", [SNOW], after="half")]
    double = DeadLoad(2 * SNOW.load, "fabric")
    assert same_state(analysis.run(stages)["full"], analysis.run([Stage("full", [double])])["full"])


def test_run_can_be_repeated(analysis):
    stages = [Stage("lift", displacements=[LIFT]), Stage("snow", [SNOW], after="lift")]
    first, second = analysis.run(stages), analysis.run(stages)
    for name in first:
        assert same_state(first[name], second[name])
        assert first[name].energy == pytest.approx(second[name].energy, rel=1e-12)


# Length of increments

POINT = [PointLoad(CENTRE, (0, 0, -2e4)), WIND]


def unwilling(analysis, failing, retry=True):
    """Makes the solver fail at some of its calls, counted from zero, and leave nonsense behind; gives the targets."""
    solve, problem, tried = analysis._solve, analysis._problem, []

    def wrapped(x, *monitor):
        tried.append(float(problem.discretization.gather(problem._loads)[CENTRE, 2]) / -100.0)
        if len(tried) - 1 not in failing:
            return solve(x, *monitor)
        x.set(1e3)
        return Solution(False, "it is unwilling.", (Iteration(1.0, 2.0, 0.0),), retry=retry)

    analysis._solve = wrapped
    return tried


def pushed(failing, steps, retry=True):
    """Load factors that are tried and those that are found, and the state."""
    analysis = Analysis(sheet())
    tried = unwilling(analysis, failing, retry)
    result = analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))], steps=steps)])["push"]
    return tried, [increment.load_factor for increment in result.increments], result


@pytest.mark.parametrize(
    ("steps", "failing", "tried", "found"),
    [
        (1, [], [1], [1]),
        (1, [0], [1, 1 / 2, 1], [1 / 2, 1]),
        (1, [0, 1], [1, 1 / 2, 1 / 4, 3 / 4, 1], [1 / 4, 3 / 4, 1]),
        (3, [1], [1 / 3, 2 / 3, 1 / 2, 5 / 6, 1], [1 / 3, 1 / 2, 5 / 6, 1]),
        (2, [0, 2], [1 / 2, 1 / 4, 3 / 4, 1 / 2, 1], [1 / 4, 1 / 2, 1]),
        (1, [0, 1, 4], [1, 1 / 2, 1 / 4, 3 / 4, 1, 7 / 8, 1], [1 / 4, 3 / 4, 7 / 8, 1]),
    ],
    ids=["none", "first", "first two", "second of three", "one that has grown", "the rest of the stage"],
)
def test_failing_increment_is_halved_and_the_next_grows_back(analysis, steps, failing, tried, found):
    all_tried, all_found, result = pushed(failing, steps)
    assert all_tried == pytest.approx(tried, rel=1e-14)
    assert all_found == pytest.approx(found, rel=1e-14)
    assert all_found[-1] == 1
    assert same_state(result, analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))])])["push"])


def test_history_is_that_of_the_increments_found():
    _, _, result = pushed([0, 1], 1)
    assert [factor for factor, entry in result.history if entry.step == 0] == [1 / 4, 3 / 4, 1]
    assert max(entry.residual for _, entry in result.history) < 1e3


@pytest.mark.parametrize("steps", [1, 3])
def test_gives_up_after_eight_halvings(analysis, steps):
    stubborn = Analysis(sheet())
    tried = unwilling(stubborn, range(2, 100))
    stages = [Stage("rest"), Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))], steps=steps, after="rest")]
    if steps == 1:
        stages.insert(1, Stage("other"))
    with pytest.raises(ConvergenceError, match=r"^Stage 'push' .* it is unwilling\.$") as error:
        stubborn.run(stages)
    done = 0 if steps == 1 else 1
    failure, full = error.value, 1 / steps
    assert len(tried) == 2 + 1 + 8
    assert failure.failed.load_factor == pytest.approx(full * (done + 1 / 2**8), rel=1e-14)
    assert list(failure.results) == [stage.name for stage in stages[:-1]]
    assert [increment.load_factor for increment in failure.last.increments] == [full] * done
    part = Stage("push", [PointLoad(CENTRE, (0, 0, -100.0 * full * done))])
    expected = analysis.run([part])["push"]
    scale = 1e-9 * np.abs(expected.displacement).max()
    assert failure.last.displacement == pytest.approx(expected.displacement, abs=scale)


def test_increment_that_no_length_helps_is_not_halved():
    analysis = Analysis(sheet())
    tried = unwilling(analysis, [0], retry=False)
    with pytest.raises(ConvergenceError):
        analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))])])
    assert len(tried) == 1


def test_hard_load_in_one_step_ends_where_many_steps_end(analysis):
    short = Analysis(sheet(), Newton(max_iterations=4)).run([Stage("hard", POINT)])["hard"]
    factors = [increment.load_factor for increment in short.increments]
    sizes = np.diff([0, *factors])
    assert (sizes > 0).all()
    assert len(factors) > 2
    assert factors[-1] == 1
    assert (sizes[1:] > sizes[:-1]).any()  # it grows back
    assert (sizes[1:] <= 2 * sizes[:-1]).all()
    many = analysis.run([Stage("hard", POINT, steps=40)])["hard"]
    assert [increment.load_factor for increment in many.increments] == [(k + 1) / 40 for k in range(40)]
    assert same_state(short, many)
    assert short.energy == pytest.approx(many.energy, rel=1e-12)


# Progress on a terminal


def test_nothing_is_written_where_there_is_no_terminal(capfd):
    Analysis(sheet()).run([Stage("snow", [SNOW], steps=3)])
    assert capfd.readouterr() == ("", "")


WATCHED = """
from fx_membrane import *
points, triangles = rectangle(1.0, 1.0, 2, 2)
fabric = Membrane(triangles, Fabric(Et=1e5, nu=0.3), prestress=1e3)
analysis = Analysis(Structure(points, {"fabric": fabric}, [Support([0, 1, 2, 3, 5, 6, 7, 8])]))
snow = DeadLoad((0, 0, -100.0), "fabric")
analysis.run([Stage("prestress"), Stage("snow on the roof", [snow], steps=4, after="prestress")])
"""


@pytest.mark.serial
@pytest.mark.parametrize("columns", [120, 80, 0], ids=["wide", "usual", "no size told"])
def test_terminal_shows_stage_and_load_factor(columns):
    terminal, process_end = pty.openpty()
    fcntl.ioctl(process_end, termios.TIOCSWINSZ, struct.pack("HHHH", 24 if columns else 0, columns, 0, 0))
    process = subprocess.Popen([sys.executable, "-c", WATCHED], stderr=process_end, stdout=subprocess.PIPE)
    os.close(process_end)
    shown = b""
    # At the end of the process Linux reports the terminal as gone, not as ended.
    with contextlib.suppress(OSError):
        while piece := os.read(terminal, 4096):
            shown += piece
    os.close(terminal)
    with process:
        assert process.stdout.read() == b""
    assert process.returncode == 0
    text = shown.decode()
    assert re.search(r"\rprestress: [^\r]* load factor 1\.0000", text)
    for factor in ("0.0000", "0.2500", "0.5000", "0.7500", "1.0000"):
        assert re.search(rf"\rsnow on the roof: [^\r]* load factor {re.escape(factor)}", text), factor
    assert re.search(r"iteration \d+, residual \d\.\de[+-]\d\d", text)
    assert text.count("\n") == 2  # one line for each stage


# Compilation

COMPILED = """
import os
from pathlib import Path
from fx_membrane import *

cache = Path(os.environ["XDG_CACHE_HOME"], "fenics")

def compiled():
    return len(list(cache.glob("*.so")))

def analyse(n):
    points, triangles = rectangle(1.0, 1.0, n, n)
    edges, half = boundary(triangles), len(triangles) // 2
    woven = OrthotropicFabric(Et_warp=1e5 * n, Et_weft=8e4, nu=0.3, Gt=2e4)
    parts = {
        f"fabric {n}": Membrane(triangles[:half], Fabric(Et=1e5 * n, nu=0.3), prestress=1e3 * n),
        f"woven {n}": Membrane(triangles[half:], woven, prestress=1e3 * n, warp=(1.0, n, 0)),
        f"cable {n}": Cable(edges, 1e6 * n, 1e3),
    }
    supports = [Support(edges[edges[:, 0] > 0, 0])]
    analysis = Analysis(Structure(points, parts, supports))
    made = compiled()
    snow = Stage("snow", [DeadLoad((0, 0, -n), f"fabric {n}")], [PrescribedDisplacement(0, (0, 0, 0.1))])
    analysis.run([snow, Stage("ice", [DeadLoad((0, 0, -n), f"cable {n}"), PointLoad(0, (0, 0, n))], after="snow")])
    return made, compiled()

print(*(count for n in (2, 3, 4) for count in analyse(n)))
"""


@pytest.mark.serial
def test_nothing_is_compiled_twice(tmp_path):
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}

    def counts():
        command = [sys.executable, "-c", COMPILED]
        run = subprocess.run(command, env=environment, capture_output=True, text=True, check=True, timeout=120)
        return [int(count) for count in run.stdout.split()]

    cold = counts()
    assert cold[0] > 0
    assert cold == [cold[0]] * 6  # not by another structure of the same kind, nor by a stage
    assert counts() == cold  # nor by another process
