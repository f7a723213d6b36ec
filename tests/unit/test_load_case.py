"""Loads and prescribed displacements of stages as actions on nodes and cells."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DeadLoad,
    Fabric,
    Mast,
    Membrane,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary,
    rectangle,
)
from fx_membrane.geometry import normals
from fx_membrane.load_case import between, prescribed, taking_hold, target, unloaded
from fx_membrane.problem import Actions, Problem

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
POINTS[:, 2] = 0.2 * POINTS[:, 0] * POINTS[:, 1] + 0.1 * POINTS[:, 0]  # inclined, no two cells alike
EDGE = np.unique(boundary(TRIANGLES))
COUNT = len(TRIANGLES)
FABRIC = Fabric(Et=1e5, nu=0.3)


def sheet(triangles=TRIANGLES, points=POINTS, supports=(Support(EDGE),)):
    return Structure(points, {"fabric": Membrane(triangles, FABRIC, prestress=1e3)}, supports)


def flipped(seed, keep=0):
    """The triangles, some with their nodes in the other sense; that of one of them is kept."""
    triangles = TRIANGLES.copy()
    flip = np.random.default_rng(seed).random(COUNT) < 0.5
    flip[keep] = False
    assert 5 < np.count_nonzero(flip) < COUNT - 5
    triangles[flip] = triangles[flip][:, ::-1]
    return triangles


@pytest.fixture(scope="module")
def problem():
    return Problem(sheet())


def end(problem, *loads, start=None):
    """Actions at the end of a stage with these loads."""
    start = unloaded(problem.discretization.structure) if start is None else start
    return target(problem, Stage("loads", loads), start)


# Loads per plan area


@pytest.mark.parametrize("slope", [0.0, 1.0, -3.0])
def test_plan_load_on_an_inclined_sheet_is_that_on_its_plan(slope):
    points, triangles = rectangle(2.0, 3.0, 3, 2)
    points[:, 2] = slope * points[:, 0]
    problem = Problem(sheet(triangles, points, ()))
    loads = end(problem, PlanLoad((1.0, 2.0, -500.0), "fabric")).loads
    assert loads.sum(axis=0) == pytest.approx(6.0 * np.array([1, 2, -500]), rel=1e-13)
    flat = Problem(sheet(triangles, points * [1, 1, 0], ()))
    assert loads == pytest.approx(end(flat, DeadLoad((1.0, 2.0, -500.0), "fabric")).loads, rel=1e-13)


def test_plan_load_does_not_see_a_wall():
    points = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, 1], [1, 1, 1]]
    problem = Problem(sheet([[0, 1, 2], [1, 2, 3], [2, 4, 3]], points, ()))
    loads = end(problem, PlanLoad((0, 0, -6.0), "fabric")).loads
    assert loads[:, 2] == pytest.approx([-1, -1, -1, 0, 0], abs=1e-15)


@pytest.mark.parametrize("seed", [1, 2])
def test_plan_load_does_not_depend_on_the_sense_of_the_cells(problem, seed):
    snow = PlanLoad((0, 0, -500.0), "fabric", range(3, 20))
    turned = Problem(sheet(flipped(seed)))
    assert end(turned, snow).loads == pytest.approx(end(problem, snow).loads, rel=1e-13, abs=1e-12)


def test_plan_load_on_some_cells(problem):
    cells = [0, 5, 7]
    plan = sheet().points * [1, 1, 0]
    area = 0.125  # of each cell in plan
    assert np.linalg.norm(np.cross(*np.diff(plan[TRIANGLES[0]], axis=0))) / 2 == pytest.approx(area)
    loads = end(problem, PlanLoad((0, 0, -8.0), "fabric", cells)).loads
    assert loads[:, 2].sum() == pytest.approx(-8.0 * 3 * area, rel=1e-13)
    assert not np.delete(loads, np.unique(TRIANGLES[cells]), axis=0).any()


def test_dead_and_plan_loads_add_up(problem):
    snow, weight, point = (
        PlanLoad((0, 0, -500.0), "fabric"),
        DeadLoad((0, 3.0, -10.0), "fabric"),
        PointLoad(7, (1, 2, 3)),
    )
    apart = sum(end(problem, load).loads for load in (snow, weight, point))
    assert end(problem, snow, weight, point).loads == pytest.approx(apart, rel=1e-13, abs=1e-12)


# Pressure


def test_pressure_is_positive_along_the_normals_of_the_structure():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    for cells, sign in [(triangles, 1.0), (triangles[:, ::-1], -1.0)]:
        structure = sheet(cells, points)
        assert structure.normals("fabric") == pytest.approx(np.tile([0, 0, sign], (COUNT, 1)))
        inflated = Analysis(structure).run([Stage("air", [Pressure(300.0, "fabric")], steps=2)])["air"]
        assert sign * inflated.displacement[12, 2] > 0.05
        # The vector area of a surface depends on its rim alone, and the rim does not move.
        assert inflated.loads.sum(axis=0) == pytest.approx([0, 0, sign * 300.0 * 4.0], abs=1e-9 * 1200)


def test_pressure_acts_along_the_current_normals():
    pressure = np.linspace(100.0, 500.0, COUNT)
    structure = sheet()
    loads = [Pressure(value, "fabric", cell) for cell, value in enumerate(pressure)]
    result = Analysis(structure).run([Stage("air", loads)])["air"]
    side = np.diff(result.position[TRIANGLES], axis=1)
    forces = pressure[:, None] * np.cross(side[:, 0], side[:, 1]) / 2
    expected = np.zeros(POINTS.shape)
    for corner in TRIANGLES.T:
        np.add.at(expected, corner, forces / 3)
    assert np.abs(result.displacement).max() > 0.01
    assert result.loads == pytest.approx(expected, abs=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_pressure_does_not_depend_on_the_sense_of_the_cells(seed):
    stages = [Stage("air", [Pressure(300.0, "fabric"), Pressure(200.0, "fabric", range(4, 17))])]
    expected = Analysis(sheet()).run(stages)["air"]
    found = Analysis(sheet(flipped(seed))).run(stages)["air"]
    largest = np.abs(expected.displacement).max()
    assert largest > 0.01
    assert found.displacement == pytest.approx(expected.displacement, abs=1e-9 * largest)
    assert found.loads == pytest.approx(expected.loads, abs=1e-9 * np.abs(expected.loads).max())


def test_pressure_of_cells_in_their_own_sense():
    triangles = flipped(1)
    structure = sheet(triangles)
    acting = end(Problem(structure), Pressure(300.0, "fabric")).pressures["fabric"]
    own = normals(POINTS, triangles)
    assert acting[:, None] * own == pytest.approx(300.0 * structure.normals("fabric"), rel=1e-13)
    assert len(np.unique(acting)) == 2


def test_pressures_add_up(problem):
    actions = end(problem, Pressure(300.0, "fabric"), Pressure(-100.0, "fabric", [2, 7]), Pressure(-100.0, "fabric", 7))
    expected = np.full(COUNT, 300.0)
    expected[2], expected[7] = 200.0, 100.0
    assert actions.pressures["fabric"].tolist() == expected.tolist()
    assert not actions.loads.any()


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
    results = Analysis(sheet()).run(stages)
    for name in ("gust", "snow"):
        expected = results[f"{name} at once"].displacement
        assert results[name].displacement == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())
    assert not results["rest"].loads.any()
    assert np.abs(results["gust"].displacement - results["air"].displacement).max() > 1e-3


def test_pressure_on_a_one_sided_membrane_is_refused():
    n = 12
    angle = 2 * np.pi * np.arange(n) / n
    half = 0.3 * np.stack([np.cos(angle / 2) * np.cos(angle), np.cos(angle / 2) * np.sin(angle), np.sin(angle / 2)], 1)
    middle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([middle - half, middle + half])
    low, high = np.arange(n), n + np.arange(n)
    next_low, next_high = np.roll(low, -1), np.roll(high, -1)
    next_low[-1], next_high[-1] = high[0], low[0]  # half a turn
    strip = np.concatenate([np.stack([low, next_low, next_high], 1), np.stack([low, next_high, high], 1)])
    structure = sheet(strip, points, [Support(range(2 * n))])
    analysis = Analysis(structure)
    analysis.run([Stage("weight", [DeadLoad((0, 0, -1.0), "fabric")])])
    analysis._solve = None  # refused before anything is solved
    with pytest.raises(ValueError, match=r"^Part 'fabric' has only one side, like a Moebius strip"):
        analysis.run([Stage("rest"), Stage("air", [Pressure(1.0, "fabric")])])


# Prescribed displacements


def held_at(**moves):
    entries = [PrescribedDisplacement(**move) for move in moves.values()]
    return prescribed(Stage("lift", displacements=entries), sheet())


def test_prescribed_components_and_values():
    held, displacement = held_at(
        a={"nodes": [6, 12], "displacement": [(1.0, 2, 3), (4, 5, 6)], "components": "zx"},
        b={"nodes": 12, "displacement": (9.0, 7, 9), "components": "y"},
    )
    assert np.argwhere(held).tolist() == [[6, 0], [6, 2], [12, 0], [12, 1], [12, 2]]
    assert displacement[6].tolist() == [1, 0, 3]
    assert displacement[12].tolist() == [4, 7, 6]


def test_support_may_be_prescribed_where_it_is():
    held, displacement = held_at(a={"nodes": 0, "displacement": (0.0, 0, 0)})
    assert held[0].all()
    assert not displacement.any()


@pytest.mark.parametrize(
    ("moves", "message"),
    [
        (
            {"a": {"nodes": [12, 4], "displacement": (0, 0, 0.1)}},
            r"^Stage 'lift' moves node 4 by 0\.1 along z, where it is already held at 0; remove the support",
        ),
        (
            {"a": {"nodes": 4, "displacement": (0, -2.5, 0), "components": "y"}},
            r"node 4 by -2\.5 along y, where it is already held at 0;",
        ),
        (
            {
                "a": {"nodes": [11, 12], "displacement": (0, 0, 0.1)},
                "b": {"nodes": [12, 13], "displacement": (0, 0, 0.2)},
            },
            r"node 12 by 0\.2 along z, where it is already held at 0\.1;",
        ),
        (
            {"a": {"nodes": [12, 12], "displacement": [(0, 0, 0.1), (0, 0, 0.2)]}},
            r"node 12 by 0\.[12] along z, where it is already held at 0\.[12];",
        ),
    ],
    ids=["support", "one component of a support", "two entries", "a node twice in one entry"],
)
def test_clash_of_prescribed_displacements(moves, message):
    with pytest.raises(ValueError, match=message):
        held_at(**moves)


def test_clash_is_found_before_anything_is_solved():
    stages = [Stage("rest"), Stage("lift", displacements=[PrescribedDisplacement(0, (0, 0, 0.1))], after="rest")]
    calls = []
    analysis = Analysis(sheet())
    analysis._solve = lambda *arguments: calls.append(arguments)
    with pytest.raises(ValueError, match=r"^Stage 'lift' moves node 0"):
        analysis.run(stages)
    assert not calls


def test_same_value_twice_is_no_clash():
    held, displacement = held_at(
        a={"nodes": [11, 12], "displacement": (0, 0, 0.1)}, b={"nodes": [12, 13], "displacement": (0, 0, 0.1)}
    )
    assert displacement[[11, 12, 13], 2].tolist() == [0.1] * 3
    assert held[[11, 12, 13]].all()


# Between start and end


def actions(seed, held, **pressures):
    rng = np.random.default_rng(seed)
    return Actions(rng.normal(size=(4, 3)), held, rng.normal(size=(4, 3)), pressures)


HELD_BEFORE = np.eye(4, 3, dtype=bool)
HELD_AFTER = HELD_BEFORE | (np.arange(12).reshape(4, 3) == 10)


@pytest.mark.parametrize("factor", [0.0, 0.25, 1.0])
def test_between_is_linear(factor):
    start = actions(1, HELD_BEFORE, fabric=np.array([1.0, 2.0]))
    finish = actions(2, HELD_AFTER, fabric=np.array([3.0, 6.0]), roof=np.array([8.0]))
    here = between(start, finish, factor)
    assert here.loads == pytest.approx((1 - factor) * start.loads + factor * finish.loads, rel=1e-14, abs=1e-14)
    expected = (1 - factor) * start.displacement + factor * finish.displacement
    assert here.displacement == pytest.approx(expected, rel=1e-14, abs=1e-14)
    assert here.pressures["fabric"] == pytest.approx([1 + 2 * factor, 2 + 4 * factor])
    assert here.pressures["roof"] == pytest.approx([8 * factor])
    assert np.array_equal(here.held, HELD_AFTER)


def test_taking_hold_starts_from_where_the_node_is():
    start, finish = actions(1, HELD_BEFORE), actions(2, HELD_AFTER)
    shape = np.random.default_rng(3).normal(size=(4, 3))
    begin = taking_hold(start, finish, shape)
    assert np.array_equal(begin.held, HELD_AFTER)
    assert np.array_equal(begin.displacement[HELD_BEFORE], start.displacement[HELD_BEFORE])
    assert begin.displacement[3, 1] == shape[3, 1]
    assert np.array_equal(begin.loads, start.loads)


def test_unloaded_holds_the_supports_only():
    structure = sheet()
    nothing = unloaded(structure)
    assert np.flatnonzero(nothing.held.all(axis=1)).tolist() == EDGE.tolist()
    assert not nothing.loads.any()
    assert not nothing.displacement.any()
    assert nothing.pressures == {}


@pytest.mark.parametrize("load", [PlanLoad((0, 0, -1.0), "bar"), Pressure(1.0, "bar")])
def test_surface_load_on_a_bar_is_refused(load):
    structure = Structure([[0.0, 0, 0], [1, 0, 0]], {"bar": Mast([[0, 1]], 1e6)}, [Support([0, 1])])
    with pytest.raises(ValueError, match=rf"^Stage 'loads' has a {type(load).__name__} on 'bar', not a membrane"):
        Analysis(structure).run([Stage("loads", [load])])
