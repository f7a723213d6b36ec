"""Sums over the parts of a structure: scalars, nodal vectors and matrices, from the compiled forms."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from .discretization import Discretization
from .energy_terms import TermPool
from .part_forms import PartForms

Coefficients = Callable[[PartForms, Any], Any]  # packed coefficients of a form of a part


@dataclass(frozen=True, eq=False)
class CellData:
    """Coefficients of the forms that differ between loaded problems.

    Attributes:
        pressures: Pressure on the cells of this process by part, for loaded parts, shape (cells,) [Pa].
        compression: Fraction of the compression stiffness of wrinkled and slack cells in effect [-].
    """

    pressures: Mapping[str, NDArray[np.float64]]
    compression: float = 1.0

    def equals(self, other: "CellData | None") -> bool:
        """Return True if the other data are the same numbers."""
        return self is other or (
            other is not None
            and self.compression == other.compression
            and self.pressures.keys() == other.pressures.keys()
            and all(np.array_equal(values, other.pressures[name]) for name, values in self.pressures.items())
        )


class Assembler:
    """Sums over the parts.

    All loaded problems share the coefficients of the forms. Each sets its own with `update` before it assembles; data
    that are there already are not written again. Energy and internal forces of the last state are kept: the end of a
    line search is the next iterate, and the last iterate is the result.

    Args:
        discretization: The meshes and their common numbering.
        parts: Forms of the parts of which this process has cells.

    Attributes:
        terms: Forms of the energy terms that were met.
    """

    def __init__(self, discretization: Discretization, parts: Mapping[str, PartForms]):
        self.discretization, self.parts = discretization, parts
        self.terms = TermPool(discretization, parts)
        self._data: CellData | None = None
        self._state = -1
        self._energy: float | None = None
        self._forces: NDArray[np.float64] | None = None
        self._packed: dict[str, tuple[list[Any], Any]] = {}

    def update(self, x: PETSc.Vec, data: CellData) -> None:
        """Set displacement, wrinkling directions and cell data in the forms; collective."""
        self.discretization.scatter(x)
        same = self._state == self.discretization.state and data.equals(self._data)
        if self.discretization.comm.allreduce(same, MPI.LAND):
            return
        self._energy = self._forces = None
        self._packed.clear()
        for name, part in self.parts.items():
            part.p.x.array[:] = data.pressures.get(name, 0.0)
            own = part.mesh.part.compression_stiffness
            if part.kept is not None and own < 1:
                part.kept.value = data.compression * own
            part.follow()
        self._data, self._state = data, self.discretization.state

    def strain_energy(self) -> float:
        """Strain energy of the cells of this process in the present state [J], without pressures."""
        if self._energy is None:
            self._energy = sum(
                float(fem.assemble_scalar(part.energy, coeffs=self._coefficients(part, part.energy)))
                for part in self.parts.values()
            )
        return self._energy

    def internal_forces(self, b: PETSc.Vec) -> None:
        """Set b to the internal nodal forces less those of pressures in the present state [N]; collective."""
        if self._forces is None:
            self.vector(lambda part: part.residual, b, self._coefficients)
            self._forces = b.array_r.copy()
        else:
            b.array[:] = self._forces

    def tangent(self, A: PETSc.Mat) -> None:
        """Set A to the derivative of `internal_forces` by the displacement [N/m]; collective."""
        self.matrix(lambda part: part.tangent, A, self._coefficients)
        self._packed.clear()  # it is large, and a factorization may follow

    def vector(
        self, form: Callable[[PartForms], Any], b: PETSc.Vec, coefficients: Coefficients | None = None
    ) -> PETSc.Vec:
        """Sum a linear form over the parts that have it, into b; collective.

        Args:
            form: The form of a part.
            b: The vector.
            coefficients: Packed coefficients of the form; they are packed for this sum if None.
        """
        b.set(0.0)
        having = (part for part in self.parts.values() if form(part) is not None)
        shares = ((part.mesh, _vector(part, form(part), coefficients)) for part in having)
        self.discretization.scatter_add(shares, b)
        return b

    def matrix(
        self, form: Callable[[PartForms], Any], A: PETSc.Mat, coefficients: Coefficients | None = None
    ) -> PETSc.Mat:
        """Sum a bilinear form over the parts, into A; collective; arguments as of `vector`."""
        A.zeroEntries()
        for name in self.discretization.structure.parts:
            if name in self.parts:
                part = self.parts[name]
                A.setLGMap(part.mesh.lgmap, part.mesh.lgmap)
                given = coefficients and coefficients(part, form(part))
                fem_petsc.assemble_matrix(A, form(part), coeffs=given)
            else:  # end of assemble_matrix, together on all processes
                A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        A.assemble()
        return A

    def _coefficients(self, part: PartForms, form: Any) -> Any:
        """Packed coefficients of a form in the present state; those of a form that begins with the same serve it."""
        wanted = _dolfinx.coefficients(form)
        have, values = self._packed.get(part.mesh.name, ([], None))
        if len(wanted) > len(have) or any(a is not b for a, b in zip(wanted, have, strict=False)):
            values = _dolfinx.packed(form)
            self._packed[part.mesh.name] = wanted, values
        return values

    def nodal_loads(self, distributed_loads: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Convert distributed loads on parts to nodal forces, Gil (47), (49), shape (n, 3) [N]; collective.

        Args:
            distributed_loads: For each loaded part, load per reference area or length of each cell, shape (cells, 3).
        """
        for name, part in self.parts.items():
            part.q.x.array[:] = (
                distributed_loads[name][part.mesh.cell_rows].ravel() if name in distributed_loads else 0.0
            )
        with self.discretization.work(1) as (total,):
            return self.discretization.to_numpy(self.vector(lambda part: part.load, total))


def _vector(part: PartForms, form: Any, coefficients: Coefficients | None) -> NDArray[np.float64]:
    values = np.zeros(len(part.mesh.u.x.array))
    fem.assemble_vector(values, form, coeffs=coefficients and coefficients(part, form))
    return values
