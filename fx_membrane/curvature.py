"""The softest motion of a structure in a state, and whether the state is stable against it."""

from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from . import factorization
from .problem import Problem

WEAK = 1e-9  # stiffness, as a strain, below which a motion counts as free
LARGEST = 1e4  # no motion is less stable than with this strain
STEPS = 4  # of inverse iteration


class Softest(NamedTuple):
    """The softest motion, as far as inverse iteration has come.

    Attributes:
        negative: Number of negative eigenvalues of the tangent with the artificial tension; of its symmetric part where
            a pressure makes it unsymmetric.
        motion: The displacement, of 2-norm 1; zero where held.
        stiffness: Work that it does against the tangent over that against an artificial tension of strain one [-].
    """

    negative: int
    motion: PETSc.Vec
    stiffness: float


def softest(problem: Problem, x: PETSc.Vec, tension: float) -> Softest:
    """Softest motion in a state.

    Args:
        problem: The problem.
        x: The state.
        tension: Artificial tension that is added to the tangent, as a strain: what is softer counts as free.
    """
    A, v, w, b = problem.discretization.create_matrix(), x.duplicate(), x.duplicate(), x.duplicate()
    problem.tangent(x, A)
    problem.hold_tangent(x, A, b)
    K = factorization.symmetric_part(A)
    problem.stiffen(x, A, b, tension)
    stiffened = factorization.symmetric_part(A)
    stiffened.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    solver = PETSc.KSP().create(problem.discretization.comm)
    factorization.choose(solver, stiffened, symmetric=True)
    # The same numbers on any number of processes, and in every component: no motion is overlooked by symmetry.
    shape = problem.discretization.structure.points.shape
    problem.discretization.distribute(np.random.default_rng(0).normal(size=shape)).copy(v)
    for _ in range(STEPS):
        problem.release(v)
        solver.solve(v, w)
        w.scale(1 / (w.norm() or 1.0))
        w.copy(v)
    work = float(v.dot(K * v))
    artificial = problem.tension_work(v)
    found = Softest(factorization.pivots(solver).negative, v, work / artificial if artificial else np.inf)
    for matrix in (A, K, stiffened):
        matrix.destroy()
    solver.destroy()
    return found


def downhill(problem: Problem, x: PETSc.Vec) -> Softest:
    """The motion along which the energy of a state falls most readily; its `negative` is 0 where there is none.

    The small stiffness that wrinkled and slack cells keep makes them buckle from node to node. That is no instability
    of the structure, and is left out.
    """
    with problem.without_kept_stiffness():
        first = found = softest(problem, x, tension := WEAK)
        # Inverse iteration finds what is nearest to -tension: below the lowest of all it is the lowest.
        while found.negative and tension < LARGEST:
            tension *= 4
            found = softest(problem, x, tension)
    return found._replace(negative=first.negative)
