"""Solvers of a user: the protocol checked at the door, and their answers."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..checks.calls import parameters_of, takes
from ..checks.validation import finite, integer, short_repr, truth
from ..checks.values import with_article
from ..model.own_classes import home
from ..runtime.processes import together
from .base import LIMITS, Iteration, Monitor, Solution, Solve, SolveOnward, Solver, iterate, max_norm, no_monitor
from .conjugate_gradient import ConjugateGradient, SteepestDescent
from .newton import Newton
from .outcome import Outcome

SHIPPED = (Newton, ConjugateGradient, SteepestDescent)
CONSTRAINT_ERROR = 1e-9  # error of a constrained component, in sizes of the structure
SOLUTION = (
    "Solution(outcome, reason, iterations) with an outcome of fx_membrane.Outcome, as Outcome.CONVERGED or "
    "Outcome.MAX_ITERATIONS"
)
SOLVE = "(loaded, x, monitor, thorough)"


def check(solver: Any) -> None:
    """Refuse what is no solver.

    Raises:
        ValueError: It is a class, or has no method `prepare` for one argument; it is derived from a solver of the
            package, whose `prepare` knows nothing of the class.
    """
    remedy = "give Newton(), or an object that keeps the protocol fx_membrane.Solver"
    what = f"Analysis solver is {short_repr(solver)}"
    if isinstance(solver, type):
        raise ValueError(f"{what}; give an object of it, with brackets behind its name.")
    prepare = getattr(solver, "prepare", None)
    if not callable(prepare):
        raise ValueError(f"{what}, which has no method prepare(problem); {remedy}.")
    if not takes(prepare, 1):
        raise ValueError(f"{what}, whose prepare takes ({parameters_of(prepare)}); let it take (problem).")
    parent = home(type(solver), "prepare")
    if parent in SHIPPED and type(solver) is not parent:
        raise ValueError(
            f"{what}, of a class derived from {parent.__name__}, whose own data and methods would not be used; define "
            f"prepare(problem) in {type(solver).__name__}, or give {with_article(parent.__name__)} itself."
        )


def settings(solver: Solver) -> dict[str, Any]:
    """Class of a solver and its settings: public attributes that are numbers, texts, or sequences of them."""
    attributes = sorted(getattr(solver, "__dict__", ()))
    given = [field.name for field in fields(solver)] if is_dataclass(solver) else attributes
    found = {name: getattr(solver, name, None) for name in given if not name.startswith("_")}
    return {"class": type(solver).__qualname__} | {name: value for name, value in found.items() if _is_plain(value)}


def _is_plain(value: Any) -> bool:
    if isinstance(value, list | tuple):
        return all(_is_plain(entry) for entry in value)
    return value is None or isinstance(value, bool | int | float | str | np.generic)


def prepared(solver: Solver, problem: Problem) -> SolveOnward:
    """Prepare a solver for a problem; answers of a user's own are checked.

    Raises:
        ValueError: `prepare` returns no function of a problem, a state, a monitor and a truth value.
    """
    solve: Any = solver.prepare(problem)
    if type(solver) in SHIPPED:
        return solve
    name = type(solver).__name__
    if not callable(solve):
        raise ValueError(f"{name}.prepare returns {short_repr(solve)}; let it return a function solve{SOLVE}.")
    if not takes(solve, 4):
        raise ValueError(f"{name}.prepare returns a function of ({parameters_of(solve)}); let it take {SOLVE}.")
    return _Checked(name, solve)


def release(solve: Solve) -> None:
    """Free the factorization that a shipped solver keeps for its next solve; collective."""
    getattr(solve, "release", _nothing)()


def _nothing() -> None:
    """Free nothing."""


class _Checked:
    """Solve of a user's own solver, whose answers are checked and made plain numbers."""

    def __init__(self, name: str, solve: Solve):
        self.name, self.solve = name, solve

    def __call__(
        self,
        problem: LoadedProblem,
        x: PETSc.Vec,
        monitor: Monitor = no_monitor,
        thorough: bool = True,
        taken: int = 0,  # the protocol does not tell it: each round of rain has the bound of the solver anew
        /,
    ) -> Solution:
        try:
            solution: Any = self.solve(problem, x, _telling(self.name, monitor), thorough)
        except PETSc.Error as error:  # PETSc 3.25 wraps exceptions of callbacks
            raise (error.__cause__ or error) from None
        with together(problem.comm):
            solution = _plain(self.name, solution, problem)
        if not solution.iterations:
            solution = replace(solution, iterations=(iterate(problem, x),))
        fault = self.fault(problem, x) if solution.converged else ""
        return replace(solution, outcome=Outcome.NO_EQUILIBRIUM, reason=fault) if fault else solution

    def fault(self, problem: LoadedProblem, x: PETSc.Vec) -> str:
        """Sentence on why a state is no equilibrium; empty if its constraints are met."""
        calls = f"{self.name} calls a state an equilibrium "
        if not np.isfinite(max_norm(x)):
            return f"{calls}that has a displacement that is not a number; let it return Outcome.DIVERGED."
        if max_norm(x) > LIMITS.far * problem.structure.size:
            return (
                f"{calls}that is moved by {max_norm(x):.3g}, over {LIMITS.far:g} times the size of the structure; let "
                "it return Outcome.DIVERGED."
            )
        with problem.discretization.work(1) as (gap,):
            x.copy(gap)
            problem.constraints.impose(gap)
            gap.axpy(-1.0, x)
            error = max_norm(gap)
        if error <= CONSTRAINT_ERROR * problem.structure.size:
            return ""
        return (
            f"{calls}in which a constrained component is {error:.3g} from its place; let it call "
            "loaded.constraints.impose(x) first."
        )


