"""Reasons in words of a stage that ended before its whole load; a mechanism comes before the largest load."""

from petsc4py import PETSc

from ..assembly.loaded_problem import LoadedProblem
from ..solvers.base import Solution
from ..solvers.diagnosis import swung_masts, unlikely_units
from .checkpoint_file import Progress
from .increments import Ceiling
from .work import Work

MORE = "allow more (WorkLimit), or see in its iterations, `failed`, whether it comes nearer at all."
OVER = 0.5  # angle of a mast in equilibrium that counts as fallen over [rad]


def reason(
    problem: LoadedProblem,
    x: PETSc.Vec,
    solution: Solution,
    state: Progress,
    beyond: Progress | None,
    ceiling: Ceiling,
    work: Work,
) -> str:
    """Explain in words the failure of an increment from a state.

    Args:
        problem: The problem, under the actions of the increment that failed.
        x: The last state tried.
        solution: How that ended.
        state: The last state found.
        beyond: A state that was found past a loss of stability, while smaller increments located that.
        ceiling: The load factors at which nothing was found.
        work: The work of the stage.
    """
    if work.over:
        return f"{work.over}; {MORE}{_search(state, beyond)}"
    if solution.motion is not None or not solution.retry:
        return solution.reason
    fallen = swung_masts(problem, problem.discretization.to_petsc(state.displacement), OVER, "found")
    words = fallen or ceiling.words(state.factor)
    if not words:
        return solution.reason
    # Its advice is for loads that the structure bears.
    tried = f"The last try ended with an unbalanced force of {solution.iterations[-1].residual:.3g}."
    return f"{words} {tried}{unlikely_units(problem, x)}"


def _search(state: Progress, beyond: Progress | None) -> str:
    if not beyond:
        return ""
    return (
        f" It ended the search for a load between the load factors {float(state.factor):.6g} and "
        f"{float(beyond.factor):.6g} at which the structure might lose its stability."
    )
