"""Reasons in words of a stage that ended before its whole load; a mechanism comes before the largest load."""

from __future__ import annotations

from fractions import Fraction

from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from ..solvers.base import Solution
from ..solvers.diagnosis import swung_masts, unlikely_units
from .increments import Ceiling, IncrementControl
from .work import Work

MORE = "allow more (WorkLimit), or see in its iterations, `failed`, whether it comes nearer at all."
OVER = 0.5  # angle of a mast in equilibrium that counts as fallen over [rad]


def reason(
    problem: LoadedProblem,
    x: PETSc.Vec,
    solution: Solution,
    control: IncrementControl,
    work: Work,
) -> str:
    """Explain in words the failure of an increment from a state.

    Args:
        problem: The problem, under the actions of the increment that failed.
        x: The last state tried.
        solution: How that ended.
        control: The control of the increments.
        work: The work of the stage.
    """
    if work.over:
        return f"{work.over}; {MORE}{_search(control)}"
    if solution.motion is not None or not solution.outcome.retry:
        return solution.reason
    fallen = swung_masts(problem, problem.discretization.to_petsc(control.state.displacement), OVER, "found")
    words = fallen or _largest_load(control.ceiling, control.state.factor)
    if not words:
        return solution.reason
    # Its advice is for loads that the structure bears.
    tried = f"The last try ended with an unbalanced force of {solution.iterations[-1].residual:.3g}."
    return f"{words} {tried}{unlikely_units(problem, x)}"


def _largest_load(ceiling: Ceiling, start: Fraction) -> str:
    """Sentence that the structure likely carries no more than the ceiling; empty far below it."""
    if not start or not ceiling.near(start):
        return ""
    return (
        f"from load factor {float(start):.6g} on no equilibrium was found, in however small increments, and likely "
        "there is none: it is the largest load that the structure bears. A fabric with a free edge, for one, flies off "
        "where a pressure exceeds what holds it down. More increments will not help; stay below that load, or add "
        "supports, members, weight or prestress. On fine meshes of slack fabric iterations may be too few; "
        "Newton(max_iterations=...) allows more."
    )


def _search(control: IncrementControl) -> str:
    state, beyond = control.state, control.bracket.beyond
    if not beyond:
        return ""
    return (
        f" It ended the search for a load between the load factors {float(state.factor):.6g} and "
        f"{float(beyond.factor):.6g} at which the structure might lose its stability."
    )
