"""Loads and prescribed displacements of stages as actions on nodes and cells."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Mast,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    rectangle,
)
from fx_membrane.assembly.actions import Actions, between, unloaded, with_constraints_of
from fx_membrane.assembly.load_cases import prescribed
from fx_membrane.assembly.problem import Problem
from models import EDGE, TRIANGLES, end, flipped, inclined_sheet, sheet


@pytest.fixture(scope="module")
def problem():
    return Problem(inclined_sheet())


# Loads per plan area


@pytest.mark.mpi_once
@pytest.mark.parametrize("slope", [0.0, 1.0, -3.0])
def test_plan_load_on_an_inclined_sheet_is_that_on_its_plan(slope):
    points, triangles = rectangle(2.0, 3.0, 3, 2)
    points[:, 2] = slope * points[:, 0]
    problem = Problem(sheet(points=points, triangles=triangles))
    loads = end(problem, PlanLoad((1.0, 2.0, -500.0), "fabric")).loads
    assert loads.sum(axis=0) == pytest.approx(6.0 * np.array([1, 2, -500]), rel=1e-13)
    flat = Problem(sheet(points=points * [1, 1, 0], triangles=triangles))
    assert loads == pytest.approx(end(flat, DistributedLoad((1.0, 2.0, -500.0), "fabric")).loads, rel=1e-13)


def test_plan_load_does_not_see_a_wall():
    points = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 0, 1], [1, 1, 1]]
    problem = Problem(sheet(points=points, triangles=[[0, 1, 2], [1, 2, 3], [2, 4, 3]]))
    loads = end(problem, PlanLoad((0, 0, -6.0), "fabric")).loads
    assert loads[:, 2] == pytest.approx([-1, -1, -1, 0, 0], abs=1e-15)


@pytest.mark.parametrize("seed", [1, 2])
def test_plan_load_does_not_depend_on_the_sense_of_the_cells(problem, seed):
    snow = PlanLoad((0, 0, -500.0), "fabric", range(3, 20))
    turned = Problem(inclined_sheet(flipped(seed)))
    assert end(turned, snow).loads == pytest.approx(end(problem, snow).loads, rel=1e-13, abs=1e-12)


def test_plan_load_on_some_cells(problem):
    cells = [0, 5, 7]
    plan = inclined_sheet().points * [1, 1, 0]
    area = 0.125  # of each cell in plan
    assert np.linalg.norm(np.cross(*np.diff(plan[TRIANGLES[0]], axis=0))) / 2 == pytest.approx(area)
    loads = end(problem, PlanLoad((0, 0, -8.0), "fabric", cells)).loads
    assert loads[:, 2].sum() == pytest.approx(-8.0 * 3 * area, rel=1e-13)
    assert not np.delete(loads, np.unique(TRIANGLES[cells]), axis=0).any()


def test_dead_and_plan_loads_add_up(problem):
    snow, weight, point = (
        PlanLoad((0, 0, -500.0), "fabric"),
        DistributedLoad((0, 3.0, -10.0), "fabric"),
        PointLoad(7, (1, 2, 3)),
    )
    apart = sum(end(problem, load).loads for load in (snow, weight, point))
    assert end(problem, snow, weight, point).loads == pytest.approx(apart, rel=1e-13, abs=1e-12)


# Prescribed displacements


def held_at(**moves):
    entries = [PrescribedDisplacement(**move) for move in moves.values()]
    return prescribed(Stage("lift", displacements=entries), inclined_sheet())


@pytest.mark.mpi
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
            r"^Stage 'lift' moves node 4.*0\.1 along z.*held.*0; remove.*support",
        ),
        (
            {"a": {"nodes": 4, "displacement": (0, -2.5, 0), "components": "y"}},
            r"node 4.*-2\.5 along y.*held.*0",
        ),
        (
            {
                "a": {"nodes": [11, 12], "displacement": (0, 0, 0.1)},
                "b": {"nodes": [12, 13], "displacement": (0, 0, 0.2)},
            },
            r"node 12.*0\.2 along z.*held.*0\.1",
        ),
        (
            {"a": {"nodes": [12, 12], "displacement": [(0, 0, 0.1), (0, 0, 0.2)]}},
            r"node 12.*0\.[12] along z.*held.*0\.[12]",
        ),
    ],
    ids=["support", "one component of a support", "two entries", "a node twice in one entry"],
)
def test_clash_of_prescribed_displacements(moves, message):
    with pytest.raises(ValueError, match=message):
        held_at(**moves)


@pytest.mark.mpi
def test_clash_is_found_before_anything_is_solved(monkeypatch):
    stages = [Stage("rest"), Stage("lift", displacements=[PrescribedDisplacement(0, (0, 0, 0.1))], after="rest")]
    calls = []
    analysis = Analysis(inclined_sheet())
    monkeypatch.setattr(analysis, "_solve", lambda *arguments: calls.append(arguments))
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


@pytest.mark.mpi_once
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


@pytest.mark.mpi
def test_taking_hold_starts_from_where_the_node_is():
    start, finish = actions(1, HELD_BEFORE), actions(2, HELD_AFTER)
    shape = np.random.default_rng(3).normal(size=(4, 3))
    begin = with_constraints_of(start, finish, shape)
    assert np.array_equal(begin.held, HELD_AFTER)
    assert np.array_equal(begin.displacement[HELD_BEFORE], start.displacement[HELD_BEFORE])
    assert begin.displacement[3, 1] == shape[3, 1]
    assert np.array_equal(begin.loads, start.loads)


def test_unloaded_holds_the_supports_only():
    structure = inclined_sheet()
    nothing = unloaded(structure)
    assert np.flatnonzero(nothing.held.all(axis=1)).tolist() == EDGE.tolist()
    assert not nothing.loads.any()
    assert not nothing.displacement.any()
    assert nothing.pressures == {}


@pytest.mark.parametrize("load", [PlanLoad((0, 0, -1.0), "bar"), Pressure(1.0, "bar")])
def test_surface_load_on_a_bar_is_refused(load):
    structure = Structure([[0.0, 0, 0], [1, 0, 0]], {"bar": Mast([[0, 1]], 1e6)}, [Support([0, 1])])
    with pytest.raises(ValueError, match=rf"^Stage 'loads'.*{type(load).__name__}.*'bar'.*Mast.*acts.*membranes"):
        Analysis(structure).run([Stage("loads", [load])])
