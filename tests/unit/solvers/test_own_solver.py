"""Solvers of a user: any object that keeps the protocol, on any number of processes."""

import numpy as np
import pytest
from petsc4py import PETSc

from fx_membrane import (
    Analysis,
    ConvergenceError,
    DistributedLoad,
    Iteration,
    Newton,
    Outcome,
    PrescribedDisplacement,
    Solution,
    Stage,
    UnbalancedStateWarning,
    WorkLimit,
)
from models import CENTRE, inclined_sheet

SNOW = Stage("snow", [DistributedLoad((0, 0, -200.0), "fabric")], increments=2)


class BySnes:
    """PETSc's SNES, on the script's own terms: attributes of every kind, numbers of NumPy."""

    def __init__(self, kind="newtonls"):
        self.kind, self.function, self.weights = kind, lambda: None, np.random.default_rng().random(3)

    def prepare(self, problem):
        A, b = problem.create_matrix(), problem.create_vector()
        self.snes = PETSc.SNES().create(problem.comm)
        self.snes.setType(self.kind)
        self.snes.getKSP().setType("preonly")
        self.snes.getKSP().getPC().setType("lu")
        self.snes.getKSP().getPC().setFactorSolverType("mumps")
        self.snes.setTolerances(rtol=1e-12, atol=1e-9, stol=0.0)

        def solve(loaded, x, monitor, thorough):
            history = []

            def residual(snes, x, b):
                loaded.residual(x, b)
                loaded.constraints.zero_constrained(b)

            def tangent(snes, x, A, P):
                loaded.tangent(x, A)
                A.zeroRowsColumns(loaded.constraints.constrained, diag=1.0)

            def record(snes, number, norm):
                history.append(Iteration(np.float32(loaded.energy(x)), np.float64(norm), number > 0))
                monitor(number, history[-1])

            loaded.constraints.impose(x)
            self.snes.setFunction(residual, b)
            self.snes.setJacobian(tangent, A)
            self.snes.cancelMonitor()
            self.snes.setMonitor(record)
            self.snes.solve(None, x)
            done = self.snes.getConvergedReason() > 0
            return Solution(Outcome.CONVERGED if done else Outcome.MAX_ITERATIONS, "SNES has ended.", tuple(history))

        return solve


def answering(answer, impose=True):
    """Solver that only answers."""

    class Answer:
        def prepare(self, problem):
            def solve(loaded, x, monitor, thorough):
                if impose:
                    loaded.constraints.impose(x)
                return answer(x) if callable(answer) else answer

            return solve

    return Answer()


@pytest.mark.mpi
def test_snes_of_a_script_finds_the_state_of_newton(tmp_path):
    stages = [SNOW, Stage("lift", displacements=[PrescribedDisplacement(CENTRE, (0.01, 0, 0.05))], after="snow")]
    expected = Analysis(inclined_sheet()).run(stages)
    found = Analysis(inclined_sheet(), BySnes()).run(stages)
    for name in ("snow", "lift"):
        size = np.abs(expected[name].displacement).max()
        np.testing.assert_allclose(found[name].displacement, expected[name].displacement, rtol=0, atol=1e-9 * size)
        assert {entry.outcome for entry in found[name].increments} == {Outcome.CONVERGED}
        assert all(type(number) is float for _, entry in found[name].history for number in entry)


def test_checkpoint_continues_with_another_solver(tmp_path):
    file = tmp_path / "run.sqlite"
    with pytest.raises(ConvergenceError):
        Analysis(inclined_sheet(), BySnes(), limit=WorkLimit(iterations=1)).run([SNOW], file)
    first = Analysis(inclined_sheet(), BySnes()).run([SNOW], file)["snow"]
    again = Analysis(inclined_sheet(), Newton()).run([SNOW], file)["snow"]
    np.testing.assert_array_equal(first.displacement, again.displacement)
    assert first.history == again.history


@pytest.mark.mpi
def test_limit_of_work_ends_a_solver_from_inside_its_callbacks():
    with pytest.raises(ConvergenceError, match=r"limit.*3 iterations.*stage") as failure:
        Analysis(inclined_sheet(), BySnes(), limit=WorkLimit(iterations=3)).run([SNOW])
    assert failure.value.failed.outcome is Outcome.WORK_LIMIT


@pytest.mark.mpi
def test_failure_halves_the_increment_and_keeps_words_and_results():
    with pytest.raises(ConvergenceError, match="It is Sunday") as failure:
        Analysis(inclined_sheet(), answering(Solution(Outcome.MAX_ITERATIONS, "It is Sunday.", ()))).run([SNOW])
    assert failure.value.failed.load_factor == 0.5 / 2**8
    assert failure.value.last.largest_displacement == 0
    assert failure.value.failed.iterations[0].residual > 0  # of the state that it left


@pytest.mark.filterwarnings("ignore::fx_membrane.UnbalancedStateWarning")
def test_state_out_of_balance_is_told():
    state = Analysis(inclined_sheet(), answering(Solution(Outcome.CONVERGED, "", ()))).run([SNOW])["snow"]
    assert UnbalancedStateWarning in {remark.category for remark in state.remarks}
    assert state.equilibrium.residual > 1


def _nan(x):
    x.set(np.nan)
    return Solution(Outcome.CONVERGED, "", ())


