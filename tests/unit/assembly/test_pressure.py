"""Follower pressure: along the current normals, on one side, added from stage to stage."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    PlanLoad,
    Pressure,
    Stage,
    Support,
    rectangle,
)
from fx_membrane.assembly.problem import Problem
from models import INCLINED, TRIANGLES, end, flipped, inclined_sheet, sheet

COUNT = len(TRIANGLES)


@pytest.fixture(scope="module")
def problem():
    return Problem(inclined_sheet())


def test_pressure_is_positive_along_the_normals_of_the_structure():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    for cells, sign in [(triangles, 1.0), (triangles[:, ::-1], -1.0)]:
        structure = sheet(points=points, triangles=cells)
        assert structure.normals("fabric") == pytest.approx(np.tile([0, 0, sign], (COUNT, 1)))
        inflated = Analysis(structure).run([Stage("air", [Pressure(300.0, "fabric")], increments=2)])["air"]
        assert sign * inflated.displacement[12, 2] > 0.05
        # The vector area of a surface depends on its rim alone, and the rim does not move.
        assert inflated.loads.sum(axis=0) == pytest.approx([0, 0, sign * 300.0 * 4.0], abs=1e-9 * 1200)


@pytest.mark.mpi
def test_pressure_acts_along_the_current_normals():
    pressure = np.linspace(100.0, 500.0, COUNT)
    structure = inclined_sheet()
    loads = [Pressure(value, "fabric", cell) for cell, value in enumerate(pressure)]
    result = Analysis(structure).run([Stage("air", loads)])["air"]
    side = np.diff(result.position[TRIANGLES], axis=1)
    forces = pressure[:, None] * np.cross(side[:, 0], side[:, 1]) / 2
    expected = np.zeros(INCLINED.shape)
    for corner in TRIANGLES.T:
        np.add.at(expected, corner, forces / 3)
    assert np.abs(result.displacement).max() > 0.01
    assert result.loads == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_pressure_does_not_depend_on_the_sense_of_the_cells(seed):
    stages = [Stage("air", [Pressure(300.0, "fabric"), Pressure(200.0, "fabric", range(4, 17))])]
    expected = Analysis(inclined_sheet()).run(stages)["air"]
    found = Analysis(inclined_sheet(flipped(seed))).run(stages)["air"]
    largest = np.abs(expected.displacement).max()
    assert largest > 0.01
    assert found.displacement == pytest.approx(expected.displacement, abs=1e-9 * largest)
    assert found.loads == pytest.approx(expected.loads, abs=1e-9 * np.abs(expected.loads).max())


def test_pressure_keeps_its_sign_on_cells_that_were_turned():
    acting = end(Problem(inclined_sheet(flipped(1))), Pressure(300.0, "fabric")).pressures["fabric"]
    assert acting.tolist() == [300.0] * COUNT


@pytest.mark.mpi
def test_pressures_add_up(problem):
    actions = end(problem, Pressure(300.0, "fabric"), Pressure(-100.0, "fabric", [2, 7]), Pressure(-100.0, "fabric", 7))
    expected = np.full(COUNT, 300.0)
    expected[2], expected[7] = 200.0, 100.0
    assert actions.pressures["fabric"].tolist() == expected.tolist()
    assert not actions.loads.any()


@pytest.mark.mpi
def test_branches_keep_the_pressure_of_their_parent_and_do_not_change_it(problem):
    parent = end(problem, Pressure(300.0, "fabric"))
    wind = end(problem, Pressure(50.0, "fabric", 3), start=parent)
    snow = end(problem, PlanLoad((0, 0, -1.0), "fabric"), start=parent)
    assert parent.pressures["fabric"].tolist() == snow.pressures["fabric"].tolist() == [300.0] * COUNT
    assert wind.pressures["fabric"].tolist() == [350.0 if cell == 3 else 300.0 for cell in range(COUNT)]
    assert not wind.loads.any()
    assert snow.loads.any()


def test_results_of_branches_have_the_pressure_of_their_parent():
    air, snow = Pressure(300.0, "fabric"), PlanLoad((0, 0, -100.0), "fabric")
    stages = [
        Stage("air", [air]),
        Stage("gust", [Pressure(200.0, "fabric")], after="air"),
        Stage("snow", [snow], after="air"),
        Stage("rest"),
        Stage("gust at once", [Pressure(500.0, "fabric")]),
        Stage("snow at once", [snow, air]),
    ]
    results = Analysis(inclined_sheet()).run(stages)
    for name in ("gust", "snow"):
        expected = results[f"{name} at once"].displacement
        assert results[name].displacement == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert not results["rest"].loads.any()
    assert np.abs(results["gust"].displacement - results["air"].displacement).max() > 1e-3


def test_pressure_on_a_one_sided_membrane_is_refused(monkeypatch):
    n = 12
    angle = 2 * np.pi * np.arange(n) / n
    half = 0.3 * np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)], 1)
    middle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([middle - half, middle + half])
    low, high = np.arange(n), n + np.arange(n)
    next_low, next_high = np.roll(low, -1), np.roll(high, -1)
    next_low[-1], next_high[-1] = high[0], low[0]  # half a turn
    strip = np.concatenate([np.stack([low, next_low, next_high], 1), np.stack([low, next_high, high], 1)])
    structure = sheet(Support(range(2 * n)), points=points, triangles=strip)
    analysis = Analysis(structure)
    analysis.run([Stage("weight", [DistributedLoad((0, 0, -1.0), "fabric")])])
    monkeypatch.setattr(analysis, "_solve", None)  # refused before anything is solved
    with pytest.raises(ValueError, match=r"^Part 'fabric'.*one side.*Moebius strip"):
        analysis.run([Stage("rest"), Stage("air", [Pressure(1.0, "fabric")])])
