"""Bound on the iterations of Newton's method for one try of a load increment, those of all strategies together."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)
from fx_membrane.assembly.actions import unloaded
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.outcome import Outcome
from hard_structures import FABRIC, hanging, pulled


def iterations(structure, stages, solver):
    """Count the iterations of a solve from rest, and those that it tells; return them with its solution."""
    problem = Problem(structure)
    loaded = problem.under(problem.actions_of(stages[0], unloaded(structure)))
    numbers = []
    solution = solver.prepare(problem)(loaded, problem.create_vector(), lambda number, _: numbers.append(number))
    told = len(solution.iterations) - 1 + solution.extra_iterations
    return sum(number > 0 for number in numbers), told, solution


FEW = [pytest.param(most, marks=pytest.mark.mpi) for most in (1, 7)]


@pytest.mark.parametrize("line_search", [True, False])
@pytest.mark.parametrize("most", [*FEW, 60, 300])
def test_total_of_all_strategies_is_bounded(most, line_search):
    """A sheet twisted out of its plane: a first attempt, the homotopy and the attempt after it take 460 iterations."""
    structure, stages = pulled(-0.1, 0.6, 0.0, FABRIC, 8)
    taken, told, solution = iterations(structure, stages, Newton(1e-10, most, line_search))
    assert not solution.converged
    assert taken <= most
    assert told == taken
    if line_search:
        assert taken == most


def test_first_attempt_leaves_iterations_to_the_homotopy():
    structure, stages = pulled(-0.1, 0.6, 0.0, FABRIC, 8)
    taken, _, solution = iterations(structure, stages, Newton())
    assert solution.converged
    assert 200 < taken <= Newton().max_iterations


def test_escapes_from_saddles_count():
    """A straight strut under a load above Euler's: equilibrium after one iteration, then the escape."""
    x = np.linspace(0, 1, 5)
    points = np.column_stack([x, 0 * x, 0 * x])
    strut = Cable(np.column_stack([range(4), range(1, 5)]), 1e4, compression_stiffness=1.0)
    structure = Structure(points, {"strut": strut}, [Support(0), Support(range(5), "y"), Support(4, "z")])
    stages = [Stage("push", [PointLoad(4, (-10.0, 0, 0))])]
    needed, told, solution = iterations(structure, stages, Newton())
    assert solution.converged
    assert told == needed > 3
    for most in (*range(1, 8), needed // 2, needed):
        taken, told, _ = iterations(structure, stages, Newton(max_iterations=most))
        assert told == taken <= most


@pytest.mark.mpi
def test_each_halved_increment_has_the_whole_number(steps):
    structure, stages = pulled(-0.1, 0.6, 0.0, FABRIC, 8)
    with pytest.raises(ConvergenceError):
        Analysis(structure, Newton(max_iterations=2)).run(stages)
    assert steps[0] == 0  # of a solver that is made
    assert len(steps) == 1 + 1 + 8
    assert max(steps) == 2


def pushed_in():
    """Return a flat sheet without prestress: one edge is pushed in, and its weight gives it a shape that holds."""
    points, triangles = rectangle(2.0, 2.0, 6, 6)
    edge, pushed = np.flatnonzero(points[:, 0] < -0.99), np.flatnonzero(points[:, 0] > 0.99)
    points[:, 2] = 1e-6 * np.random.default_rng(0).normal(size=len(points))
    structure = Structure(points, {"sheet": Membrane(triangles, Fabric(5e5, 0.3))}, [Support(edge)])
    weight = [DistributedLoad((0, 0, -1.0), part="sheet")]
    return structure, [Stage("push", weight, displacements=[PrescribedDisplacement(pushed, (-0.4, 0.0, 0.0))])]


def test_start_with_a_free_motion_is_no_mechanism_where_iterations_run_out():
    structure, stages = pushed_in()
    assert iterations(structure, stages, Newton())[2].converged
    *_, solution = iterations(structure, stages, Newton(max_iterations=20))
    assert solution.outcome is Outcome.MAX_ITERATIONS
    assert solution.outcome.retry
    assert solution.motion is not None
    more, mechanism = (solution.reason.index(words) for words in ("Newton(max_iterations=...)", "is a mechanism"))
    assert more < mechanism


@pytest.mark.parametrize("most", [60, 110])
def test_smaller_increments_need_fewer_iterations(most):
    structure, stages = pushed_in()
    result = Analysis(structure, Newton(max_iterations=most)).run(stages)["push"]
    assert len(result.increments) > 1
    assert all(len(increment.iterations) <= 1 + most for increment in result.increments)
    assert result.increments[-1].load_factor == 1


def test_failure_in_each_increment_tells_of_the_iterations_first():
    structure, stages = pushed_in()
    with pytest.raises(ConvergenceError, match=r"the iterations ran out .*20 are.*max_iterations.*is a mechanism"):
        Analysis(structure, Newton(max_iterations=20)).run(stages)


@pytest.mark.parametrize("most", [10, 20, 60])
def test_cable_that_falls_is_no_mechanism_where_iterations_run_out(most):
    """It hangs down by most of its length, and needs 21 iterations."""
    *_, solution = iterations(*hanging(2.0, 1e3), Newton(max_iterations=most))
    assert solution.outcome is (Outcome.MAX_ITERATIONS if most < 21 else Outcome.CONVERGED)
    if most < 21:
        assert re.match(rf"the iterations ran out \(at most {most} are .* is a mechanism", solution.reason)


@pytest.mark.mpi
def test_structure_that_has_fallen_is_a_mechanism_where_iterations_are_left():
    """Two hinged masts with a cable between their tops are pushed aside."""
    points = [[0.0, 0, 0], [4, 0, 0], [0, 0, 3], [4, 0, 3]]
    parts = {"masts": Mast([[0, 2], [1, 3]], 1e6), "tie": Cable([[2, 3]], 1e5)}
    structure = Structure(points, parts, [Support([0, 1]), Support([2, 3], "y")])
    with pytest.raises(ConvergenceError, match="the structure is a mechanism") as error:
        Analysis(structure, Newton(max_iterations=60)).run([Stage("push", [PointLoad(2, (10.0, 0, 0))])])
    assert error.value.failed.outcome is Outcome.MECHANISM
    assert error.value.failed.load_factor == 1
