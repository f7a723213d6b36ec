"""Length of load increments: halved after a failure, growing back afterwards."""

from fractions import Fraction

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    ConvergenceError,
    Newton,
    Outcome,
    PointLoad,
    Stage,
)
from fx_membrane.analysis.checkpoint_file import Progress
from fx_membrane.analysis.increments import IncrementControl, Verdict
from fx_membrane.solvers.base import Iteration, Solution
from models import CENTRE, WIND, same_state, sheet

POINT = [PointLoad(CENTRE, (0, 0, -2e4)), WIND]


def unwilling(analysis, failing, retry=True):
    """Make the solver fail at some calls, counted from zero, and leave nonsense behind; return the targets."""
    solve, tried = analysis._solve, []

    def wrapped(loaded, x, *monitor):
        tried.append(float(loaded.actions.loads[CENTRE, 2]) / -100.0)
        if len(tried) - 1 not in failing:
            return solve(loaded, x, *monitor)
        x.set(1e3)
        outcome = Outcome.MAX_ITERATIONS if retry else Outcome.SLOW
        return Solution(outcome, "it is unwilling.", (Iteration(1.0, 2.0, 0.0),))

    analysis._solve = wrapped
    return tried


def pushed(failing, steps, retry=True):
    """Load factors tried, those found, and the state."""
    analysis = Analysis(sheet())
    tried = unwilling(analysis, failing, retry)
    result = analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))], increments=steps)])["push"]
    return tried, [increment.load_factor for increment in result.increments], result


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("steps", "failing", "tried", "found"),
    [
        (1, [], [1], [1]),
        (1, [0], [1, 1 / 2, 1], [1 / 2, 1]),
        (1, [0, 1], [1, 1 / 2, 1 / 4, 3 / 4, 1], [1 / 4, 3 / 4, 1]),
        (3, [1], [1 / 3, 2 / 3, 1 / 2, 5 / 6, 1], [1 / 3, 1 / 2, 5 / 6, 1]),
        (2, [0, 2], [1 / 2, 1 / 4, 3 / 4, 1 / 2, 1], [1 / 4, 1 / 2, 1]),
        (1, [0, 1, 4], [1, 1 / 2, 1 / 4, 3 / 4, 1, 7 / 8, 1], [1 / 4, 3 / 4, 7 / 8, 1]),
    ],
    ids=["none", "first", "first two", "second of three", "one that has grown", "the rest of the stage"],
)
def test_failing_increment_is_halved_and_the_next_grows_back(analysis, steps, failing, tried, found):
    all_tried, all_found, result = pushed(failing, steps)
    assert all_tried == pytest.approx(tried, rel=1e-14)
    assert all_found == pytest.approx(found, rel=1e-14)
    assert all_found[-1] == 1
    assert same_state(result, analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))])])["push"])


def test_history_is_that_of_the_increments_found():
    _, _, result = pushed([0, 1], 1)
    assert [factor for factor, entry in result.history if entry.step == 0] == [1 / 4, 3 / 4, 1]
    assert max(entry.residual for _, entry in result.history) < 1e3


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [1, 3])
def test_gives_up_after_eight_halvings(analysis, steps):
    stubborn = Analysis(sheet())
    tried = unwilling(stubborn, range(2, 100))
    stages = [Stage("rest"), Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))], increments=steps, after="rest")]
    if steps == 1:
        stages.insert(1, Stage("other"))
    # Near a load factor above zero what is told is that load.
    reason = r"it is unwilling\." if steps == 1 else r"from load factor 0.333333 on .* an unbalanced force of 2\."
    with pytest.raises(ConvergenceError, match=rf"^Stage 'push' .*: {reason}$") as error:
        stubborn.run(stages)
    done = 0 if steps == 1 else 1
    failure, full = error.value, 1 / steps
    assert len(tried) == 2 + 1 + 8
    assert failure.failed.load_factor == pytest.approx(full * (done + 1 / 2**8), rel=1e-14)
    assert list(failure.results) == [stage.name for stage in stages[:-1]]
    assert [increment.load_factor for increment in failure.last.increments] == [full] * done
    part = Stage("push", [PointLoad(CENTRE, (0, 0, -100.0 * full * done))])
    expected = analysis.run([part])["push"]
    scale = 1e-9 * np.abs(expected.displacement).max()
    assert failure.last.displacement == pytest.approx(expected.displacement, abs=scale)


