"""What every solver keeps to: a problem and a start go in; the state, its history and a reason in words come out."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem import Problem

ROUNDING = 1e-14
MOST = 1e3  # forces, as a multiple of the loads, that a relative tolerance refers to
FALLEN = 0.5  # displacement, in sizes of the structure, beyond which it is in quite another shape
FAR = 1e3  # displacements beyond so many sizes of the structure are no solution


class Iteration(NamedTuple):
    """One line of a convergence table.

    Attributes:
        energy: Total potential energy [J].
        residual: Largest unbalanced nodal force [N], infinity norm; at components whose prescribed displacement is
            not reached yet, the error times a typical stiffness.
        step: Length of the step that led here, in (0, 1]; 0 at the start.
        tension: Artificial tension that the tangent was given for that step, as a strain: times the stiffness of each
            part; 0 where it did without.
    """

    energy: float
    residual: float
    step: float
    tension: float = 0.0


@dataclass(frozen=True)
class Solution:
    """How a solve ended; the state itself is in the vector given to it.

    Attributes:
        converged: Whether the residual met the tolerance.
        reason: In words, why it stopped, and what to try where it failed.
        iterations: The iterates, the start first.
        retry: Whether a smaller load increment may succeed where this one failed.
        drawn_smooth: Whether the start of the iterates is not the one given, but what an artificial tension in the
            structure came to while it was faded out.
        unstable: Whether the equilibrium found is not stable, and no stable one was found from there.
        unlisted: Number of iterates that are not among `iterations`: of tries that came to nothing, and of those that
            drew the structure smooth.
        lost_stability: Whether there was no negative curvature at the start, but there was some on the way, more than
            wrinkled and slack cells have: that of masts or a pressure. As iterates can be far off, smaller increments
            of the load may yet do without.
        motion: Where it failed because the structure is a mechanism, the free motion, its largest displacement of size
            one, shape (n, 3).
    """

    converged: bool
    reason: str
    iterations: tuple[Iteration, ...]
    retry: bool = False
    drawn_smooth: bool = False
    unstable: bool = False
    unlisted: int = 0
    lost_stability: bool = False
    motion: NDArray[np.float64] | None = None


Monitor = Callable[[int, Iteration], None]


class Solve(Protocol):
    """Brings a vector to equilibrium; tells the monitor the number of each iterate and the iterate."""

    def __call__(self, x: PETSc.Vec, monitor: Monitor = ..., thorough: bool = ...) -> Solution:
        """How it ended; the state is in x. What takes long and finds states far away is left out if not thorough."""
        ...


class Solver(Protocol):
    """Settings of a solver."""

    def prepare(self, problem: Problem) -> Solve:
        """A function that brings a vector to equilibrium; it keeps its workspace between calls."""
        ...


def silent(number: int, iterate: Iteration) -> None:
    """A monitor that does nothing."""


def tolerance(problem: Problem, x: PETSc.Vec, b: PETSc.Vec, rtol: float) -> float:
    """What the 2-norm of the unbalanced forces, rounding set aside, must be below [N], for the residual b in x.

    Where prestress is far above the loads it is a share of the loads: what they cause is to be found, too.

    Args:
        problem: The problem.
        x: The iterate.
        b: Its residual, with the reactions at held components.
        rtol: Part of the norm of all nodal forces, or of `MOST` times that of the loads where it is smaller; at the
            start `ROUNDING`, so that loads far below the prestress take their step too.
    """
    loads = problem.load_norm(x)
    forces = float(b.norm()) + loads
    return max(rtol * min(forces, MOST * loads or forces), 1e-300)


def lost(problem: Problem, x: PETSc.Vec, residual: float) -> bool:
    """Whether an iterate is so far off, or no number at all, that there is no way back."""
    return not (math.isfinite(residual) and largest(x) <= FAR * problem.discretization.structure.size)


def largest(vector: PETSc.Vec) -> float:
    """Largest absolute value; not a number where there is one that is not a number, on every process.

    MPI's maximum leaves open what becomes of them: some processes get the largest of the others, and go on.
    """
    return math.nan if math.isnan(vector.sum()) else float(vector.norm(PETSc.NormType.NORM_INFINITY))