def _far(x):
    x.set(1e55)
    return Solution(Outcome.CONVERGED, "", ())


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("solver", "words"),
    [
        (
            answering(Solution(Outcome.CONVERGED, "", ()), impose=False),
            r"constrained component is 0.05.*place; let it call loaded\.constraints\.impose\(x\)",
        ),
        (answering(_nan), "displacement.*not a number"),
        (answering(_far), "moved by 1e\\+55, over 1000 times the size"),
    ],
)
def test_state_that_breaks_its_constraints_is_no_equilibrium(solver, words):
    lift = Stage("lift", displacements=[PrescribedDisplacement(CENTRE, (0, 0, 0.05))])
    with pytest.raises(ConvergenceError, match=f"Answer calls.*state.*equilibrium .*{words}") as failure:
        Analysis(inclined_sheet(), solver).run([lift])
    assert failure.value.failed.outcome is Outcome.NO_EQUILIBRIUM


@pytest.mark.mpi_once
@pytest.mark.parametrize("answer", [None, True, "converged", (Outcome.CONVERGED, "", ())])
def test_answer_of_another_kind(answer):
    with pytest.raises(ValueError, match=r"Answer returns .*; let it return Solution\(outcome, reason, iterations\)"):
        Analysis(inclined_sheet(), answering(answer)).run([SNOW])


DONE = Outcome.CONVERGED


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (
            Solution(True, "", ()),
            r"outcome is True; let it return Solution\(.*fx_membrane\.Outcome, as Outcome\.CONVERGED",
        ),
        (Solution("converged", "", ()), "outcome is 'converged'; let it return Solution"),
        (Solution(DONE, None, ()), "reason is None; give a sentence"),
        (Solution(DONE, "", 5), r"iterations are 5; give a list of fx_membrane\.Iteration"),
        (Solution(DONE, "", (1.0,)), r"iterations are \(1\.0,\); give a list"),
        (Solution(DONE, "", [("a", 1, 2)]), "iterations are .*; give a list"),
        (Solution(DONE, "", (), extra_iterations="3"), "extra_iterations is '3'; give a whole number"),
        (Solution(DONE, "", (), lost_stability="no"), "lost_stability is 'no'; give True or False"),
        (Solution(DONE, "", (), motion=3.0), r"motion has the shape \(\); give \(25, 3\), or None"),
    ],
)
def test_answer_with_a_field_of_another_kind(answer, words):
    with pytest.raises(ValueError, match=f"^Answer returns a Solution whose {words}"):
        Analysis(inclined_sheet(), answering(answer)).run([SNOW])


@pytest.mark.parametrize("told", [(0,), (0, 5.0), (0, (1.0, 2.0)), (0, None), ("first", (1.0, 2.0, 1.0))])
def test_monitor_told_of_something_else(told):
    class Teller:
        def prepare(self, problem):
            return lambda loaded, x, monitor, thorough: monitor(*told)

    with pytest.raises(
        ValueError, match=r"^Teller( calls its monitor with 0 and .*monitor\(number, .*Iteration\(|: .* 'first')"
    ):
        Analysis(inclined_sheet(), Teller()).run([SNOW])


def test_failure_without_a_reason_has_that_of_its_outcome():
    with pytest.raises(ConvergenceError, match=r"the iteration diverged\."):
        Analysis(inclined_sheet(), answering(Solution(Outcome.DIVERGED, "", ()))).run([SNOW])


class NoArgument:
    def prepare(self):
        pass


class NoFunction:
    def prepare(self, problem):
        pass


class ShortFunction:
    def prepare(self, problem):
        return lambda x: None


@pytest.mark.parametrize(
    ("solver", "words"),
    [
        (Newton, "solver is the class Newton.*brackets"),
        (3, r"solver is 3.*no method prepare\(problem\).*Newton\(\)"),
        (None, r"solver is None.*no method prepare\(problem\)"),
        (NoArgument(), r"prepare takes \(\).*\(problem\)"),
        (NoFunction(), r"NoFunction\.prepare returns None.*solve\(loaded, x, monitor, thorough\)"),
        (ShortFunction(), r"ShortFunction\.prepare .* of \(x\).*\(loaded, x, monitor, thorough\)"),
    ],
)
def test_refused_at_the_door(solver, words):
    with pytest.raises(ValueError, match=words):
        Analysis(inclined_sheet(), solver)


@pytest.mark.mpi
@pytest.mark.skipif(PETSc.COMM_WORLD.size == 1, reason="compares processes")
def test_settings_of_one_process_alone_are_refused():
    kind = "newtontr" if PETSc.COMM_WORLD.rank == 1 else "newtonls"
    with pytest.raises(ValueError, match=r"process 1 differs.*process 0.*solver"):
        Analysis(inclined_sheet(), BySnes(kind))


@pytest.mark.mpi
@pytest.mark.skipif(PETSc.COMM_WORLD.size == 1, reason="compares processes")
def test_answer_of_one_process_alone_is_refused_on_all():
    wrong = PETSc.COMM_WORLD.rank == 1
    answer = Solution(True if wrong else Outcome.MAX_ITERATIONS, "", ())
    with pytest.raises(ValueError, match=r"^Answer returns a Solution whose outcome is True"):
        Analysis(inclined_sheet(), answering(answer)).run([SNOW])
