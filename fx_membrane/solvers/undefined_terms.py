"""Energy terms that are not a number in a state, in words."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from ..model.term_parameters import described
from .base import Solution, iterate
from .outcome import Outcome


def undefined_start(problem: LoadedProblem, x: PETSc.Vec) -> Solution | None:
    """Failure of a solve from a start at which an energy term is not finite; None if all are.

    Args:
        problem: The problem.
        x: The start.
    """
    words = undefined_term(problem, x)
    return Solution(Outcome.UNDEFINED, words, (iterate(problem, x),)) if words else None


def undefined_term(problem: LoadedProblem, x: PETSc.Vec) -> str:
    """Sentence on the first energy term whose energy or force is not finite in a state; empty without one.

    Args:
        problem: The problem.
        x: The state.
    """
    if not problem.terms.all:
        return ""
    with np.errstate(all="ignore"):
        energies = problem.term_energies(x)
        for energy, (acting, forces) in zip(energies, problem.term_forces(x), strict=True):
            bad = np.argwhere(~np.isfinite(forces))
            if np.isfinite(energy) and not len(bad):
                continue
            found = f"its energy is {energy}" if not np.isfinite(energy) else ""
            if len(bad):
                node, component = bad[0]
                found = f"its force on node {node} along {'xyz'[component]} is {forces[node, component]}"
            return (
                f"the energy term {described(acting.term)} is not finite at the start: {found}. Let its integrand be a "
                "finite number there, with finite derivatives, as by conditional(...), or start from another shape."
            )
    return ""
