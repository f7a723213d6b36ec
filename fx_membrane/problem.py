"""The equilibrium problem: total potential energy, residual and tangent of all parts together.

    Pi(u) = sum of strain energies - f . u,    R = dPi/du,    K = dR/du            Gil (50), (51), (68)-(71)

The energy of each part is written in UFL; residual and tangent come from `ufl.derivative`, dolfinx assembles them.
What changes from stage to stage (dead loads `f`, held components and their values) is data: nothing is compiled twice.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from . import _dolfinx
from .discretization import Discretization, PartMesh
from .forms import elasticity, kinematics
from .forms import loads as load_forms
from .geometry import measures
from .material import Fabric
from .structure import Membrane, Structure


@dataclass(frozen=True, eq=False)
class PartForms:
    """Symbols and compiled forms of one part on this process.

    Attributes:
        mesh: The cells.
        T, F, E, S: Tangent frame, deformation gradient, Green-Lagrange strain, 2nd Piola-Kirchhoff stress, in UFL.
        q: Dead load per area or length, piecewise constant [N/m2 or N/m].
        energy, residual, tangent: Compiled strain energy and its two derivatives.
        load: Compiled virtual work of q.
    """

    mesh: PartMesh
    T: Any
    F: Any
    E: Any
    S: Any
    q: fem.Function
    energy: Any
    residual: Any
    tangent: Any
    load: Any


@dataclass(frozen=True, eq=False)
class Actions:
    """What acts on a structure at one instant, in the user's order of nodes.

    Attributes:
        loads: Dead loads on the nodes, shape (n, 3) [N].
        held: Components whose displacement is given, shape (n, 3).
        displacement: The given displacements, shape (n, 3) [m]; without meaning where not held.
    """

    loads: NDArray[np.float64]
    held: NDArray[np.bool_]
    displacement: NDArray[np.float64]


class Problem:
    """Energy, residual and tangent of a structure under given actions.

    Args:
        structure: The structure.
        comm: The processes that share the work; each must give the same structure.

    Attributes:
        discretization: The meshes and their common numbering.
        parts: Forms of the parts of which this process has cells.
        prestress_forces: 2-norm of the prestress forces of all cells, before they balance each other [N].
        stiffness: A typical stiffness [N/m], the diagonal entry of held components: it makes their error a force.
    """

    def __init__(self, structure: Structure, comm: MPI.Intracomm = MPI.COMM_WORLD):
        self.discretization = Discretization(structure, comm)
        self.parts = {name: _part_forms(mesh, structure) for name, mesh in self.discretization.parts.items()}
        self.prestress_forces = float(np.sqrt(sum(_prestress_forces(structure, name) for name in structure.parts)))
        self.stiffness = max(_typical_stiffness(structure, name) for name in structure.parts)
        self.apply(Actions(np.zeros(structure.points.shape), structure.supported, np.zeros(structure.points.shape)))

    def apply(self, actions: Actions) -> None:
        """Sets loads, held components and their displacements."""
        self._loads = self.discretization.distribute(actions.loads)
        self._prescribed = self.discretization.distribute(actions.displacement)
        self._held = self.discretization.dofs(actions.held)
        self._held_here = self._held - self._loads.getOwnershipRange()[0]

    def nodal_loads(self, dead_loads: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """Nodal forces of dead loads on parts, shape (n, 3) [N].

        Args:
            dead_loads: For each loaded part, load per reference area or length of each cell, shape (cells, 3).
        """

        def share(part: PartForms, q: NDArray[np.float64]) -> tuple[PartMesh, NDArray[np.float64]]:
            part.q.x.array[:] = q[part.mesh.cells].ravel()
            return part.mesh, _assemble_vector(part.load)

        total = self.discretization.create_vector()
        shares = (share(self.parts[name], q) for name, q in dead_loads.items() if name in self.parts)
        self.discretization.add_from_meshes(shares, total)
        return self.discretization.gather(total)

    def energy(self, x: PETSc.Vec) -> float:
        """Total potential energy [J], Gil (70)."""
        self.discretization.to_meshes(x)
        stored = sum(float(fem.assemble_scalar(part.energy)) for part in self.parts.values())
        return float(self.discretization.comm.allreduce(stored)) - float(self._loads.dot(x))

    def residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Internal minus external nodal forces [N], Gil (50); at held components, the reaction."""
        self.discretization.to_meshes(x)
        b.set(0.0)
        shares = ((part.mesh, _assemble_vector(part.residual)) for part in self.parts.values())
        self.discretization.add_from_meshes(shares, b)
        b.axpy(-1.0, self._loads)

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Derivative of the residual [N/m], Gil (51)-(53)."""
        self.discretization.to_meshes(x)
        A.zeroEntries()
        for name in self.discretization.structure.parts:
            if name in self.parts:
                part = self.parts[name]
                A.setLGMap(part.mesh.numbering, part.mesh.numbering)
                fem_petsc.assemble_matrix(A, part.tangent)
            else:  # what assemble_matrix does at its end, together on all processes
                A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        A.assemble()

    def hold(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Replaces reactions in the residual by the error of the held components times `stiffness` [N]."""
        gap = x.array_r[self._held_here] - self._prescribed.array_r[self._held_here]
        b.array[self._held_here] = self.stiffness * gap

    def hold_tangent(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec) -> None:
        """Makes A dx = b close the error of the held components exactly, and b hold its effect on the others."""
        gap = x.copy()
        gap.axpy(-1.0, self._prescribed)
        A.zeroRowsColumns(self._held, diag=self.stiffness, x=gap, b=b)


