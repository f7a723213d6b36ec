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

from .discretization import Discretization
from .energy_terms import TermPool
from .part_forms import PartForms


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

    def update(self, x: PETSc.Vec, data: CellData) -> None:
        """Set displacement, wrinkling directions and cell data in the forms; collective."""
        self.discretization.scatter(x)
        same = self._state == self.discretization.state and data.equals(self._data)
        if self.discretization.comm.allreduce(same, MPI.LAND):
            return
        self._energy = self._forces = None
        for name, part in self.parts.items():
            part.p.x.array[:] = data.pressures.get(name, 0.0)
            own = getattr(part.mesh.part, "compression_stiffness", 1.0)
            if part.kept is not None and own < 1:
                part.kept.value = data.compression * own
            part.follow()
        self._data, self._state = data, self.discretization.state

    def strain_energy(self) -> float:
        """Strain energy of the cells of this process [J], without pressures."""
        if self._energy is None:
            self._energy = self.scalar(lambda part: part.energy)
        return self._energy

    def internal_forces(self, b: PETSc.Vec) -> None:
        """Set b to the internal nodal forces less those of pressures [N]; collective."""
        if self._forces is None:
            self._forces = self.vector(lambda part: part.residual, b).array_r.copy()
        else:
            b.array[:] = self._forces

    def scalar(self, form: Callable[[PartForms], Any]) -> float:
        """Sum a scalar form over the parts of this process."""
        return sum(float(fem.assemble_scalar(form(part))) for part in self.parts.values())

    def vector(self, form: Callable[[PartForms], Any], b: PETSc.Vec) -> PETSc.Vec:
        """Sum a linear form over the parts that have it, into b; collective."""
        b.set(0.0)
        having = (part for part in self.parts.values() if form(part) is not None)
        self.discretization.scatter_add(((part.mesh, _vector(part, form(part))) for part in having), b)
        return b

    def matrix(self, form: Callable[[PartForms], Any], A: PETSc.Mat) -> PETSc.Mat:
        """Sum a bilinear form over the parts, into A; collective."""
        A.zeroEntries()
        for name in self.discretization.structure.parts:
            if name in self.parts:
                part = self.parts[name]
                A.setLGMap(part.mesh.lgmap, part.mesh.lgmap)
                fem_petsc.assemble_matrix(A, form(part))
            else:  # end of assemble_matrix, together on all processes
                A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        A.assemble()
        return A

    def nodal_loads(self, distributed_loads: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Convert dead loads on parts to nodal forces, shape (n, 3) [N]; collective.

        Args:
            distributed_loads: For each loaded part, load per reference area or length of each cell, shape (cells, 3).
        """
        for name, part in self.parts.items():
            part.q.x.array[:] = (
                distributed_loads[name][part.mesh.cell_rows].ravel() if name in distributed_loads else 0.0
            )
        with self.discretization.work(1) as (total,):
            return self.discretization.to_numpy(self.vector(lambda part: part.load, total))


def _vector(part: PartForms, form: Any) -> NDArray[np.float64]:
    values = np.zeros(len(part.mesh.u.x.array))
    fem.assemble_vector(values, form)
    return values
