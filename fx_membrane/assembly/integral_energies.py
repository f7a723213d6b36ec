"""Energies of one integral of the shape each: the volume of enclosed gas, the length of a rope, water on a roof.

    E = phi(I(u)),    dE = phi' dI,    d2E = phi' d2I + phi'' dI dI^T

d2I is sparse. The second part of the tangent is of rank one, a border: K + sum of B B^T / C, with B = dI and the
compliance C = 1 / phi''. With a given integral instead of a law, I(u) = I0, the same border has C = 0, and phi' is a
Lagrange multiplier: the pressure that keeps a volume, the force that keeps a length.

The multiplier of an equilibrium follows from its shape: it is the one that leaves the least forces at the free
components. So a state is its displacement alone, with and without given integrals.

Source: J. Nocedal, S. J. Wright, Numerical optimization (2006), chapters 17.3 and 18.2: augmented Lagrangian, and
(18.16) for the multiplier.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .held_components import Constraints
from .one_integral import EnergyOfIntegral, FollowingEnergy, GivenIntegral, IntegralEnergy

Array = NDArray[np.float64]

RATE = 1e-4  # difference of load factors for a derivative


class Borders(NamedTuple):
    """Borders of a tangent K in a state: K dx + B q = b, B^T dx - C q = r.

    Attributes:
        vectors: Columns of B, zero at constrained components; `free` them after use.
        compliances: C, shape (m,); 0 for a given integral.
        rest: r, shape (m,): what a given integral is above its value, less what the constrained components close of it.
        given: True for given integrals, shape (m,).
        held: Derivatives of the integrals by the constrained components of this process, shape (m, components).
        rows: Columns that stand for B in B^T: those of B, but for a `FollowingEnergy`, whose part is not symmetric.
    """

    vectors: list[PETSc.Vec]
    compliances: Array
    rest: Array
    given: NDArray[np.bool_]
    held: Array
    rows: list[PETSc.Vec]

    @property
    def two_sided(self) -> NDArray[np.bool_]:
        """True for symmetric parts, shape (m,)."""
        return np.array([row is column for row, column in zip(self.rows, self.vectors, strict=True)], dtype=bool)

    def closed_by(self, moves: Array, comm: MPI.Intracomm) -> Array:
        """B^T dx of given steps of the constrained components of this process, shape (m,); collective."""
        return np.asarray(comm.allreduce(self.held @ moves))

    def free(self) -> None:
        """Free the vectors; collective."""
        for vector in {id(vector): vector for vector in (*self.vectors, *self.rows)}.values():
            vector.destroy()
        self.vectors.clear()
        self.rows.clear()


NO_BORDERS = Borders([], np.zeros(0), np.zeros(0), np.zeros(0, dtype=bool), np.zeros((0, 0)), [])


@dataclass(frozen=True, eq=False)
class IntegralEnergies:
    """Energies of integrals that act in a problem.

    Attributes:
        all: The energies.
        settled: True if the multipliers of given integrals are set; else their energies are left out.
    """

    all: tuple[IntegralEnergy, ...] = ()
    settled: bool = True

    @property
    def given(self) -> tuple[GivenIntegral, ...]:
        """The given integrals."""
        return tuple(energy for energy in self.all if isinstance(energy, GivenIntegral))

    @property
    def acting(self) -> tuple[IntegralEnergy, ...]:
        """Energies with a known force: all, or those by a law where multipliers are not set."""
        return tuple(energy for energy in self.all if self.settled or not isinstance(energy, GivenIntegral))

    def energy(self, x: PETSc.Vec) -> float:
        """Sum of the energies, equal on all processes [J]."""
        return sum(energy.energy(x) for energy in self.acting)

    def following(self, x: PETSc.Vec) -> list[FollowingEnergy]:
        """Energies whose forces have no potential in a state."""
        return [energy for energy in self.acting if isinstance(energy, FollowingEnergy) and energy.follows(x)]

    def without_potential(self, x: PETSc.Vec) -> list[FollowingEnergy]:
        """Energies that are no potential of their forces around a state, even of water that only begins to stand."""
        following = [energy for energy in self.acting if isinstance(energy, FollowingEnergy)]
        return [energy for energy in following if energy.is_without_potential(x)]

    def size(self, x: PETSc.Vec) -> float:
        """Size of the terms that the energies are sums of: their differences are known to its rounding [J]."""
        return sum(energy.size(x) for energy in self.acting)

    def add_force_sizes(self, x: PETSc.Vec, sizes: NDArray[np.float64]) -> None:
        """Add the sizes of the terms of the forces of all laws to those of the components of this process [N]."""
        for energy in self.acting:
            if isinstance(energy, EnergyOfIntegral):
                energy.add_force_sizes(x, sizes)

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add the derivatives to a residual [N]."""
        for energy in self.acting:
            energy.add_gradient(x, b)

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add the sparse parts of the second derivatives to a tangent [N/m]."""
        for energy in self.acting:
            energy.add_hessian(x, A)

    def loads(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Subtract the gradients of loads from a vector: add their forces [N]."""
        loads = [energy for energy in self.acting if energy.is_load]
        if loads:
            b.scale(-1.0)
            for energy in loads:
                energy.add_gradient(x, b)
            b.scale(-1.0)

    def with_multipliers(self, forces: Sequence[float], penalties: Sequence[float]) -> IntegralEnergies:
        """Return the same energies with other multipliers of the given integrals, in their order."""
        new = iter(zip(forces, penalties, strict=True))

        def of(energy: IntegralEnergy) -> IntegralEnergy:
            if not isinstance(energy, GivenIntegral):
                return energy
            multiplier, penalty = next(new)
            return replace(energy, multiplier=float(multiplier), penalty=float(penalty))

        return IntegralEnergies(tuple(map(of, self.all)))

    def forces(self, x: PETSc.Vec) -> list[float]:
        """Return the forces phi' of the given integrals in a state, with those of the penalties."""
        return [energy.law.force(energy.integral.value(x)) for energy in self.given]

    def settle(self, x: PETSc.Vec, b: PETSc.Vec, constraints: Constraints) -> IntegralEnergies:
        """Set the multipliers to those that leave the least forces, in the 2-norm, at the free components.

        Args:
            x: The state.
            b: Residual without the given integrals [N].
            constraints: The constrained components.
        """
        given = self.given
        with constraints.discretization.work(len(given) + 1) as (rest, *gradients):
            b.copy(rest)
            constraints.zero_constrained(rest)
            for energy, gradient in zip(given, gradients, strict=True):
                energy.integral.gradient(x, gradient)
                constraints.zero_constrained(gradient)
            products = np.array([[a.dot(c) for c in gradients] for a in gradients])
            forces = np.array([gradient.dot(rest) for gradient in gradients])
        found = np.linalg.lstsq(products, -forces, rcond=None)[0]
        squares = np.diag(products)
        # The same error as that of a constrained component: a displacement times a typical stiffness.
        penalties = np.divide(constraints.stiffness, squares, out=np.zeros_like(squares), where=squares > 0)
        return self.with_multipliers(found.tolist(), penalties.tolist())

    def borders(
        self, x: PETSc.Vec, constraints: Constraints, create: Callable[[], PETSc.Vec], one_sided: bool = False
    ) -> Borders:
        """Borders of the tangent in a state.

        Args:
            x: The state.
            constraints: The constrained components.
            create: Maker of a vector.
            one_sided: True for the unsymmetric ones of a `FollowingEnergy`; else those of motions that it does not
                follow. They are the last ones, in the order of `following`.
        """
        if not self.all:
            return NO_BORDERS
        rows = constraints.rows
        vectors, compliances, gaps, given, held = [], [], [], [], []
        following = self.following(x)
        kept = [] if one_sided else following
        makers: list[tuple[IntegralEnergy, Callable[[PETSc.Vec, PETSc.Vec], float | None]]]
        makers = [(one, one.border) for one in self.all if one not in following]
        makers += [(one, partial(one.border, kept=True)) for one in kept]
        for energy, border in makers:
            vector = create()
            compliance = border(x, vector)
            if compliance is None:
                vector.destroy()
                continue
            is_given = isinstance(energy, GivenIntegral)
            gaps.append(energy.integral.value(x) - energy.target if isinstance(energy, GivenIntegral) else 0.0)
            held.append(vector.array_r[rows])
            constraints.zero_constrained(vector)
            vectors.append(vector)
            compliances.append(compliance)
            given.append(is_given)
        across = list(vectors)
        for energy in following if one_sided else ():
            vectors.append(create())
            across.append(create())
            compliances.append(energy.one_sided_border(x, vectors[-1], across[-1]))
            held.append(across[-1].array_r[rows])
            for vector in (vectors[-1], across[-1]):
                constraints.zero_constrained(vector)
            gaps.append(0.0)
            given.append(False)
        found = Borders(
            vectors,
            np.array(compliances),
            np.array(gaps),
            np.array(given, dtype=bool),
            np.reshape(held, (len(vectors), len(rows))),
            across,
        )
        moves = x.array_r[rows] - constraints.prescribed
        return found._replace(rest=found.rest - found.closed_by(moves, constraints.discretization.comm))


def add_rate(x: PETSc.Vec, at: Callable[[float], IntegralEnergies], factor: float, b: PETSc.Vec) -> Array:
    """Add the derivative of the residual by a load factor through integrals, by a central difference.

    Args:
        x: Displacement [m].
        at: Energies of integrals at a load factor.
        factor: The load factor.
        b: Vector to which it is added [N].

    Returns:
        Derivatives of the values of given integrals.
    """
    ends = [at(factor + step) for step in (-RATE, RATE)]
    change = b.duplicate()
    for integrals, sign in zip(ends, (-1.0, 1.0), strict=True):
        change.set(0.0)
        integrals.add_gradient(x, change)
        b.axpy(sign / (2 * RATE), change)
    change.destroy()
    targets = [[energy.target for energy in integrals.given] for integrals in ends]
    return np.subtract(targets[1], targets[0]) / (2 * RATE)
