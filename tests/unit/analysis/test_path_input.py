"""Refusals of equilibrium paths: bad input, and starts that are none."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    PathError,
    PointLoad,
    Stage,
    Support,
    equilibrium_path,
)
from models import LIMIT, POINTS, SNOW, arch, sheet

PUSH = Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], increments=8)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("arch", PUSH), r"^equilibrium_path start is 'arch'; give a Structure or StageResult"),
        ((arch(), "push"), r"^equilibrium_path stage is 'push'; give a Stage"),
        ((arch(), Stage("push", PUSH.loads, after="rest")), r"after='rest'.*path starts.*structure"),
        ((arch(), Stage("push", [PointLoad(9, (0, 0, 1.0))])), r"names node 9.*not exist"),
        ((sheet(Support(12)), Stage("snow", [SNOW])), r"not supported enough"),
        ((arch(), Stage("nothing")), r"^Stage 'nothing' moves nothing.*loads"),
        ((arch(), PUSH, "all"), r"^equilibrium_path load_factor is the text 'all'"),
        ((arch(), PUSH, 1e-300), r"^equilibrium_path load_factor is 1e-300.*between 1e-09 and 1e\+09"),
        ((arch(), PUSH, 1e30), r"^equilibrium_path load_factor is 1e\+30.*between"),
        (
            (arch(), PUSH, None, (1, "z", 1e30)),
            r"^equilibrium_path displacement value is 1e\+30, more than 1000 times the size",
        ),
        ((arch(), PUSH, 1.0, 3), r"^equilibrium_path displacement is 3; give \(node, component, value\)"),
        ((arch(), PUSH, 1.0, (9, "z", 0.1)), r"^equilibrium_path displacement names node 9.*not exist"),
        ((arch(), PUSH, 1.0, (1, "w", 0.1)), r"^equilibrium_path displacement component is 'w'"),
        ((arch(), PUSH, 1.0, (1, "xz", 0.1)), r"^equilibrium_path displacement names several components"),
        (
            (arch(), PUSH, 1.0, (2, "z", 0.1)),
            r"^equilibrium_path displacement names component 'z' of node 2, which is held",
        ),
        (
            (arch(), PUSH, 1.0, (1, "y", 0.1)),
            r"^equilibrium_path displacement names component 'y' of node 1, which is held",
        ),
        ((arch(), PUSH, 1.0, (1, "z", np.nan)), r"^equilibrium_path displacement value is nan"),
        ((arch(), PUSH, 1.0, None, 0), r"^equilibrium_path max_points is 0"),
        ((arch(), PUSH, 1.0, None, 9, -1.0), r"^equilibrium_path rtol is -1.0"),
    ],
)
def test_bad_input(arguments, message):
    with pytest.raises(ValueError, match=message):
        equilibrium_path(*arguments)


def test_stage_that_comes_after_another():
    rest = Analysis(arch()).run([Stage("rest")])["rest"]
    with pytest.raises(ValueError, match=r"after=None.*path starts.*final state.*'rest'; .*'rest'"):
        equilibrium_path(rest, PUSH)


def test_points_that_are_not_there():
    path = equilibrium_path(arch(), PUSH, max_points=3)
    for number in (3, -4, 0.5):
        with pytest.raises(ValueError, match=rf"^Point {number}.*path.*3 points"):
            path.state(number)


@pytest.mark.mpi
def test_start_that_is_singular():
    flat = sheet(prestress=0.0)
    with pytest.raises(PathError, match=r"no start.*tangent stiffness.*singular: nothing") as error:
        equilibrium_path(flat, Stage("snow", [SNOW]))
    assert error.value.path.points == ()


@pytest.mark.mpi
def test_start_that_is_not_in_equilibrium():
    rest = Analysis(sheet()).run([Stage("rest")])["rest"]
    shape = np.where(rest.actions.held, 0, np.random.default_rng(1).normal(size=POINTS.shape))
    with pytest.raises(PathError, match=r"'snow'.*no start.*equilibrium\. Bring") as error:
        equilibrium_path(replace(rest, displacement=shape), Stage("snow", [SNOW], after="rest"))
    assert error.value.path.points == ()
