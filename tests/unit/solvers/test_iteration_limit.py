"""Bound on the iterations of Newton's method for one try of a load increment, those of all strategies together."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, ConvergenceError, Newton, PointLoad, Stage, Structure, Support
from fx_membrane.assembly.actions import unloaded
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.newton_loop import NewtonLoop

HARD = runpy.run_path(str(Path(__file__).parents[2] / "benchmarks" / "hard_cases.py"))


def iterations(structure, stages, solver):
    """Count the iterations and the iterates of a solve from rest; return them with its solution."""
    problem = Problem(structure)
    loaded = problem.under(problem.actions_of(stages[0], unloaded(structure)))
    numbers = []
    solution = solver.prepare(problem)(loaded, problem.create_vector(), lambda number, _: numbers.append(number))
    return sum(number > 0 for number in numbers), len(numbers), solution


SLOW = [pytest.param(most, marks=pytest.mark.serial) for most in (60, 300)]


@pytest.mark.parametrize("line_search", [True, False])
@pytest.mark.parametrize("most", [1, 7, *SLOW])
def test_total_of_all_strategies_is_bounded(most, line_search):
    """A sheet twisted out of its plane: a first attempt, the homotopy and the attempt after it take 600 iterations."""
    structure, stages = HARD["pulled"](-0.1, 0.6, 0.0, HARD["FABRIC"])
    taken, told, solution = iterations(structure, stages, Newton(1e-10, most, line_search))
    assert not solution.converged
    assert taken <= most
    assert told == len(solution.iterations) + solution.extra_iterations
    if line_search:
        assert taken == most


@pytest.mark.serial
def test_first_attempt_leaves_iterations_to_the_homotopy():
    structure, stages = HARD["pulled"](-0.1, 0.6, 0.0, HARD["FABRIC"])
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
    needed, _, solution = iterations(structure, stages, Newton())
    assert solution.converged
    assert solution.extra_iterations + len(solution.iterations) > 3
    for most in range(1, needed + 1):
        taken, *_ = iterations(structure, stages, Newton(max_iterations=most))
        assert taken <= most


def test_each_halved_increment_has_the_whole_number(monkeypatch):
    counts = []
    begin, step = NewtonLoop.begin, NewtonLoop.step
    monkeypatch.setattr(NewtonLoop, "begin", lambda *args: counts.append(0) or begin(*args))

    def counted(*args):
        counts[-1] += 1
        step(*args)

    monkeypatch.setattr(NewtonLoop, "step", counted)
    structure, stages = HARD["pulled"](-0.1, 0.6, 0.0, HARD["FABRIC"])
    with pytest.raises(ConvergenceError):
        Analysis(structure, Newton(max_iterations=2)).run(stages)
    assert counts[0] == 0  # of a solver that is made
    assert len(counts) == 1 + 1 + 8
    assert max(counts) == 2