def test_increment_that_no_length_helps_is_not_halved():
    analysis = Analysis(sheet())
    tried = unwilling(analysis, [0], retry=False)
    with pytest.raises(ConvergenceError):
        analysis.run([Stage("push", [PointLoad(CENTRE, (0, 0, -100.0))])])
    assert len(tried) == 1


@pytest.mark.mpi
def test_hard_load_in_one_step_ends_where_many_steps_end(analysis):
    plain = Newton(max_iterations=4, line_search=False)
    short = Analysis(sheet(), plain).run([Stage("hard", POINT)])["hard"]
    factors = [increment.load_factor for increment in short.increments]
    sizes = np.diff([0, *factors])
    assert (sizes > 0).all()
    assert len(factors) > 2
    assert factors[-1] == 1
    assert (sizes[1:] > sizes[:-1]).any()  # it grows back
    assert (sizes[1:] <= 2 * sizes[:-1]).all()
    many = analysis.run([Stage("hard", POINT, increments=40)])["hard"]
    assert [increment.load_factor for increment in many.increments] == [(k + 1) / 40 for k in range(40)]
    assert same_state(short, many)
    assert short.energy == pytest.approx(many.energy, rel=1e-12)


SHAPE = np.zeros((1, 3))


def control(increments=1, loads=True, state=None, balanced=True):
    stage = Stage("push", [PointLoad(0, (0, 0, 1.0))] if loads else (), increments=increments)
    return IncrementControl(stage, state or Progress(SHAPE, Fraction(0), Fraction(1, increments), ()), balanced)


def judged(control, outcome, lost=False):
    """Verdict on the next try."""
    control.next()
    solution = Solution(outcome, outcome.value, (Iteration(1.0, 2.0, 0.0),), lost_stability=lost)
    return control.judge(solution, SHAPE if outcome.converged else None, 10)


@pytest.mark.parametrize("outcome", list(Outcome))
def test_verdict_follows_from_the_outcome(outcome):
    expected = Verdict.ACCEPT if outcome.converged else Verdict.HALVE if outcome.retry else Verdict.STOP
    assert judged(control(), outcome) is expected
    assert judged(control(loads=False), outcome) is (Verdict.ACCEPT if outcome.converged else Verdict.STOP)


def test_increments_are_halved_eight_times():
    control_ = control(4)
    verdicts = [judged(control_, Outcome.DIVERGED) for _ in range(9)]
    assert verdicts == [Verdict.HALVE] * 8 + [Verdict.STOP]
    assert control_.factor == Fraction(1, 4 * 2**8)
    assert control_.failed(Solution(Outcome.DIVERGED, "", ())).outcome is Outcome.DIVERGED


@pytest.mark.parametrize("critical", [Fraction(1, 3), Fraction(1, 512)])
def test_critical_load_is_bracketed(critical):
    control_, found = control(), []
    while control_.state.factor < 1:
        beyond = control_.state.factor < critical < control_.next()
        if judged(control_, Outcome.CONVERGED, beyond) is Verdict.ACCEPT:
            assert bool(control_.lost) == beyond
            found.append(control_.accept().increments[-1])
    snapped = [number for number, entry in enumerate(found) if entry.outcome is Outcome.SNAPPED]
    assert len(snapped) == 1
    low = found[snapped[0] - 1].load_factor if snapped[0] else 0.0
    assert low < critical < found[snapped[0]].load_factor <= low + 1 / 2**8


@pytest.mark.parametrize("balanced", [True, False])
def test_stability_is_judged_from_a_balanced_start_on(balanced):
    verdict = judged(control(balanced=balanced), Outcome.CONVERGED, lost=True)
    assert verdict is (Verdict.HALVE if balanced else Verdict.ACCEPT)


def test_unstable_state_is_graver_than_a_loss_of_stability():
    control_ = control()
    while judged(control_, Outcome.UNSTABLE, lost=True) is Verdict.HALVE:
        assert not control_.thorough
    assert control_.lost.increments[-1].outcome is Outcome.UNSTABLE
    control_.note_fallen("mast 'm' is held by slack parts alone")
    assert control_.accept().increments[-1].outcome is Outcome.FALLEN


def test_search_for_a_critical_load_that_was_cut_off_is_a_limit_of_work():
    control_ = control()
    judged(control_, Outcome.CONVERGED, lost=True)
    assert control_.failed(Solution(Outcome.CONVERGED, "", ())).outcome is Outcome.WORK_LIMIT