def _telling(name: str, monitor: Monitor) -> Monitor:
    """Monitor that refuses data that are no `Iteration`."""

    def tell(number: Any = None, entry: Any = None) -> None:
        remedy = "let it call monitor(number, fx_membrane.Iteration(energy, residual, step))"
        try:
            iteration = Iteration(*map(float, entry))
        except (TypeError, ValueError):
            raise ValueError(
                f"{name} calls its monitor with {short_repr(number)} and {short_repr(entry)}; {remedy}."
            ) from None
        monitor(integer(f"{name}: the first argument of its monitor", number), iteration)

    return tell


def _plain(name: str, answer: Any, problem: LoadedProblem) -> Solution:
    """Make an answer of plain numbers, texts and arrays.

    Raises:
        ValueError: It is no `Solution`, or a field of it has another kind.
    """
    if not isinstance(answer, Solution):
        raise ValueError(f"{name} returns {short_repr(answer)}; let it return {SOLUTION}.")
    what = f"{name} returns a Solution whose"
    if not isinstance(answer.outcome, Outcome):
        raise ValueError(f"{what} outcome is {short_repr(answer.outcome)}; let it return {SOLUTION}.")
    if not isinstance(answer.reason, str):
        raise ValueError(f"{what} reason is {short_repr(answer.reason)}; give a sentence.")
    try:
        iterations = tuple(Iteration(*map(float, entry)) for entry in answer.iterations)
    except (TypeError, ValueError):
        raise ValueError(
            f"{what} iterations are {short_repr(answer.iterations)}; give a list of fx_membrane.Iteration(energy, "
            "residual, step), or an empty one."
        ) from None
    shape, motion = problem.structure.points.shape, answer.motion
    if motion is not None:
        motion = finite(f"{what} motion", motion)
        if motion.shape != shape:
            raise ValueError(f"{what} motion has the shape {motion.shape}; give {shape}, or None.")
    return replace(
        answer,
        reason=str.__str__(answer.reason) or answer.outcome.value,
        iterations=iterations,
        extra_iterations=integer(f"{what} extra_iterations", answer.extra_iterations),
        lost_stability=truth(f"{what} lost_stability", answer.lost_stability),
        motion=motion,
    )
