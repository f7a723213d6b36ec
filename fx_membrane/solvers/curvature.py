"""The lowest mode of a structure in a state, and the stability of the state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from ..model.structure import Structure
from . import eigenvalues, factorization
from .augmented_matrix import augmented
from .bordered_system import BorderedSystem


@dataclass(frozen=True)
class ModeLimits:
    """Limits of modes and of the stability of states, as strains where nothing else is said.

    Attributes:
        free: Stiffness of a mode below which it is a free motion.
        below: Distance of the shift from the lowest eigenvalue, as a fraction.
        first: First bound of the negative curvature to try.
        crushed: Green's strain of a cell that has shrunk to nothing.
        least: Negative curvature that is ignored between two states.
        secants: Number of secants between two states.
        steps: Number of inverse iterations.
    """

    free: float = 1e-9
    below: float = 1e-3
    first: float = 1e-7
    crushed: float = 0.5
    least: float = 1e-4
    secants: int = 8
    steps: int = 4


MODES = ModeLimits()


class Mode(NamedTuple):
    """Lowest mode, to the accuracy of the inverse iteration.

    Attributes:
        negative: Number of negative eigenvalues of the shifted tangent; of its symmetric part if a pressure makes it
            unsymmetric.
        motion: The displacement, of 2-norm 1; zero at constrained components.
        stiffness: Rayleigh quotient v . K v / v . T v with the stabilization matrix T, a strain [-].
    """

    negative: int
    motion: PETSc.Vec
    stiffness: float


def lowest_mode(
    problem: LoadedProblem,
    x: PETSc.Vec,
    shift: float,
    moving: NDArray[np.bool_] | None = None,
    one_sided: bool = False,
) -> Mode:
    """Lowest mode of a state, by inverse iteration on K + shift T.

    Args:
        problem: The problem.
        x: The state.
        shift: Shift of the tangent, as a strain: what is softer counts as free.
        moving: Nodes that move, shape (n,); those of them without any stiffness, as where all cells are slack and keep
            none, stand still too. None: all nodes move.
        one_sided: True if the level of water at an outlet that moves follows that outlet, see `LoadedProblem.borders`.
    """
    A, v = problem.discretization.create_matrix(), x.duplicate()
    problem.tangent(x, A)
    still = _still(problem, moving, A)
    with problem.discretization.work(1) as (b,):
        problem.constraints.constrain_tangent(x, A, b)
        K = factorization.symmetric_part(A)
        problem.stiffen(x, A, b, shift)
    if moving is not None:
        A.zeroRowsColumns(still, diag=problem.magnitudes.stiffness)
    stiffened = factorization.symmetric_part(A)
    stiffened.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    solver = PETSc.KSP().create(problem.comm)
    factorization.choose(solver, stiffened, symmetric=True)
    bordered = BorderedSystem(problem.borders(x, one_sided))
    for border in (*bordered.borders.vectors, *bordered.borders.rows):
        border.array[still - border.getOwnershipRange()[0]] = 0.0
    solver.setUp()
    bordered.factor(solver)
    none = np.zeros(len(bordered.borders.vectors))
    # Random numbers, equal for any number of processes: symmetry hides no mode.
    problem.discretization.to_petsc(np.random.default_rng(0).normal(size=problem.structure.points.shape), v)
    v.array[still - v.getOwnershipRange()[0]] = 0.0
    with problem.discretization.work(1) as (w,):
        for _ in range(MODES.steps):
            problem.constraints.zero_constrained(v)
            solver.solve(v, w)
            bordered.correct(w, none)
            w.scale(1 / (w.norm() or 1.0))
            w.copy(v)
        bordered.multiply(K, v, w)
        work = float(v.dot(w))
    scale = problem.stabilizer.work(v)
    negative = bordered.negative(factorization.pivots(solver).negative)
    found = Mode(negative, v, work / scale if scale else np.inf)
    bordered.free()
    for matrix in (A, K, stiffened):
        matrix.destroy()
    solver.destroy()
    return found


def _still(problem: LoadedProblem, moving: NDArray[np.bool_] | None, A: PETSc.Mat) -> NDArray[np.int32]:
    """Components of nodes that stand still, as `lowest_mode` takes them."""
    structure = problem.structure
    at_rest = np.zeros(len(structure.points), dtype=bool)
    if moving is not None:
        at_rest = structure.used & ~(moving & problem.discretization.stiff_nodes(A))
    return problem.discretization.dofs(np.repeat(at_rest[:, None], 3, axis=1))


def negative_curvature_direction(problem: LoadedProblem, x: PETSc.Vec) -> Mode:
    """Direction of the most negative curvature; its `negative` is 0 if there is none.

    The small compression stiffness of wrinkled and slack cells lets them buckle from node to node. That is no
    instability of the structure, so it is left out. One factorization tells stable states. The direction of others
    is that of the lowest eigenvalue of K v = lambda T v.

    Water at an outlet that moves runs off where that sinks, and keeps its volume where it rises. A stable state resists
    both motions.
    """
    problem = problem.without_compression_stiffness()
    found = lowest_mode(problem, x, MODES.free)
    if not found.negative and problem.integrals.following(x):
        found.motion.destroy()
        return lowest_mode(problem, x, MODES.free, one_sided=True)
    if not found.negative:
        return found
    found.motion.destroy()
    # The vector of a multiple eigenvalue is that of inverse iteration: equal for any number of processes.
    direction = lowest_mode(problem, x, -(1 + MODES.below) * _lowest(problem, x))
    return direction._replace(negative=found.negative)


def _lowest(problem: LoadedProblem, x: PETSc.Vec) -> float:
    """Lowest eigenvalue of K v = lambda T v, known to be below that of a free motion, with its Sturm sequence check."""
    K, T = problem.tangent(x), problem.stabilizer.matrix("aij").copy()
    with problem.discretization.work(1) as (b,):
        problem.constraints.constrain_tangent(x, K, b)
    for matrix in (K, T):  # T, too, for an equal pattern
        factorization.symmetrize(matrix)
    T.zeroRowsColumns(problem.constraints.constrained, diag=0.0)
    whole = augmented(K, T, problem.borders(x))
    (pair, *_), _ = eigenvalues.lowest(whole.K, whole.M, 1, MODES.first, whole.negative)
    whole.free()
    return pair.value.real


def wrinkling_threshold(structure: Structure) -> float:
    """Upper bound of the negative curvature of wrinkled and slack cells in any shape, as a strain."""
    return MODES.crushed * _kept(structure)


def negative_between(problem: LoadedProblem, start: PETSc.Vec, end: PETSc.Vec) -> bool:
    """Return True if the energy is concave somewhere on the straight line between two states.

    It is if Hill's second-order work on the chord is negative, by differences of the residual. Both ends of a snap are
    stable, so that their inertia does not show it. Negative curvature of wrinkled and slack cells is ignored; without
    masts, pressures and energy terms there is none. Constrained components keep their end values.

    Source: R. Hill, A general theory of uniqueness and stability in elastic-plastic solids, J. Mech. Phys. Solids 6
    (1958) 236-249.
    """
    parts = problem.structure.parts.values()
    loaded = not problem.symmetric or problem.terms.all or problem.integrals.all
    if not loaded and not any(part.carries_compression for part in parts):
        return False
    forces = []
    with problem.discretization.work(3) as (at, way, b):
        start.copy(at)
        problem.constraints.impose(at)
        way.waxpy(-1.0, at, end)
        for _ in range(MODES.secants + 1):
            problem.residual(at, b)
            forces.append(float(b.dot(way)))
            at.axpy(1 / MODES.secants, way)
        least = max(MODES.least, wrinkling_threshold(problem.structure)) * problem.stabilizer.work(way)
    return bool((MODES.secants * np.diff(forces) < -least).any())


def _kept(structure: Structure) -> float:
    """Largest compression stiffness of a part, as a fraction of its stiffness; 0 if none can wrinkle or slacken."""
    parts = structure.parts.values()
    kept = [part.compression_stiffness for part in parts if not part.carries_compression]
    return max(kept, default=0.0)
