"""Sentences on slack parts where no equilibrium is found."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    Mast,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    report,
)
from fx_membrane.results.slackness import slack_parts

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0]])
PARTS = {"along": Cable([[0, 1], [1, 2]], 1e6, prestress=10.0), "side": Cable([[1, 3]], 1e6, prestress=1.0)}
STRUCTURE = Structure(POINTS, PARTS, [Support([0, 2, 3]), Support(1, "z")])


def state(force):
    return Analysis(STRUCTURE).run([Stage("load", [PointLoad(1, (0, force, 0))])])["load"]


@pytest.mark.mpi
def test_parts_that_are_slack_are_named():
    words = slack_parts(state(2e3))
    assert "'side' is slack in 1 of 1 cells" in words
    assert "along" not in words


def test_nothing_is_said_where_all_is_taut():
    assert slack_parts(state(0.0)) == ""


def idle(prestress=0.0, stiffness=1e6, **data):
    """Cables in their initial shape, without load."""
    cables = Cable([[0, 1], [1, 2], [1, 3]], stiffness, prestress, **data)
    structure = Structure(POINTS, {"net": cables}, [Support([0, 2, 3]), Support(1, "z")])
    return Analysis(structure).run([Stage("rest")])["rest"]


def test_cables_without_force_are_slack():
    state = idle()
    assert state.cable("net").slack.all()
    assert "'net' is slack in 3 of 3 cells" in slack_parts(state)
    assert "3 of 3 cells slack" in report(state)
    assert idle(stiffness=1e12).cable("net").slack.all()


def test_what_has_little_force_or_carries_compression_is_not_slack():
    assert not idle([1e-6, 1e-6, 0.0]).cable("net").slack[:2].any()
    assert not idle(compression_stiffness=1.0).cable("net").slack.any()
    bar = Structure(POINTS[:2], {"mast": Mast([[0, 1]], 1e6)}, [Support([0, 1])])
    assert not Analysis(bar).run([Stage("rest")])["rest"].mast("mast").slack.any()


@pytest.mark.mpi
def test_failure_names_slack_parts():
    short = Analysis(STRUCTURE, Newton(max_iterations=1, rtol=1e-15, line_search=False))
    with pytest.raises(ConvergenceError, match=r"'side' is slack in 1 of 1 cells"):
        short.run([Stage("load", [PointLoad(1, (0, 2e3, 0))])])


@pytest.mark.mpi_once
@pytest.mark.parametrize(("supports", "named"), [([0, 2], True), ([0, 2, 3], False)])
def test_failure_names_a_cable_with_a_free_end(supports, named):
    structure = Structure(POINTS, PARTS, [Support(supports), Support(1, "z")])
    short = Analysis(structure, Newton(max_iterations=1, rtol=1e-15, line_search=False))
    with pytest.raises(ConvergenceError) as failure:
        short.run([Stage("load", [PointLoad(1, (0, 2e3, 0))])])
    assert bool(re.search(r"'side', cell 0\b.* node 3\b", str(failure.value))) == named


@pytest.mark.parametrize(("strain", "force"), [(0.009, -0.1), (0.011, 1e3)])
def test_negative_prestress_is_an_excess_of_length(strain, force):
    parts = {"cable": Cable([[0, 1]], 1e6, prestress=-1e4), "mast": Mast([[0, 1]], 1e6, prestress=-1e4)}
    stretched = np.sqrt(1 + 2 * strain)  # for a Green-Lagrange strain
    moves = [PrescribedDisplacement([0, 1], [[0, 0, 0], [stretched - 1, 0, 0]])]
    result = Analysis(Structure(POINTS[:2], parts)).run([Stage("stretch", displacements=moves)])["stretch"]
    assert result.cable("cable").slack.tolist() == [force < 0]  # 1e-4 of the stiffness is kept
    assert result.cable("cable").force == pytest.approx([force * stretched], rel=1e-9)
    assert result.mast("mast").force == pytest.approx([(1e6 * strain - 1e4) * stretched], rel=1e-9)
