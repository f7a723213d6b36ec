"""Sums over the parts of a structure: scalars, nodal vectors and matrices, from the compiled forms."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, MutableMapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..model.ropes import Rope
from ..runtime.processes import everywhere
from .directed_forms import rope_pull
from .discretization import Discretization
from .energy_terms import TermPool
from .forms_of_parts import PartForms, part_forms, set_rope
from .gas import Chambers
from .ropes import RopeData, RopeState, rope_state

Coefficients = Callable[[PartForms, Any], Any]  # packed coefficients of a form of a part


@dataclass(frozen=True, eq=False)
class CellData:
    """Coefficients of the forms that differ between loaded problems.

    Attributes:
        pressures: Pressure on the cells of this process by part, for loaded parts, shape (cells,) [Pa].
        compression: Fraction of the compression stiffness of wrinkled and slack cells in effect [-].
        natural: H of `forms.natural_shape` on the cells of this process, by part, shape (cells, d, d) [-].
        prestress: Prestress on the cells of this process, for parts where it differs from their own, shape (cells, d,
            d) [N/m or N].
        ropes: Numbers of all ropes, by part.
        tensions: For cables of given force, share of the law and force beside it on the cells here, shape (cells, 2).
    """

    pressures: Mapping[str, NDArray[np.float64]]
    compression: float = 1.0
    natural: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    prestress: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    ropes: Mapping[str, RopeData] = field(default_factory=dict)
    tensions: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)

    def equals(self, other: CellData | None) -> bool:
        """Return True if the other data are the same numbers."""
        return self is other or (
            other is not None
            and self.compression == other.compression
            and self.ropes == other.ropes
            and _equal(self.pressures, other.pressures)
            and _equal(self.natural, other.natural)
            and _equal(self.tensions, other.tensions)
            and _equal(self.prestress, other.prestress)
        )


def _equal(one: Mapping[str, NDArray[np.float64]], other: Mapping[str, NDArray[np.float64]]) -> bool:
    return one.keys() == other.keys() and all(np.array_equal(values, other[name]) for name, values in one.items())


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
        ropes: State of all ropes, by part; equal on all processes.
        chambers: Volumes of the chambers.
    """

    def __init__(self, discretization: Discretization, parts: MutableMapping[str, PartForms]):
        self.discretization, self.parts = discretization, parts
        self.terms = TermPool(discretization, parts)
        self.ropes: dict[str, RopeState] = {}
        self.chambers = Chambers(discretization)
        self._data: CellData | None = None
        self._state = -1
        self._energy: float | None = None
        self._forces: NDArray[np.float64] | None = None
        self._packed: dict[str, tuple[list[Any], Any]] = {}

    def allow_changes(self, natural: Iterable[str], tensions: Iterable[str]) -> None:
        """Give parts of this process the forms of a natural shape or a given force, if they lack; not collective."""
        for name, part in self.parts.items():
            wanted = {"natural": name in natural, "given": name in tensions}
            have = {"natural": part.natural is not None, "given": part.tensions is not None}
            if part.elastic and not part.rope and any(wanted[key] and not have[key] for key in have):
                both = {key: wanted[key] or have[key] for key in have}
                self.parts[name] = part_forms(part.mesh, self.discretization.structure, **both)
                self._data = None
                self._packed.pop(name, None)

    def update(self, x: PETSc.Vec, data: CellData) -> None:
        """Set displacement, wrinkling directions and cell data in the forms; collective."""
        self.discretization.scatter(x)
        same = self._state == self.discretization.state and data.equals(self._data)
        if everywhere(self.discretization.comm, same):
            return
        self._energy = self._forces = None
        self._packed.clear()
        for name, part in self.parts.items():
            part.p.x.array[:] = data.pressures.get(name, 0.0)
            part.set_natural_shape(data.natural.get(name))
            part.set_tensions(data.tensions.get(name))
            part.set_prestress(data.prestress.get(name))
            own = part.mesh.part.compression_stiffness
            if part.compression_stiffness is not None and own < 1:
                part.compression_stiffness.value = data.compression * own
            part.update()
        self._set_ropes(data)
        self._data, self._state = data, self.discretization.state

    def strain_energy(self) -> float:
        """Strain energy of the cells of this process in the present state [J], without pressures."""
        if self._energy is None:
            self._energy = sum(self._own(part) for part in self.parts.values() if not part.rope)
            if self.discretization.comm.rank == 0:
                self._energy += sum(state.energy for state in self.ropes.values())
        return self._energy

    def _own(self, part: PartForms) -> float:
        """Energy of the cells of a part on this process [J], of a rope their elongation [m]."""
        return float(fem.assemble_scalar(part.energy, coeffs=self._coefficients(part, part.energy)))

    def _set_ropes(self, data: CellData) -> None:
        """Set the tension of all ropes from their elongation; collective."""
        here = np.array([self._own(self.parts[name]) if name in self.parts else 0.0 for name in data.ropes])
        elongations = self.discretization.comm.allreduce(here) if data.ropes else here
        for (name, numbers), elongation in zip(data.ropes.items(), elongations, strict=True):
            part = self.discretization.structure.part(name, Rope)
            kept = min(data.compression, 1.0) * part.compression_stiffness if part.compression_stiffness < 1 else 1.0
            self.ropes[name] = state = rope_state(part, numbers, float(elongation), kept)
            if name in self.parts:
                set_rope(self.parts[name], state)

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

    def pull(self, name: str, b: PETSc.Vec) -> None:
        """Set a vector to the derivative of the length of a rope by the displacement [-]; collective."""

        def form(part: PartForms) -> Any:
            directed = rope_pull(part) if part.mesh.name == name else None
            if directed:
                directed.direction.value = 1.0
            return directed and directed.form

        self.vector(form, b)

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
        self,
        form: Callable[[PartForms], Any],
        A: PETSc.Mat,
        coefficients: Coefficients | None = None,
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
