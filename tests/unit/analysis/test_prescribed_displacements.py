"""Prescribed displacements: reached exactly, from the present position, with the force needed."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Support,
)
from models import CENTRE, EDGE, LIFT, LIMIT, POINTS, SNOW, WIND, arch, close, same_state, sheet


@pytest.mark.mpi
def test_prescribed_displacement_is_reached_and_its_reaction_is_the_force_needed(analysis):
    lifted = analysis.run([Stage("lift", [SNOW], [LIFT], increments=2)])["lift"]
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


@pytest.mark.mpi
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
            Stage("down", displacements=[back], after="up", increments=3),
            Stage("alone", displacements=[back]),
        ]
    )
    assert results["down"].displacement[CENTRE] == pytest.approx([0, 0, -0.1], abs=1e-15)
    assert same_state(results["down"], results["alone"])


def test_node_taken_hold_of_where_it_is_needs_no_force(analysis):
    snow = Stage("snow", [SNOW])
    where = analysis.run([snow])["snow"].displacement[CENTRE]
    hold = Stage("hold", displacements=[PrescribedDisplacement(CENTRE, where)], after="snow", increments=3)
    results = analysis.run([snow, hold])
    small = 1e-9 * np.abs(results["snow"].reactions).max()
    assert all(entry.residual <= small for _, entry in results["hold"].history)
    assert np.abs(results["hold"].reactions[CENTRE]).max() <= small


@pytest.mark.mpi
def test_node_taken_hold_of_moves_in_equal_steps_from_where_it_is():
    push = Stage("push", [PointLoad(1, (0, 0, -0.5 * LIMIT))])
    back = Stage("back", displacements=[PrescribedDisplacement(1, (0, 0, 0), "z")], after="push", increments=4)
    results = Analysis(arch()).run([push, back])
    assert results["push"].displacement[1, 2] < -0.01
    # At the start of a step: the remaining displacement, times a stiffness that is the same in all steps.
    gaps = [increment.iterations[0].residual for increment in results["back"].increments]
    assert gaps == pytest.approx([gaps[0]] * 4, rel=1e-9)
    assert gaps[0] > 0
