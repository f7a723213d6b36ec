"""Rain in two hollows with a ridge between them: each fills, spills over, and both merge.

Reference in closed form: two channels along y under a profile of straight lines, the pits at x = -1 and x = 1, 0 and
0.2 m high, the ridge at x = 0, 0.6 m high, the ends 1 and 0.8 m high. A channel with sides of slopes a and b holds
d^2 (1 / a + 1 / b) / 2 per length up to the depth d. Above the ridge both have one level, up to the lower end. Two
pyramids, 1 and 0.5 m deep, within walls hold 4/3 and 2/3 m3 up to their common rim. Claim: exact to rounding.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Pond,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from wet_roofs import OWN_WEIGHT, ridged_roof

SOURCE = "closed form"

WEIGHT = 9810.0
PROFILE = ([-2, -1, 0, 1, 2], [1.0, 0.0, 0.6, 0.2, 0.8])
WIDTH = 0.25


def run(structure, *stages):
    return Analysis(structure, progress=False).run(stages)


def channels():
    """Two channels, and the nodes of their sides."""
    points, triangles = rectangle(4.0, WIDTH, 16, 1)
    points[:, 2] = np.interp(points[:, 0], *PROFILE)
    made = Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(range(len(points)))])
    return made, np.flatnonzero(np.abs(points[:, 0]) < 1.99)


def left(d):
    return d**2 / 2 * (1 + 1 / 0.6)


def right(d):
    return d**2 / 2 * (1 / 0.4 + 1 / 0.6)


LEFT, RIGHT = left(0.6), right(0.4)  # up to the ridge


def merged(h):
    """Volume per length above the ridge: that below it, and a trapezium."""
    width = 0.6 + 1 + 1 + 0.4 / 0.6
    return LEFT + RIGHT + (h - 0.6) * width + (h - 0.6) ** 2 / 2 * (1 + 1 / 0.6)


@pytest.mark.parametrize("increments", [pytest.param(1, marks=pytest.mark.mpi), 5])
@pytest.mark.parametrize("rain", [0.1, 0.2, 0.25, 0.5])
def test_two_channels(rain, increments, verified):
    made, walls = channels()
    state = run(made, Stage("rain", [Pond("roof", rain=rain, walls=walls)], increments=increments))["rain"]
    pond = state.ponds[0]
    found = sorted((made.points[basin.node, 0], basin.level, basin.volume / WIDTH) for basin in pond.basins)
    kinds = {(event.kind, event.other < 0) for event in state.water_events}
    if rain < 0.25:
        spilt = max(2 * rain - RIGHT, 0.0)
        volumes = 2 * rain + spilt, 2 * rain - spilt
        levels = np.sqrt(2 * volumes[0] / (1 + 1 / 0.6)), 0.2 + np.sqrt(2 * volumes[1] / (1 / 0.4 + 1 / 0.6))
        np.testing.assert_allclose(found, np.transpose([(-1, 1), levels, volumes]), rtol=1e-9)
        assert kinds == ({("spill", False)} if spilt else set())
        verified(f"level of the higher channel under {rain:g} m of rain [m]", levels[1], found[1][1])
    else:
        ((place, level, volume),) = found
        assert place == -1
        full = merged(0.8)
        assert volume == pytest.approx(min(4 * rain, full), rel=1e-12)
        assert merged(level) == pytest.approx(min(4 * rain, full), rel=1e-12)
        assert ("merger", False) in kinds
        assert (("spill", True) in kinds) == (4 * rain > full)
        verified(f"volume of both channels, merged, under {rain:g} m of rain [m3/m]", min(4 * rain, full), volume)
    assert pond.volume + pond.lost == pytest.approx(4 * rain * WIDTH, rel=1e-12)
    assert state.equilibrium.loads[2] == pytest.approx(-WEIGHT * pond.volume, rel=1e-12)


def pyramids():
    """Two inverted pyramids side by side, 1 and 0.5 m deep."""
    points, triangles = rectangle(2.0, 2.0, 6, 6)
    depth = np.abs(points[:, :2]).max(axis=1)
    both = np.concatenate([points - np.eye(3)[0], points + np.eye(3)[0]])
    both[:, 2] = np.concatenate([depth, 0.5 + depth / 2])
    both, places = np.unique(both.round(12), axis=0, return_inverse=True)
    cells = places.ravel()[np.concatenate([triangles, triangles + len(points)])]
    rim = np.unique(boundary_edges(cells))
    roof = {"roof": Membrane(cells, Fabric(1e5, 0.3), 1e3)}
    return Structure(both, roof, [Support(range(len(both)))]), rim


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("rain", "volumes"), [(0.15, (0.6, 0.6)), (0.2, (1.6 - 2 / 3, 2 / 3)), (0.3, (2.4,))], ids=["two", "full", "one"]
)
def test_two_pyramids(rain, volumes):
    made, walls = pyramids()
    state = run(made, Stage("rain", [Pond("roof", rain=rain, walls=walls)]))["rain"]
    basins = sorted(state.ponds[0].basins, key=lambda basin: made.points[basin.node, 0])
    np.testing.assert_allclose([basin.volume for basin in basins], volumes, rtol=1e-9)
    if len(volumes) == 1:
        assert basins[0].level == pytest.approx(1 + 0.4 / 8, rel=1e-12)
    else:
        levels = (0.75 * volumes[0]) ** (1 / 3), 0.5 + 0.5 * (1.5 * volumes[1]) ** (1 / 3)
        np.testing.assert_allclose([basin.level for basin in basins], levels, rtol=1e-9)
    assert state.ponds[0].lost == pytest.approx(0, abs=1e-12)


def test_water_keeps_its_basins_from_stage_to_stage():
    """Rain of two stages on the same cells adds up, with what has run off in the first one lost."""
    made, walls = channels()
    shower, storm = (Pond("roof", rain=rain, walls=walls) for rain in (0.1, 0.1))
    results = run(made, Stage("shower", [shower]), Stage("storm", [storm], after="shower"))
    once = run(made, Stage("at once", [Pond("roof", rain=0.2, walls=walls)]))["at once"].ponds[0]
    for mine, other in zip(results["storm"].ponds[0].basins, once.basins, strict=True):
        np.testing.assert_allclose((mine.level, mine.volume), (other.level, other.volume), rtol=1e-9)


def soft(increments, rain):
    """States of a soft roof in the rain."""
    states = []
    wet = Stage("rain", [Pond("roof", rain=rain)], increments=increments, after="own weight")
    Analysis(ridged_roof(), progress=False).run([OWN_WEIGHT, wet], observe=states.append)
    return states[1:]


@pytest.mark.mpi
def test_energy_balance_along_a_path_of_rain():
    """The energy grows by the work g h dV of the rain that comes in at the level of each basin, in second order."""
    errors = []
    for increments in (4, 8):
        states = soft(increments, 0.02)[increments // 2 - 1 :]  # between equal amounts of rain
        assert not any(state.water_events for state in states)
        volumes = np.array([[basin.volume for basin in state.ponds[0].basins] for state in states])
        levels = np.array([[basin.level for basin in state.ponds[0].basins] for state in states])
        assert (volumes[-1] > 1e-3).sum() == 2
        work = WEIGHT * (np.diff(volumes, axis=0) * (levels[1:] + levels[:-1]) / 2).sum()
        errors.append(states[-1].energy - states[0].energy - work)
    assert abs(errors[-1]) < 1e-3 * abs(work)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)


@pytest.mark.mpi
def test_soft_roof_keeps_its_water():
    """Basins that are full stand at the present height of their rims; all rain is there or has run off."""
    state = soft(2, 0.1)[-1]
    pond = state.ponds[0]
    assert pond.volume + pond.lost == pytest.approx(0.1 * 8, rel=1e-9)
    assert any(basin.is_full for basin in pond.basins)
    for basin in pond.basins:
        if basin.is_full:
            assert basin.level == pytest.approx(state.position[basin.spill, 2], abs=1e-9)
    assert {event.kind for event in state.water_events} == {"merger", "spill"}
    at_once = soft(1, 0.1)[-1]
    assert at_once.ponds[0].volume == pytest.approx(pond.volume, rel=1e-6)
    assert state.equilibrium.loads[2] == pytest.approx(-WEIGHT * pond.volume - 400 * 8, rel=1e-4)
    assert state.equilibrium.residual < 1e-6 * np.abs(state.loads).max()
