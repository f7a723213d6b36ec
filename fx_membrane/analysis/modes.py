"""Small motions about an equilibrium state: natural frequencies and mode shapes, and the lowest stiffnesses.

With the tangent K of the state and the consistent mass matrix M, both without the constrained components,

    K phi = omega^2 M phi.

Loads of fixed direction do not enter K; follower pressures do, Gil (57). If a pressure has a potential, as a uniform
one within held edges, K is symmetric. Otherwise K is unsymmetric, and omega may be complex (flutter). Cells stay taut,
wrinkled or slack, as they are in the state. Water keeps its volume, also at an outlet that moves.
"""

from __future__ import annotations

from dataclasses import dataclass
from html import escape

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem import NO_MASS, Problem
from ..checks import validation
from ..model.digests import of_settings
from ..results.owner import problem_of
from ..results.remarks import held_by_slack_parts
from ..results.states import StageResult
from ..runtime.notebook_pictures import table
from ..runtime.processes import refuse_differences, together
from ..solvers import eigenvalues, factorization
from ..solvers.augmented_matrix import augmented
from ..solvers.eigenvalues import Eigenpair
from .stiffness_spectrum import Rows, lowest_spectrum
from .wave_speed import warn_of_mass_units

Array = NDArray[np.float64]

SHOWN = 6  # number of frequencies printed


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Natural frequencies and mode shapes: u(t) = shape exp(growth t) cos(2 pi frequency t).

    Attributes:
        frequencies: Ascending, shape (count,) [Hz]; 0 in an unstable mode without flutter.
        growth: Growth rate of each mode, shape (count,) [1/s]: 0 where stable. Growing modes come first, the fastest
            before the others, with frequency 0. Only flutter, under a pressure without a potential, has both.
        shapes: Displacements of modal mass 1, phi^T M phi = 1 kg, shape (count, n, 3) [m]; 0 at constrained components.
            Modes of the same frequency are an arbitrary basis of their motions. Flutter takes two places, with shapes a
            and b: u(t) = exp(growth t) (a cos(2 pi frequency t) - b sin(2 pi frequency t)).

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Cable(polyline([0, 1, 2]), 1e6, prestress=1e3, mass=0.5)
        >>> rest = Analysis(Structure(points, {"rope": rope}, [Support([0, 2])])).run([Stage("rest")])["rest"]
        >>> modes = natural_frequencies(rest, 2)
        >>> modes.frequencies.round(3).tolist(), modes.growth.tolist(), modes.shapes.shape
        ([4.109, 4.109], [0.0, 0.0], (2, 3, 3))
    """

    frequencies: Array
    growth: Array
    shapes: Array

    def __repr__(self) -> str:
        frequencies = ", ".join(f"{frequency:.4g}" for frequency in self.frequencies[:SHOWN])
        more = ", ..." if len(self.frequencies) > SHOWN else ""
        return f"Modes({frequencies}{more} Hz, {np.count_nonzero(self.growth)} that grow)"

    def _repr_html_(self) -> str:
        """Show all frequencies in notebooks."""
        rows = [
            [str(number), f"{frequency:.5g}", f"{growth:.5g}"]
            for number, (frequency, growth) in enumerate(zip(self.frequencies, self.growth, strict=True))
        ]
        return f"<b>{escape(repr(self))}</b>" + table(["mode", "frequency [Hz]", "growth rate [1/s]"], rows)


@dataclass(frozen=True, eq=False, repr=False)
class Stability:
    """Lowest eigenvalues of the tangent: force over displacement, as 2-norms over all free components.

    The sign shows if the state is stable. The value depends on the mesh: a finer one spreads the same displacement over
    more nodes. An unsymmetric tangent is replaced by its symmetric part. While its eigenvalues are positive, so is the
    work of every small displacement (R. Hill, J. Mech. Phys. Solids 6 (1958) 236-249), and the state does not diverge.
    Flutter shows in `natural_frequencies` only.

    Water at an outlet that is held keeps its level, as if it were fed; a level sheet off which all rain has run is dry.
    At an outlet that moves, water runs off where that sinks, and keeps its volume where it rises. Each has a tangent of
    its own, the first one unsymmetric. The worse of the two counts, by the real parts of its eigenvalues.

    The `compression_stiffness` of wrinkled and slack cells is set aside: slack cells that buckle from node to node are
    no instability. Nodes at which all cells are slack then have no stiffness; they are left out if the others are
    enough. A remaining motion without stiffness is a mechanism of the structure. If slack parts push, the state is no
    equilibrium without them, and its eigenvalues mean little: see `held_by_slack`.

    Attributes:
        stiffnesses: Ascending, shape (count,) [N/m]; 0 for none up to rounding. Real parts of complex ones.
        directions: Displacements of 2-norm 1, shape (count, n, 3) [-]; 0 at components constrained or left out.
        negative: Number of negative eigenvalues, found or not: 0 in a stable state.
        free: Number of zero eigenvalues, found or not: 0 where every motion meets resistance.
        held_by_slack: Sentence on masts or a node that only slack parts hold; empty if there are none.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> found = stability(Analysis(rope).run([Stage("rest")])["rest"], 2)
        >>> found.stable, found.stiffnesses.round(1).tolist()
        (True, [666.7, 666.7])
    """

    stiffnesses: Array
    directions: Array
    negative: int
    free: int
    held_by_slack: str = ""

    @property
    def stable(self) -> bool:
        """True if every small motion meets resistance, and nothing hangs on slack parts."""
        return not (self.negative or self.free or self.held_by_slack)

    def __repr__(self) -> str:
        counts = f"{self.negative} negative" + f", {self.free} zero" * bool(self.free)
        counts += f"; {self.held_by_slack}" * bool(self.held_by_slack)
        return f"Stability(lowest stiffness {self.stiffnesses[0]:.4g}, {counts})"

    def _repr_html_(self) -> str:
        """Show the verdict and all stiffnesses in notebooks, with the node that moves most."""
        verdict = "stable" if self.stable else "not stable"
        rows = [
            [f"{stiffness:.5g}", str(np.linalg.norm(direction, axis=1).argmax())]
            for stiffness, direction in zip(self.stiffnesses, self.directions, strict=True)
        ]
        heads = ["stiffness [force/length]", "node that moves most"]
        return f"<b>{escape(repr(self))}: {verdict}</b>" + table(heads, rows)


def natural_frequencies(state: StageResult, count: int = 6, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Modes:
    """Lowest natural frequencies about a state, and their mode shapes; the constraints of the state hold.

    Parts without mass follow the others by their stiffness alone. Frequencies are in Hz if masses are in the unit that
    the other data imply: force unit times s2 over length unit. Examples: kg with N and m; t with kN and m (1.05 kg/m2
    is 1.05e-3 t/m2); t with N and mm (1.05e-9 t/mm2); lbf s2/in with lbf and in. Masses 1000 times too large give
    frequencies 32 times too low.

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

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Cable(polyline([0, 1, 2]), 1e6, prestress=1e3, mass=0.5)
        >>> rest = Analysis(Structure(points, {"rope": rope}, [Support([0, 2])])).run([Stage("rest")])["rest"]
        >>> natural_frequencies(rest, 2).frequencies.round(3).tolist()
        [4.109, 4.109]
    """
    validation.communicator("natural_frequencies comm", comm)
    with together(comm):
        validation.instance("natural_frequencies state", state, StageResult)
        parts = [part for part in state.structure.parts.values() if part.mass > 0]
        if not parts:
            raise ValueError(NO_MASS)
        if comm.rank == 0:
            warn_of_mass_units(state.structure, stacklevel=3)
        movable = np.zeros_like(state.actions.held)
        for part in parts:
            movable[part.cells] = True
        count = _checked_count("natural_frequencies", count, movable & ~state.actions.held, "components with mass")
    _refuse_differences(comm, state, count)
    problem = problem_of(state, comm)
    x = problem.to_petsc(state.displacement)
    loaded = problem.under(state.actions)
    K = _free(problem, loaded.tangent(x), ~state.actions.held)
    M = _free(problem, problem.mass(), ~state.actions.held)
    whole = augmented(K, M, loaded.borders(x), _rows(problem, ~state.actions.held))
    assert whole.M is not None
    if factorization.is_symmetric(whole.K):
        pairs, _ = eigenvalues.lowest(whole.K, whole.M, count, borders=whole.negative)
    else:
        pairs = eigenvalues.lowest_unsymmetric(whole.K, whole.M, count, whole.negative)
    omega = np.sqrt([pair.value for pair in pairs])
    return Modes(omega.real / (2 * np.pi), np.abs(omega.imag), _shapes(problem, ~state.actions.held, pairs))


def stability(state: StageResult, count: int = 1, comm: MPI.Intracomm = MPI.COMM_WORLD) -> Stability:
    """Lowest eigenvalues of the tangent of a state, and their directions; the constraints of the state hold.

    The compression stiffness of slack and wrinkled cells is set aside, see `Stability`.

    Args:
        state: An equilibrium state.
        count: Number of eigenvalues.
        comm: The processes that share the work; each must give the same state.

    Raises:
        ValueError: Fewer than count components can move.
        RuntimeError: The eigenvalue solver did not converge.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> stability(Analysis(rope).run([Stage("rest")])["rest"]).stable
        True
    """
    validation.communicator("stability comm", comm)
    with together(comm):
        validation.instance("stability state", state, StageResult)
        count = _checked_count("stability", count, state.structure.used[:, None] & ~state.actions.held, "components")
    _refuse_differences(comm, state, count)
    problem = problem_of(state, comm)
    loaded, x = problem.under(state.actions), problem.to_petsc(state.displacement)
    K = loaded.without_compression_stiffness().tangent(x)
    released = _released(problem, K, state, count)
    K = _free(problem, K, released)
    if not factorization.is_symmetric(K):
        factorization.symmetrize(K)
    found = lowest_spectrum(loaded, x, K, _rows(problem, released), count)
    stiffnesses = np.array([pair.value.real for pair in found.pairs])
    shapes = _shapes(problem, released, found.pairs)
    return Stability(stiffnesses, shapes, found.negative, found.zero, held_by_slack_parts(state))


def _checked_count(function: str, count: int, movable: NDArray[np.bool_], what: str) -> int:
    available = np.count_nonzero(movable)
    count = validation.positive_integer(f"{function} count", count)
    if count > available:
        raise ValueError(f"{function} count is {count}, but {available} {what} can move; ask for no more.")
    return count


def _refuse_differences(comm: MPI.Intracomm, state: StageResult, count: int) -> None:
    given = {"displacement of the state": state.displacement, "actions of the state": state.actions, "count": count}
    refuse_differences(comm, lambda: of_settings(given))


def _released(problem: Problem, K: PETSc.Mat, state: StageResult, count: int) -> NDArray[np.bool_]:
    """Free components, shape (n, 3): those of nodes with stiffness if they are enough, else all."""
    rows = np.repeat(problem.discretization.stiff_nodes(K)[:, None], 3, axis=1) & ~state.actions.held
    return rows if np.count_nonzero(rows) >= count else ~state.actions.held


def _free(problem: Problem, A: PETSc.Mat, released: NDArray[np.bool_]) -> PETSc.Mat:
    """Keep the rows and columns of the free components, shape (n, 3); the full matrix is freed."""
    free = PETSc.IS().createGeneral(problem.discretization.dofs(released), comm=A.comm)
    part = A.createSubMatrix(free, free)
    A.destroy()
    return part


def _rows(problem: Problem, released: NDArray[np.bool_]) -> Rows:
    """Rows of the released components, shape (n, 3), among those of this process's part of a vector."""
    return problem.discretization.dofs(released) - 3 * problem.discretization.first_block


def _shapes(problem: Problem, released: NDArray[np.bool_], pairs: list[Eigenpair]) -> Array:
    """Eigenvectors in the user's order, shape (count, n, 3); of a conjugate pair real part, then imaginary part.

    Eigenvectors have an arbitrary factor. The first of the largest components is made positive, for any number of
    processes.
    """
    result = np.zeros((len(pairs), *released.shape))
    for shape, pair in zip(result, pairs, strict=True):
        vector = _full(problem, released, pair.real) + 1j * _full(problem, released, pair.imaginary)
        size = np.abs(vector)
        first = vector.flat[np.flatnonzero(size > (1 - 1e-6) * size.max())[0]]
        vector *= np.conj(first) / np.abs(first)
        shape[:] = vector.imag if pair.value.imag < 0 else vector.real
    return result


def _full(problem: Problem, released: NDArray[np.bool_], vector: PETSc.Vec) -> Array:
    """Nodal values on every process, shape (n, 3), from a vector of the free components."""
    full = problem.create_vector()
    free = problem.discretization.dofs(released) - full.getOwnershipRange()[0]
    full.array[free] = vector.array_r[: len(free)]  # borders follow
    return problem.to_numpy(full)
