"""Check of every stage whether water runs off: slopes, hollows, drains, and surfaces that do not lie."""

import re

import numpy as np
import pytest

from cushions import airbag, double_cushion
from fx_membrane import Analysis, Chamber, Fabric, Membrane, PlanLoad, Pond, Stage, Structure, Support, rectangle
from fx_membrane.results.check import Verdict
from fx_membrane.results.state_checks import checks


def roof(shape):
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = shape(*points[:, :2].T)
    return Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(range(25))])


def found(structure, *loads, unit=""):
    state = Analysis(structure, progress=False).run([Stage("rest", loads)])["rest"]
    return [check for check in checks(state, length=unit) if "water" in check.name]


@pytest.mark.parametrize(
    ("shape", "verdict"),
    [
        (lambda x, y: 0.1 * x, Verdict.PASS),
        (lambda x, y: 0 * x, Verdict.PASS),
        (lambda x, y: 0.2 * (x**2 + y**2), Verdict.WARN),
        (lambda x, y: -0.2 * (x**2 + y**2), Verdict.PASS),
    ],
    ids=["slope", "level", "bowl", "dome"],
)
def test_hollows_are_told(shape, verdict):
    (check,) = found(roof(shape))
    assert check.verdict is verdict
    assert check.design
    if verdict is Verdict.WARN:
        assert "node 12" in check.place
        assert check.found == "0.2 deep"


def test_numbers_have_the_unit_of_length():
    bowl = roof(lambda x, y: 0.2 * (x**2 + y**2))
    shown = [*found(bowl, unit="ft"), *found(bowl, Pond("roof", rain=0.5), unit="ft")]
    numbers = {check.name: (check.found, check.limit) for check in shown}
    assert numbers["water would stand on 'roof'"][0].endswith(" ft deep")
    assert numbers["water run off 'roof'"][0].endswith(" ft3")
    assert all(limit.endswith(" ft") for _, limit in numbers.values() if limit)
    off = next(check for check in shown if check.name.startswith("water run off"))
    assert re.search(r"level [\d.]+ ft ", off.remedy)


def test_hollow_under_snow_is_told():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1)
    made = Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(rim)])
    assert found(made)[0].verdict is Verdict.PASS
    assert found(made, PlanLoad((0, 0, -500.0), "roof"))[0].verdict is Verdict.WARN


def test_drains_of_a_pond_count():
    bowl = roof(lambda x, y: 0.2 * (x**2 + y**2))
    check, off = found(bowl, Pond("roof", rain=0.5, drains=[12]))
    assert check.verdict is Verdict.PASS
    assert float(off.found) == pytest.approx(2.0, rel=1e-2)
    assert "node 12" in off.place
    assert "level 0 " in off.remedy


def test_water_over_the_rim_tells_the_place_and_the_level():
    bowl = roof(lambda x, y: 0.2 * (x**2 + y**2) + 0.01 * x)
    *_, off = found(bowl, Pond("roof", rain=0.5))
    assert "node 10" in off.place  # the middle of the side at x = -1
    assert "level 0.19 " in off.remedy


@pytest.mark.mpi
def test_drain_that_sinks_takes_the_level_with_it():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1)
    flat = Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(rim)])
    stages = [
        Stage("snow", [PlanLoad((0, 0, -500.0), "roof")]),
        Stage("rain", [Pond("roof", rain=0.5, drains=[11])], after="snow"),
    ]
    state = Analysis(flat, progress=False).run(stages)["rain"]
    pond = state.ponds[0]
    assert pond.level == pytest.approx(state.position[11, 2], rel=1e-9)
    assert pond.depth[11] == pytest.approx(0, abs=1e-10)
    assert pond.volume > 0.005
    run_off = next(check for check in checks(state) if check.name.startswith("water run off"))
    assert "node 11" in run_off.place
    assert float(run_off.found) == pytest.approx(2.0 - pond.volume, rel=1e-2)


def test_rim_that_sinks_below_a_given_level_is_told():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = 0.2 * (points[:, 0] ** 2 + points[:, 1] ** 2)
    corners = np.flatnonzero(np.abs(points[:, :2]).min(axis=1) == 1)
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1)
    parts = {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}
    bowl = Structure(points, parts, [Support(corners), Support(rim, "xy")])
    state = Analysis(bowl, progress=False).run([Stage("water", [Pond("roof", level=0.18)])])["water"]
    over = next(check for check in checks(state, length="m") if check.name.startswith("water over the rim"))
    assert over.verdict is Verdict.WARN
    assert over.found.endswith(" m")
    assert over.limit.endswith(" m")
    held = found(roof(lambda x, y: 0.2 * (x**2 + y**2)), Pond("roof", rain=0.5))
    assert not any(check.name.startswith("water over the rim") for check in held)


def test_wall_is_not_judged():
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    wall = Structure(points[:, [0, 2, 1]], {"wall": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(range(9))])
    assert not found(wall)


def test_drain_of_a_pond_on_some_cells_counts():
    """A drain at the lowest node dries the bowl, also where its pond has cells of its own."""
    made = roof(lambda x, y: 0.2 * (x**2 + y**2))
    triangles = made.parts["roof"].cells
    middle = np.flatnonzero((np.abs(made.points[triangles].mean(axis=1)[:, :2]) < 0.5).all(axis=1))
    for drains, verdict in ([], Verdict.WARN), ([12], Verdict.PASS):
        pond = Pond("roof", rain=0.01, cells=middle, drains=drains)
        check = next(check for check in found(made, pond) if "would stand" in check.name)
        assert check.verdict is verdict


@pytest.mark.parametrize("loads", [(), (Pond("bottom", rain=1e-3),)], ids=["dry", "a pond is given"])
def test_no_rain_falls_into_a_cushion(loads):
    """The bottom film is a bowl, but under the top one; a pond on it is the user's word."""
    names = [check.name for check in found(airbag(), *loads)]
    assert "water would stand on 'top'" in names
    assert ("water would stand on 'bottom'" in names) == bool(loads)


def test_no_rain_falls_on_the_wall_between_two_chambers():
    double = double_cushion({"upper": Chamber({"top": 1, "wall": -1}), "lower": Chamber({"wall": 1, "low": -1})})
    assert [check.name for check in found(double)] == ["water would stand on 'top'"]


def test_rain_falls_on_a_hall():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = 0.5 - 0.2 * (points[:, 0] ** 2 + points[:, 1] ** 2)
    points[np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1), 2] = 0
    points[12, 2] = 0.1
    hall = {"air": Chamber("roof", rigid_walls=True)}
    rim = [Support(range(25))]
    made = Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, rim, chambers=hall)
    (check,) = found(made)
    assert check.verdict is Verdict.WARN
    assert "node 12" in check.place
