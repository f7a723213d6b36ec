"""What is slack where no equilibrium is found, in words."""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, ConvergenceError, Newton, PointLoad, Stage, Structure, Support
from fx_membrane.slackness import slack_parts

POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 1, 0]])
PARTS = {"along": Cable([[0, 1], [1, 2]], 1e6, prestress=10.0), "side": Cable([[1, 3]], 1e6, prestress=1.0)}
STRUCTURE = Structure(POINTS, PARTS, [Support([0, 2, 3]), Support(1, "z")])


def state(force):
    return Analysis(STRUCTURE).run([Stage("load", [PointLoad(1, (0, force, 0))])])["load"]


def test_parts_that_are_slack_are_named():
    words = slack_parts(state(2e3))
    assert "'side' is slack in 1 of 1 cells" in words
    assert "along" not in words


def test_nothing_is_said_where_all_is_taut():
    assert slack_parts(state(0.0)) == ""


def test_failure_names_slack_parts():
    short = Analysis(STRUCTURE, Newton(max_iterations=1, rtol=1e-15, line_search=False))
    with pytest.raises(ConvergenceError, match=r"'side' is slack in 1 of 1 cells"):
        short.run([Stage("load", [PointLoad(1, (0, 2e3, 0))])])