def _part_forms(mesh: PartMesh, structure: Structure) -> PartForms:
    part, u = mesh.part, mesh.u
    J = ufl.Jacobian(mesh.mesh)
    if isinstance(part, Membrane):
        T = kinematics.membrane_frame(J, mesh.cell_field(structure.warp(mesh.name)))
    else:
        T = kinematics.bar_frame(J)
    G = kinematics.displacement_gradient(u, T)
    F = kinematics.deformation_gradient(G, T)
    E = kinematics.green_lagrange(G, T)
    d = part.dimension
    prestress = mesh.cell_field(part.prestress_tensors())
    sigma0 = ufl.as_matrix([[prestress[d * i + j] for j in range(d)] for i in range(d)])
    CE = _stress_increment(mesh, E)
    q = mesh.cell_field(np.zeros((len(part.cells), 3)))

    dx = ufl.Measure("dx", domain=mesh.mesh, metadata={"quadrature_degree": 1})  # exact: strains are constant per cell
    v = ufl.TestFunction(u.function_space)
    energy = elasticity.strain_energy(E, sigma0, CE) * dx
    residual = ufl.derivative(energy, u, v)
    tangent = ufl.derivative(residual, u, ufl.TrialFunction(u.function_space))
    return PartForms(
        mesh=mesh,
        T=T,
        F=F,
        E=E,
        S=elasticity.second_piola_kirchhoff(sigma0, CE),
        q=q,
        energy=_dolfinx.form(energy),
        residual=_dolfinx.form(residual),
        tangent=_dolfinx.form(tangent),
        load=_dolfinx.form(load_forms.dead_load(q, v) * dx),
    )


def _stress_increment(mesh: PartMesh, E: Any) -> Any:
    """C : E of the part's material, its constants as data so that all parts of a kind share one compiled form."""

    def constant(value: float) -> fem.Constant:
        return fem.Constant(mesh.mesh, np.float64(value))

    part = mesh.part
    if not isinstance(part, Membrane):
        return elasticity.axial(E, constant(part.axial_stiffness))
    material = part.material
    if isinstance(material, Fabric):
        return elasticity.isotropic(E, constant(material.Et), constant(material.nu))
    constants = map(constant, (material.Et_warp, material.Et_weft, material.nu, material.Gt))
    return elasticity.orthotropic(E, *constants)


def _prestress_forces(structure: Structure, name: str) -> float:
    """Sum over the cells of a part of the squared prestress force across it [N2]."""
    part = structure.parts[name]
    width = measures(structure.points, part.cells) ** (1 - 1 / part.dimension)
    return float(np.sum((np.linalg.norm(part.prestress_tensors(), axis=(1, 2)) * width) ** 2))


def _typical_stiffness(structure: Structure, name: str) -> float:
    part = structure.parts[name]
    if not isinstance(part, Membrane):
        return float(part.axial_stiffness / measures(structure.points, part.cells).mean())
    material = part.material
    return material.Et if isinstance(material, Fabric) else max(material.Et_warp, material.Et_weft)


def _assemble_vector(form: Any) -> NDArray[np.float64]:
    space = form.function_spaces[0]
    values = np.zeros(3 * space.dofmap.index_map.size_local)
    fem.assemble_vector(values, form)
    return values
