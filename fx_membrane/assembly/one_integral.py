"""Energy of one integral of the shape, by a law or for a given value; see `integral_energies`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from .discretization import Discretization


class Integral(Protocol):
    """Integral of the shape; all methods are collective."""

    def value(self, x: PETSc.Vec) -> float:
        """Value for a displacement, equal on all processes."""

    def gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Set a vector to the derivative by the displacement."""

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat, factor: float) -> None:
        """Add the second derivative, times a factor, to a tangent, and assemble that."""


class Law(Protocol):
    """Energy as a function of an integral."""

    def energy(self, value: float) -> float:
        """Energy phi [J]."""

    def force(self, value: float) -> float:
        """First derivative phi'."""

    def stiffness(self, value: float) -> float:
        """Second derivative phi''; 0 for an integral of given force."""

    def size(self, value: float) -> float:
        """Size of the terms that the energy is a sum of, as rounding sees them [J]."""

    def force_size(self, value: float) -> float:
        """Size of the terms that the force phi' is a sum of, and of its change by the whole integral."""


class IntegralEnergy(Protocol):
    """Energy with a tangent that is sparse, but for one border; all methods are collective.

    Attributes:
        name: Name in messages and results.
        is_load: True if its forces count as loads, as those of gas; False for those of a structure, as of a rope.
    """

    @property
    def name(self) -> str:
        """Name."""

    @property
    def is_load(self) -> bool:
        """True for a load."""

    def energy(self, x: PETSc.Vec) -> float:
        """Energy for a displacement, equal on all processes [J]."""

    def size(self, x: PETSc.Vec) -> float:
        """Size of the terms that the energy is a sum of, equal on all processes [J]."""

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add the derivative of the energy to a residual [N]."""

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add the sparse part of the second derivative to a tangent, and assemble that [N/m]."""

    def border(self, x: PETSc.Vec, b: PETSc.Vec) -> float | None:
        """Set a vector to B, return the compliance C of the part B B^T / C; None if it has no part."""


@runtime_checkable
class FollowingEnergy(IntegralEnergy, Protocol):
    """Energy whose forces depend on components that it does not load, as water on the height of a drain.

    Where it follows those components, the forces have no potential, and the tangent has a part B row^T / C. Motions
    that it does not follow have a symmetric part B B^T / C instead, as where a drain rises without more water.
    """

    def follows(self, x: PETSc.Vec) -> bool:
        """Return True if the forces depend on those components, equal on all processes."""

    def is_without_potential(self, x: PETSc.Vec) -> bool:
        """Return True if they do, or would with some water: the energy is then no potential of the forces."""

    def one_sided_border(self, x: PETSc.Vec, b: PETSc.Vec, row: PETSc.Vec) -> float:
        """Set vectors to B and the row; return C."""

    def border(self, x: PETSc.Vec, b: PETSc.Vec, kept: bool = False) -> float | None:
        """Border as of an `IntegralEnergy`; kept: that of motions that it does not follow."""


@dataclass(frozen=True, eq=False)
class EnergyOfIntegral:
    """Energy of an integral by a law.

    Attributes:
        name: Name in messages and results.
        discretization: The numbering.
        integral: The integral.
        law: The law.
        is_load: True if its forces count as loads.
    """

    name: str
    discretization: Discretization
    integral: Integral
    law: Law
    is_load: bool = True

    def energy(self, x: PETSc.Vec) -> float:
        """Energy for a displacement [J]."""
        return self.law.energy(self.integral.value(x))

    def size(self, x: PETSc.Vec) -> float:
        """Size of the terms of the energy [J]."""
        return self.law.size(self.integral.value(x))

    def add_force_sizes(self, x: PETSc.Vec, sizes: NDArray[np.float64]) -> None:
        """Add the sizes of the terms of the forces to those of the components of this process [N]."""
        with self.discretization.work(1) as (gradient,):
            self.integral.gradient(x, gradient)
            sizes += self.law.force_size(self.integral.value(x)) * np.abs(gradient.array_r)

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add the derivative of the energy to a residual [N]."""
        with self.discretization.work(1) as (gradient,):
            self.integral.gradient(x, gradient)
            b.axpy(self.law.force(self.integral.value(x)), gradient)

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add the sparse part of the second derivative to a tangent [N/m]."""
        self.integral.add_hessian(x, A, self.law.force(self.integral.value(x)))

    def border(self, x: PETSc.Vec, b: PETSc.Vec) -> float | None:
        """Set a vector to the derivative of the integral, return the compliance."""
        stiffness = self.law.stiffness(self.integral.value(x))
        if stiffness == 0:
            return None
        self.integral.gradient(x, b)
        return 1 / stiffness


@dataclass(frozen=True, eq=False)
class GivenIntegral(EnergyOfIntegral):
    """Integral of a given value, with the energy of its augmented Lagrangian.

    Attributes:
        target: The given value.
        multiplier: Estimate of phi'.
        penalty: Second derivative phi'' that the energy has beside the multiplier.
    """

    law: Law = field(init=False)
    target: float = field(kw_only=True)
    multiplier: float = 0.0
    penalty: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "law", _Augmented(self.target, self.multiplier, self.penalty))

    def border(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Set a vector to the derivative of the integral; the compliance is zero."""
        self.integral.gradient(x, b)
        return 0.0


class _Augmented(NamedTuple):
    """Augmented Lagrangian of a given value: m (I - I0) + k (I - I0)^2 / 2."""

    target: float
    multiplier: float
    penalty: float

    def energy(self, value: float) -> float:
        gap = value - self.target
        return self.multiplier * gap + self.penalty * gap**2 / 2

    def force(self, value: float) -> float:
        return self.multiplier + self.penalty * (value - self.target)

    def stiffness(self, value: float) -> float:
        return self.penalty

    def size(self, value: float) -> float:
        return (abs(self.multiplier) + self.penalty * abs(value - self.target)) * (abs(value) + abs(self.target))

    def force_size(self, value: float) -> float:
        return abs(self.multiplier) + self.penalty * (abs(value) + abs(self.target))
