"""Stiffness that couples all nodes of a rope: the derivative of its tension by its length, as a border of the tangent.

Forces and geometric stiffness of its segments are in the forms of the part, see `forms.rope`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from petsc4py import PETSc

from .assembler import Assembler


@dataclass(frozen=True, eq=False)
class RopeBorder:
    """Border of a rope, as `one_integral.IntegralEnergy` without an energy of its own.

    Attributes:
        name: Name of the part.
        assembler: Sums over the parts, in the state that is asked for.
    """

    name: str
    assembler: Assembler
    is_load: ClassVar[bool] = False

    def energy(self, x: PETSc.Vec) -> float:
        """Energy beside that of the part: none."""
        return 0.0

    def size(self, x: PETSc.Vec) -> float:
        """Size of that energy: none."""
        return 0.0

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add nothing: the forces are in the part."""

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add nothing: the geometric stiffness is in the part."""

    def border(self, x: PETSc.Vec, b: PETSc.Vec) -> float | None:
        """Set a vector to the derivative of the length, return the change of length per tension [m/N]."""
        stiffness = self.assembler.ropes[self.name].stiffness
        if stiffness == 0:
            return None
        self.assembler.pull(self.name, b)
        return 1 / stiffness
