"""The equilibrium problem: total potential energy, residual and tangent of all parts together.

    Pi(u) = sum of strain energies - f . u,    R = dPi/du - f_p(u),    K = dR/du        Gil (50), (51), (68)-(71)

with dead loads f and follower pressures f_p, which in general have no potential. Loads, constraints and their
displacements change from stage to stage as data: nothing is compiled twice.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..model.fingerprints import fingerprints
from ..model.structure import Structure
from ..runtime.processes import refuse_differences
from .discretization import Discretization
from .part_forms import PartForms, mass_form, part_forms, tension_form
from .rounding import UNIT, Scales, prestress_force, scales, typical_stiffness


@dataclass(frozen=True, eq=False)
class Actions:
    """Actions on a structure at one instant, in the user's order of nodes.

    Attributes:
        loads: Dead loads on the nodes, shape (n, 3) [N].
        held: Components with a given displacement, shape (n, 3).
        displacement: The given displacements, shape (n, 3) [m]; without meaning at free components.
        pressures: For membranes by name, pressure along `Structure.normals`, shape (cells,) [Pa].
    """

    loads: NDArray[np.float64]
    held: NDArray[np.bool_]
    displacement: NDArray[np.float64]
    pressures: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)


class Problem:
    """Energy, residual and tangent of a structure under given actions.

    Args:
        structure: The structure.
        comm: The processes that share the work; each must give the same structure.
        elastic: False keeps the prestress as the only stress at any strain: for form finding.

    Raises:
        ValueError: The structure is not the same on all processes.

    Attributes:
        discretization: The meshes and their common numbering.
        parts: Forms of the parts of which this process has cells.
        symmetric: True if the tangent is symmetric: without follower pressure.
        prestress_forces: 2-norm of the prestress forces of all cells, before they balance [N].
        stiffness: A typical stiffness [N/m], the diagonal entry of constrained components: it scales their error to a
            force.
        tension: Stabilization: artificial tension in all parts, as a strain, times the stiffness of each. It is in the
            energy, the residual and the tangent; nonzero only during a homotopy.
    """

    def __init__(self, structure: Structure, comm: MPI.Intracomm = MPI.COMM_WORLD, elastic: bool = True):
        refuse_differences(comm, lambda: fingerprints(structure))
        _dolfinx.free_dropped(comm)
        self.discretization = Discretization(structure, comm)
        self.parts = {name: part_forms(mesh, structure, elastic) for name, mesh in self.discretization.parts.items()}
        self.prestress_forces = prestress_force(structure)
        self.stiffness = typical_stiffness(structure)
        owned = (np.repeat(sizes[self.discretization.owned_nodes], 3) for sizes in scales(structure, elastic))
        self._scales = Scales(*owned)
        self.tension = 0.0
        self._tension_stiffness: PETSc.Mat | None = None
        self._points = self.discretization.to_petsc(structure.points)
        self._loads, self._prescribed = self._points.duplicate(), self._points.duplicate()
        self.apply(Actions(np.zeros(structure.points.shape), structure.supported, np.zeros(structure.points.shape)))

    def apply(self, actions: Actions) -> None:
        """Set loads, constrained components and their displacements."""
        self.symmetric = not any(p.any() for p in actions.pressures.values())
        for name, part in self.parts.items():
            part.p.x.array[:] = actions.pressures[name][part.mesh.cell_rows] if name in actions.pressures else 0.0
        self.discretization.to_petsc(actions.loads, self._loads)
        self.discretization.to_petsc(actions.displacement, self._prescribed)
        self._held = self.discretization.dofs(actions.held)
        self._held_here = self._held - self._loads.getOwnershipRange()[0]

    def nodal_loads(self, distributed_loads: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Convert dead loads on parts to nodal forces, shape (n, 3) [N].

        Args:
            distributed_loads: For each loaded part, load per reference area or length of each cell, shape (cells, 3).
        """
        for name, part in self.parts.items():
            part.q.x.array[:] = (
                distributed_loads[name][part.mesh.cell_rows].ravel() if name in distributed_loads else 0.0
            )
        with self.discretization.work(1) as (total,):
            return self.discretization.to_numpy(self._assemble(lambda part: part.load, total))

    def pressure_loads(self, x: PETSc.Vec) -> NDArray[np.float64]:
        """Convert the applied pressures to nodal forces in the shape x, shape (n, 3) [N]."""
        self._set(x)
        with self.discretization.work(1) as (total,):
            return self.discretization.to_numpy(self._assemble(lambda part: part.pressure, total))

    def loads(self, x: PETSc.Vec, total: PETSc.Vec) -> None:
        """Set a vector to the nodal loads in the shape x, dead loads and pressures [N]."""
        self._set(x)
        self._assemble(lambda part: part.pressure, total).axpy(1.0, self._loads)

    def unloaded(self) -> bool:
        """Return True if there are supports and prestress alone, without loads or prescribed displacements."""
        moved = bool(self._prescribed.array_r[self._held_here].any())
        return self.symmetric and not self._loads.norm() and not self.discretization.comm.allreduce(moved, MPI.LOR)

    def load_norm(self, x: PETSc.Vec) -> float:
        """2-norm of the nodal loads in the shape x, dead loads and pressures [N]."""
        dead = float(self._loads.norm())
        if self.symmetric:
            return dead
        self._set(x)
        with self.discretization.work(1) as (total,):
            return dead + float(self._assemble(lambda part: part.pressure, total).norm())

    def energy(self, x: PETSc.Vec) -> float:
        """Strain energy less the work of the dead loads [J], Gil (70); without pressures."""
        self._set(x)
        stored = sum(float(fem.assemble_scalar(part.energy)) for part in self.parts.values())
        energy = float(self.discretization.comm.allreduce(stored)) - float(self._loads.dot(x))
        if self.tension:
            with self.discretization.work(1) as (position,):
                position.waxpy(1.0, self._points, x)
                energy += 0.5 * self.tension * self.tension_work(position)
        return energy

    def energy_along(self, x: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """Energy at x + length step as a function of the length, with the work of pressures along the step [J].

        The force of a pressure is quadratic in the displacement. Three points give its power along a straight line, so
        that its work is exact with or without a potential.
        """

        def energy(length: float) -> float:
            with self.discretization.work(1) as (trial,):
                trial.waxpy(length, step, x)
                return self.energy(trial)

        if self.symmetric:
            return energy

        def power(length: float) -> float:
            with self.discretization.work(2) as (trial, forces):
                trial.waxpy(length, step, x)
                self._set(trial)
                return float(self._assemble(lambda part: part.pressure, forces).dot(step))

        p0, p1, p2 = power(0.0), power(0.5), power(1.0)
        linear, square = 4 * p1 - 3 * p0 - p2, 2 * (p0 + p2) - 4 * p1

        def work(length: float) -> float:
            return length * (p0 + length * (linear / 2 + length * square / 3))

        return lambda length: energy(length) - work(length)

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Residual: internal minus external nodal forces [N], Gil (50); at constrained components, the reaction."""
        self._set(x)
        self._assemble(lambda part: part.residual, b).axpy(-1.0, self._loads)
        if self.tension:
            with self.discretization.work(2) as (position, forces):
                position.waxpy(1.0, self._points, x)
                self._tension().mult(position, forces)
                b.axpy(self.tension, forces)

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Tangent: derivative of the residual [N/m], Gil (51)-(53), (57)."""
        self._set(x)
        self._assemble_matrix(lambda part: part.tangent, A)
        if self.tension:
            A.axpy(self.tension, self._tension(), PETSc.Mat.Structure.SAME_NONZERO_PATTERN)

    @contextmanager
    def no_compression_stiffness(self, left: float = 0.0) -> Iterator[None]:
        """Set aside the compression stiffness of wrinkled and slack cells.

        Args:
            left: Fraction of the compression stiffness that remains [-].
        """
        shares = [part.kept for part in self.parts.values() if part.kept is not None and part.kept.value < 1]
        values = [float(share.value) for share in shares]
        for share, value in zip(shares, values, strict=True):
            share.value = left * value
        try:
            yield
        finally:
            for share, value in zip(shares, values, strict=True):
                share.value = value

    def stiff_nodes(self, A: PETSc.Mat) -> NDArray[np.bool_]:
        """Nodes with an entry in a tangent, shape (n,): all except those where no cell has stiffness."""
        here = self.discretization.create_vector()
        pointers, _, values = A.getValuesCSR()
        entries = np.repeat(np.arange(len(pointers) - 1), np.diff(pointers))
        np.maximum.at(here.array, entries, np.abs(values))
        return np.any(self.discretization.to_numpy(here), axis=1)

    def mass(self, A: PETSc.Mat) -> None:
        """Consistent mass matrix [kg], independent of the state."""
        self._assemble_matrix(lambda part: mass_form(part.mesh), A)

    def constrain_residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Replace reactions in the residual by the error of the constrained components times `stiffness` [N]."""
        gap = x.array_r[self._held_here] - self._prescribed.array_r[self._held_here]
        b.array[self._held_here] = self.stiffness * gap

    def beyond_rounding(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Norm (2-norm) of a constrained residual in the state x beyond the rounding of each entry [N]."""
        displacement = float(x.norm(PETSc.NormType.NORM_INFINITY))
        rounding = self._scales.rounding(displacement)
        rounding[self._held_here] = UNIT * self.stiffness * displacement
        beyond = np.maximum(np.abs(b.array_r) - rounding, 0.0)
        return math.sqrt(self.discretization.comm.allreduce(float(beyond @ beyond)))

    def impose(self, x: PETSc.Vec) -> bool:
        """Impose the prescribed displacements; return True if a component was elsewhere."""
        prescribed = self._prescribed.array_r[self._held_here]
        elsewhere = bool((x.array_r[self._held_here] != prescribed).any())
        x.array[self._held_here] = prescribed
        return bool(self.discretization.comm.allreduce(elsewhere, MPI.LOR))

    def zero_constrained(self, v: PETSc.Vec) -> None:
        """Set the entries of constrained components to zero."""
        v.array[self._held_here] = 0.0

    def constrain_tangent(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec) -> None:
        """Constrain A dx = b: dx closes the error of constrained components, b gets its effect on others."""
        with self.discretization.work(1) as (gap,):
            gap.waxpy(-1.0, self._prescribed, x)
            A.zeroRowsColumns(self._held, diag=self.stiffness, x=gap, b=b)

    def stiffen(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec, tension: float) -> None:
        """Add a shift, an artificial tension given as a strain, to a constrained tangent."""
        A.axpy(tension, self._tension(), PETSc.Mat.Structure.SAME_NONZERO_PATTERN)
        self.constrain_tangent(x, A, b)

    def tension_work(self, v: PETSc.Vec) -> float:
        """Double the work of a displacement against an artificial tension of strain one [J]."""
        with self.discretization.work(1) as (forces,):
            self._tension().mult(v, forces)
            return float(v.dot(forces))

    def _tension(self) -> PETSc.Mat:
        """Stiffness of an artificial tension of strain one, made on first use."""
        if self._tension_stiffness is None:
            self._tension_stiffness = self.discretization.create_matrix()
            self._assemble_matrix(tension_form, self._tension_stiffness)
        return self._tension_stiffness

    def _set(self, x: PETSc.Vec) -> None:
        self.discretization.scatter(x)
        for part in self.parts.values():
            part.follow()

    def _assemble_matrix(self, form: Callable[[PartForms], Any], A: PETSc.Mat) -> None:
        """Sum a bilinear form over the parts, into A."""
        A.zeroEntries()
        for name in self.discretization.structure.parts:
            if name in self.parts:
                part = self.parts[name]
                A.setLGMap(part.mesh.lgmap, part.mesh.lgmap)
                fem_petsc.assemble_matrix(A, form(part))
            else:  # end of assemble_matrix, together on all processes
                A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        A.assemble()

    def _assemble(self, form: Callable[[PartForms], Any], b: PETSc.Vec) -> PETSc.Vec:
        """Sum a linear form over the parts that have it, into b."""
        b.set(0.0)
        having = (part for part in self.parts.values() if form(part) is not None)
        shares = ((part.mesh, _assemble_vector(part, form(part))) for part in having)
        self.discretization.scatter_add(shares, b)
        return b


def _assemble_vector(part: PartForms, form: Any) -> NDArray[np.float64]:
    values = np.zeros(len(part.mesh.u.x.array))
    fem.assemble_vector(values, form)
    return values
