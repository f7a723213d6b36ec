"""Stabilization of a structure: a tension in all parts, given as a strain times the stiffness of each.

With a shift s [-], that strain, and the stiffness T for a shift of one, it adds

    s (X + u) . T (X + u) / 2 to the energy,    s T (X + u) to the residual,    s T to the tangent.
"""

from __future__ import annotations

from petsc4py import PETSc

from .assembler import Assembler
from .discretization import MatrixKind, matrix_kind
from .matrix_forms import tension_form


class Stabilization:
    """Stabilization of unit shift; its matrix is made on first use.

    Args:
        assembler: Sums over the parts.
    """

    def __init__(self, assembler: Assembler):
        self._assembler, self._discretization = assembler, assembler.discretization
        self._points = self._discretization.to_petsc(self._discretization.structure.points)
        self._matrices: dict[MatrixKind, PETSc.Mat] = {}

    def matrix(self, kind: MatrixKind = "sbaij") -> PETSc.Mat:
        """Stiffness T of the stabilization [N/m], symmetric; the same in every state."""
        if kind not in self._matrices:
            self._matrices[kind] = self._assembler.matrix(tension_form, self._discretization.create_matrix(kind))
        return self._matrices[kind]

    def energy(self, x: PETSc.Vec) -> float:
        """Energy of the stabilization in the shape of a displacement x [J]."""
        with self._discretization.work(1) as (position,):
            position.waxpy(1.0, self._points, x)
            return 0.5 * self.work(position)

    def add_residual(self, shift: float, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add the nodal forces of a shift in the shape of a displacement x [N]."""
        with self._discretization.work(2) as (position, forces):
            position.waxpy(1.0, self._points, x)
            self.matrix().mult(position, forces)
            b.axpy(shift, forces)

    def add_tangent(self, shift: float, A: PETSc.Mat) -> None:
        """Add the stiffness of a shift to a tangent [N/m]."""
        kind = matrix_kind(A)
        # With the same pattern PETSc 3.18 to 3.25 adds one entry of each block of an upper triangle on processes.
        broken = kind == "sbaij" and A.comm.size > 1
        same = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN if broken else PETSc.Mat.Structure.SAME_NONZERO_PATTERN
        A.axpy(shift, self.matrix(kind), same)

    def work(self, v: PETSc.Vec) -> float:
        """Double the work of a displacement against the stabilization, v . T v [J]."""
        with self._discretization.work(1) as (forces,):
            self.matrix().mult(v, forces)
            return float(v.dot(forces))
