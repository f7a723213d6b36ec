"""Natural-parameter homotopy: a start near equilibrium, from a stabilization that fades from solve to solve.

The energy of the structure gains lambda x . T x / 2 in its current shape x, with the stabilization matrix T. So the
structure has the stiffness of a prestressed one, and a unique shape if lambda is large.

Source: E. L. Allgower, K. Georg, Introduction to numerical continuation methods, SIAM (2003), chapter 1, the convex
homotopy with a sequence of fixed parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

from ..checks.values import counted
from .base import LIMITS, Solution, max_norm
from .newton_loop import NewtonLoop


@dataclass(frozen=True)
class HomotopyControl:
    """Schedule of the homotopy, fitted on tests/benchmarks/hard_cases.py.

    Attributes:
        levels: Stabilization of the solves, as strains.
        rtol: Relative tolerance of each solve.
        iterations: Maximum number of iterations of each solve.
    """

    levels: tuple[float, ...] = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
    rtol: float = 1e-3
    iterations: int = 40


def stabilized_start(loop: NewtonLoop, x: PETSc.Vec, control: HomotopyControl) -> None:
    """Replace x by the end of a homotopy; by the last state at hand if that diverges."""
    given = loop.problem
    with given.discretization.work(1) as (before,):
        try:
            for level in control.levels:
                loop.problem = given.with_stabilization(level)
                x.copy(before)
                loop.attempt(x, control.rtol, control.iterations)
                if not max_norm(x) <= LIMITS.far * given.structure.size:
                    before.copy(x)
                    return
        finally:
            loop.problem = given


def attempts_message(first: Solution, homotopy: int, second: Solution) -> str:
    """Sentence on the attempts of a solve whose reason is that of the first.

    Args:
        first: End of the first attempt.
        homotopy: Number of iterations of the homotopy after it.
        second: End of the attempt after the homotopy; one that has converged has a collapsed shape.
    """
    end = f"a largest unbalanced force of {second.iterations[-1].residual:.3g}"
    return (
        f" That was the first attempt, of {counted(len(first.iterations) - 1, 'iteration')}; the homotopy took "
        f"{homotopy} more, and the second attempt {len(second.iterations) - 1}, which ended with "
        f"{'a collapsed shape' if second.converged else end}."
    )
