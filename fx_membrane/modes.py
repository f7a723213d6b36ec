"""Small motions about an equilibrium state: natural frequencies and mode shapes, and the lowest stiffnesses.

With the tangent K of the state and the consistent mass matrix M, both without the held components,

    K phi = omega^2 M phi.

Dead loads have no part in K. Follower pressure has, Gil (57): where it has a potential, as a uniform one within held
edges has, K is symmetric all the same; elsewhere K is not symmetric, and omega may be complex (flutter). Cells
stay taut, wrinkled or slack, as they are in the state.
"""

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from . import eigenvalues, factorization, validation
from .eigenvalues import Eigenpair
from .problem import Problem
from .results import StageResult
from .wave_speed import warn_of_mass_units

Array = NDArray[np.float64]

SHOWN = 6  # frequencies that are printed


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Natural frequencies and mode shapes: u(t) = shape exp(growth t) cos(2 pi frequency t).

    Attributes:
        frequencies: Ascending, shape (count,) [Hz]; 0 in a mode in which the state is unstable.
        growth: Rate at which each mode grows, shape (count,) [1/s]: 0 where stable. Modes that grow come first, the
            fastest before the others, with frequency 0. Only flutter, under a pressure without a potential, has both.
        shapes: Displacements of modal mass 1, phi^T M phi = 1 kg, shape (count, n, 3) [m]; 0 where held. Modes of the
            same frequency are some basis of their motions. Flutter takes two places, with shapes a and b:
            u(t) = exp(growth t) (a cos(2 pi frequency t) - b sin(2 pi frequency t)).
    """

    frequencies: Array
    growth: Array
    shapes: Array

    def __repr__(self) -> str:
        frequencies = ", ".join(f"{frequency:.4g}" for frequency in self.frequencies[:SHOWN])
        more = ", ..." if len(self.frequencies) > SHOWN else ""
        return f"Modes({frequencies}{more} Hz, {np.count_nonzero(self.growth)} that grow)"


@dataclass(frozen=True, eq=False, repr=False)
class Stability:
    """Lowest eigenvalues of the tangent: force over displacement, as 2-norms over all free components.

    The sign tells whether the state is stable. The value depends on the mesh: a finer one spreads the same
    displacement over more nodes. Where the tangent is not symmetric these are the eigenvalues of its symmetric part:
    while they are positive, so is the work of every small displacement (R. Hill, J. Mech. Phys. Solids 6 (1958)
    236-249), and the state does not diverge, but flutter is for `natural_frequencies` to tell.

    Attributes:
        stiffnesses: Ascending, shape (count,) [N/m].
        directions: Displacements of 2-norm 1, shape (count, n, 3) [-]; 0 where held.
        negative: Number of negative eigenvalues, found or not: 0 in a stable state.
    """

    stiffnesses: Array
    directions: Array
    negative: int

    def __repr__(self) -> str:
        return f"Stability(lowest stiffness {self.stiffnesses[0]:.4g}, {self.negative} negative)"


def natural_frequencies(state: StageResult, count: int = 6, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Modes:
    """Lowest natural frequencies about a state, and their shapes. What the state holds is held.

    Parts without mass follow the others by their stiffness alone. Frequencies are in Hz where masses are in the unit
    that the other data demand: force unit times s2 over length unit, that is kg with N and m, t with kN and m (1.05
    kg/m2 is 1.05e-3 t/m2), t with N and mm (1.05e-9 t/mm2), lbf s2/in with lbf and in. Masses 1000 times too large
    give frequencies 32 times too low.

    Args:
        state: An equilibrium state of a structure in which some parts have a `mass`.
        count: Number of modes.
        comm: The processes that share the work; each must give the same state.

    Raises:
        ValueError: No part has mass; fewer than count components have mass and can move; the tangent stiffness is
            singular or negative where there is no mass.
        RuntimeError: The eigenvalue solver did not converge.

    Warns:
        MassUnitWarning: A mass makes waves slower or faster than in any fabric, cable or mast.
    """
    validation.instance("natural_frequencies state", state, StageResult)
    parts = [part for part in state.structure.parts.values() if part.mass > 0]
    if not parts:
        raise ValueError("No part has mass; give mass=... to membranes [kg/m2], cables or masts [kg/m].")
    if comm.rank == 0:
        warn_of_mass_units(state.structure, stacklevel=3)
    movable = np.zeros_like(state.actions.held)
    for part in parts:
        movable[part.cells] = True
    _check_count("natural_frequencies", count, movable & ~state.actions.held, "components with mass")
    problem, K = _tangent(state, comm)
    full = problem.discretization.create_matrix()
    problem.mass(full)
    M = _free(problem, full, state)
    if factorization.is_symmetric(K):
        pairs, _ = eigenvalues.lowest(K, M, count)
    else:
        pairs = eigenvalues.lowest_unsymmetric(K, M, count)
    omega = np.sqrt([pair.value for pair in pairs])
    return Modes(omega.real / (2 * np.pi), np.abs(omega.imag), _shapes(problem, state, pairs))


def stability(state: StageResult, count: int = 1, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Stability:
    """Lowest eigenvalues of the tangent of a state, and their directions. What the state holds is held.

    Args:
        state: An equilibrium state.
        count: Number of eigenvalues.
        comm: The processes that share the work; each must give the same state.

    Raises:
        ValueError: Fewer than count components can move.
        RuntimeError: The eigenvalue solver did not converge.
    """
    validation.instance("stability state", state, StageResult)
    _check_count("stability", count, state.structure.used[:, None] & ~state.actions.held, "components")
    problem, K = _tangent(state, comm)
    pairs, negative = eigenvalues.lowest(
        K if factorization.is_symmetric(K) else factorization.symmetric_part(K), None, count
    )
    return Stability(np.array([pair.value.real for pair in pairs]), _shapes(problem, state, pairs), negative)


def _check_count(function: str, count: int, movable: NDArray[np.bool_], what: str) -> None:
    available = np.count_nonzero(movable)
    if validation.whole(f"{function} count", count) > available:
        raise ValueError(f"{function} count is {count}, but {available} {what} can move; ask for no more.")


def _tangent(state: StageResult, comm: MPI.Intracomm) -> tuple[Problem, PETSc.Mat]:
    """The problem in the state, and its tangent without the held components."""
    problem = Problem(state.structure, comm)
    problem.apply(state.actions)
    K = problem.discretization.create_matrix()
    problem.tangent(problem.discretization.distribute(state.displacement), K)
    return problem, _free(problem, K, state)


def _free(problem: Problem, A: PETSc.Mat, state: StageResult) -> PETSc.Mat:
    """Rows and columns of the free components; the full matrix is freed."""
    free = PETSc.IS().createGeneral(problem.discretization.dofs(~state.actions.held), comm=A.comm)
    part = A.createSubMatrix(free, free)
    A.destroy()
    return part


def _shapes(problem: Problem, state: StageResult, pairs: list[Eigenpair]) -> Array:
    """Eigenvectors in the user's order, shape (count, n, 3); of a conjugate pair real part, then imaginary part.

    Eigenvectors have an arbitrary factor. Here the first of the largest components is positive, whoever computed it.
    """
    result = np.zeros((len(pairs), *state.displacement.shape))
    for shape, pair in zip(result, pairs, strict=True):
        vector = _full(problem, state, pair.real) + 1j * _full(problem, state, pair.imaginary)
        size = np.abs(vector)
        first = vector.flat[np.flatnonzero(size > (1 - 1e-6) * size.max())[0]]
        vector *= np.conj(first) / np.abs(first)
        shape[:] = vector.imag if pair.value.imag < 0 else vector.real
    return result


def _full(problem: Problem, state: StageResult, vector: PETSc.Vec) -> Array:
    """Nodal values on every process, shape (n, 3), of a vector of the free components."""
    full = problem.discretization.create_vector()
    free = problem.discretization.dofs(~state.actions.held) - full.getOwnershipRange()[0]
    full.array[free] = vector.array_r
    return problem.discretization.gather(full)
