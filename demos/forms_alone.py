# %% [markdown]
# # Forms alone
#
# The forms of `fx_membrane.forms` in a plain dolfinx script, with the script's own mesh and Newton iteration:
#
# - a woven roof over a unit square, held along its edge, wrinkles under snow;
# - `tension_direction` gives the direction of its tension, which the relaxed energy needs, from the strain in cells;
# - `Analysis` finds the same state, on a structure made of the same mesh.
#
# The calls of dolfinx are those that 0.5, 0.9 and 0.11 have in common. Units are N and m.

# %%
import numpy as np
import ufl
from mpi4py import MPI
from petsc4py import PETSc
from dolfinx import fem, mesh

from fx_membrane import (
    Analysis, DistributedLoad, Membrane, OrthotropicFabric, Stage, structure_from_dolfinx, tension_direction,
)  # fmt: skip
from fx_membrane.forms import elasticity, kinematics, loads, wrinkling

WARP, PRESTRESS, SNOW, KEPT = (1.0, 1.0, 0.0), 200.0, (0.0, 0.0, -600.0), 1e-3
FABRIC = {"Et_warp": 5e5, "Et_weft": 3e5, "nu": 0.3, "Gt": 2e4}


def edge(x):
    """Points of the edge."""
    return np.isclose(x[:2], 0).any(axis=0) | np.isclose(x[:2], 1).any(axis=0)


# %% [markdown]
# ## A surface in space
#
# The top of a cube of tetrahedra, bent to a saddle, distributed by dolfinx over the processes. It has no ghost cells:
# with them, sub-meshes of dolfinx 0.5 exchange wrong values.

# %%
cube = mesh.create_unit_cube(MPI.COMM_WORLD, 10, 10, 1, ghost_mode=mesh.GhostMode.none)
roof = mesh.create_submesh(cube, 2, mesh.locate_entities_boundary(cube, 2, lambda x: np.isclose(x[2], 1)))[0]
roof.geometry.x[:, 2] = 0.3 * roof.geometry.x[:, 0] * roof.geometry.x[:, 1]

# %% [markdown]
# ## Energy
#
# Gil (40), relaxed by wrinkling; `angle` is the direction of tension of each cell.

# %%
functionspace = getattr(fem, "functionspace", None) or fem.FunctionSpace  # its name before dolfinx 0.7
V = functionspace(roof, roof.ufl_domain().ufl_coordinate_element())  # three components, piecewise linear
Q = functionspace(roof, ("DG", 0))
u, angle, strain = fem.Function(V), fem.Function(Q), [fem.Function(Q) for _ in range(3)]
warp, q = fem.Constant(roof, WARP), fem.Constant(roof, SNOW)
moduli = [fem.Constant(roof, value) for value in FABRIC.values()]
sigma0 = PRESTRESS * ufl.Identity(2)

T = kinematics.membrane_frame(ufl.Jacobian(roof), warp)
E = kinematics.green_lagrange(kinematics.displacement_gradient(u, T), T)
e = E + elasticity.orthotropic_compliance(sigma0, *moduli)
full = elasticity.strain_energy(E, sigma0, elasticity.orthotropic(E, *moduli))
relaxed = wrinkling.orthotropic(E, sigma0, *[*moduli, angle])
dx = ufl.Measure("dx", domain=roof, metadata={"quadrature_degree": 1})  # exact: strains are constant per cell
Pi = (wrinkling.blend(relaxed.energy, full, KEPT) - loads.distributed_load(q, u)) * dx
R = ufl.derivative(Pi, u)
energy, residual, tangent = fem.form(Pi), fem.form(R), fem.form(ufl.derivative(R, u))
strains = [fem.Expression(component, np.full((1, 2), 1 / 3)) for component in (e[0, 0], e[1, 1], e[0, 1])]

# %% [markdown]
# ## Newton's method
#
# The direction is solved anew for each strain. Its change with the strain is in the second derivative of the energy.

# %%
held = fem.locate_dofs_geometrical(V, edge)
fixed = fem.dirichletbc(np.zeros(3), held, V)
owned = held[held < V.dofmap.index_map.size_local]
ksp = PETSc.KSP().create(roof.comm)
ksp.setType("preonly")
ksp.getPC().setType("lu")
ksp.getPC().setFactorSolverType("mumps")
for iteration in range(40):
    for component, expression in zip(strain, strains, strict=True):
        component.interpolate(expression)
    e11, e22, e12 = (component.x.array for component in strain)
    angle.x.array[:] = tension_direction(np.array([[e11, e12], [e12, e22]]).transpose(2, 0, 1), **FABRIC)
    b = fem.petsc.assemble_vector(residual)
    b.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    b.array.reshape(-1, 3)[owned] = 0.0
    unbalanced = b.norm()
    if roof.comm.rank == 0:
        print(f"iteration {iteration:2}, unbalanced forces {unbalanced:.1e} N")
    if unbalanced < 1e-8:
        break
    A = fem.petsc.assemble_matrix(tangent, bcs=[fixed])
    A.assemble()
    ksp.setOperators(A)
    step = b.duplicate()
    ksp.solve(b, step)
    u.x.array[: len(step.array)] -= step.array
    u.x.scatter_forward()

# %% [markdown]
# ## Check
#
# The package, from the same mesh, finds the same energy and displacement.

# %%
nodes = mesh.locate_entities(roof, 0, edge)
groups = {"fabric": roof, "edge": (mesh.meshtags(roof, 0, nodes, np.ones(len(nodes), dtype=np.int32)), 1)}
woven = OrthotropicFabric(**FABRIC)
parts = {"fabric": lambda cells: Membrane(cells, woven, PRESTRESS, WARP, compression_stiffness=KEPT)}
structure = structure_from_dolfinx(roof, groups, parts, {"edge": "xyz"})
expected = Analysis(structure).run([Stage("snow", [DistributedLoad(SNOW, "fabric")])])["snow"]

lengths = np.linalg.norm(u.x.array.reshape(-1, 3), axis=1)
numbers = {
    "energy [J]": [roof.comm.allreduce(fem.assemble_scalar(energy))],
    "largest displacement [m]": [roof.comm.allreduce(lengths.max(), MPI.MAX)],
}
np.testing.assert_allclose(numbers["energy [J]"], expected.energy, rtol=1e-10)
np.testing.assert_allclose(numbers["largest displacement [m]"], expected.largest_displacement, rtol=1e-10)
wrinkled = np.count_nonzero(expected.membrane("fabric").state == "wrinkled")
assert wrinkled > 100
if roof.comm.rank == 0:
    print(f"Check passed: the energy and displacement of the package, with {wrinkled} of 200 cells wrinkled.")
