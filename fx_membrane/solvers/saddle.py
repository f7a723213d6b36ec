"""Escape from a saddle of the energy: a step along a direction of negative curvature, and a descent from there.

Newton's method also finds equilibria that are not stable: saddles and maxima of the energy. The direction of negative
curvature leads away from them, downhill.

Source: J. J. More, D. C. Sorensen, On the use of directions of negative curvature in a modified Newton method, Math.
Program. 16 (1979) 1-20.
"""

from __future__ import annotations

from dataclasses import dataclass

from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from .curvature import negative_curvature_direction


@dataclass(frozen=True)
class SaddleControl:
    """Limits of the escape.

    Attributes:
        step: Largest displacement of a node in the step, as a fraction of the size of the structure.
        attempts: Maximum number of equilibria left.
    """

    step: float = 1e-3
    attempts: int = 3


def leave_saddle(problem: LoadedProblem, x: PETSc.Vec, control: SaddleControl) -> bool:
    """Move an unstable equilibrium downhill, along its lowest mode; return False if it is stable."""
    found = negative_curvature_direction(problem, x)
    if not found.negative:
        return False
    step = found.motion
    step.scale(control.step * problem.structure.size / step.norm(PETSc.NormType.NORM_INFINITY))
    energy = problem.energy_along(x, step)
    x.axpy(1.0 if energy(1.0) < energy(-1.0) else -1.0, step)
    return True
