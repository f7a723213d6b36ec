# %% [markdown]
# # Forms alone
#
# The forms of `fx_membrane.forms` in a plain dolfinx script, with the script's own mesh and Newton iteration:
#
# - a woven roof over a unit square, held along its edge, wrinkles under snow;
# - `tension_direction` gives the direction of its tension, which the relaxed energy needs, from the strain in cells;
# - `Analysis` finds the same state, on a structure of the same triangles.
#
# The calls of dolfinx are those that 0.5, 0.9 and 0.11 have in common. Units are N and m.

# %%
from mpi4py import MPI  # isort: skip  (dolfinx of the wheel finds MPI's library after it)
import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc

import fx_membrane as fx
from fx_membrane.forms import elasticity, kinematics, loads, wrinkling

# The woven fabric has the moduli Et_warp, Et_weft, nu and Gt.
WARP, WOVEN, PRESTRESS, SNOW, KEPT = (1.0, 1.0, 0.0), (5e5, 3e5, 0.3, 2e4), 200.0, (0.0, 0.0, -600.0), 1e-3
# From dolfinx 0.10 on, a linear problem has a prefix.
prefix = {"petsc_options_prefix": "_"} if "petsc_options_prefix" in petsc.LinearProblem.__init__.__annotations__ else {}

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
# Gil (40), relaxed by wrinkling; `angle` is the direction of tension of each cell. Strains are constant per cell.

# %%
functionspace = getattr(fem, "functionspace", None) or fem.FunctionSpace  # its name before dolfinx 0.7
V = functionspace(roof, roof.ufl_domain().ufl_coordinate_element())  # three components, piecewise linear
u, (angle, *strain) = fem.Function(V), [fem.Function(functionspace(roof, ("DG", 0))) for _ in range(5)]
moduli, sigma0 = [fem.Constant(roof, value) for value in WOVEN], PRESTRESS * ufl.Identity(2)
T = kinematics.membrane_frame(ufl.Jacobian(roof), fem.Constant(roof, WARP))
E = kinematics.green_lagrange(kinematics.displacement_gradient(u, T), T)
full = elasticity.strain_energy(E, sigma0, elasticity.orthotropic(E, *moduli))
relaxed = wrinkling.blend(wrinkling.orthotropic(E, sigma0, *[*moduli, angle]).energy, full, KEPT)
Pi = (relaxed - loads.distributed_load(fem.Constant(roof, SNOW), u)) * ufl.dx(degree=1)
e = E + elasticity.orthotropic_compliance(sigma0, *moduli)
strains = [fem.Expression(component, np.full((1, 2), 1 / 3)) for component in (e[0, 0], e[0, 1], e[0, 1], e[1, 1])]

# %% [markdown]
# ## Newton's method
#
# The direction is solved anew for each strain. Its change with the strain is in the second derivative of the energy.

# %%
held = fem.locate_dofs_geometrical(V, lambda x: np.isclose(np.abs(x[:2] - 0.5).max(axis=0), 0.5))
edge, energy = fem.dirichletbc(np.zeros(3), held, V), fem.form(Pi)
newton = petsc.LinearProblem(ufl.derivative(ufl.derivative(Pi, u), u), ufl.derivative(Pi, u), bcs=[edge], **prefix)
for _ in range(16):
    for component, expression in zip(strain, strains, strict=True):
        component.interpolate(expression)
    angle.x.array[:] = fx.tension_direction(np.array([e.x.array for e in strain]).T.reshape(-1, 2, 2), *WOVEN)
    u.x.array[:] -= newton.solve().x.array

# %% [markdown]
# ## Check
#
# The package finds the same energy and displacement on its own mesh.

# %%
points, triangles = fx.rectangle(1.0, 1.0, 10, 10, diagonals="right")
points[:, 2] = 0.3 * (points[:, 0] + 0.5) * (points[:, 1] + 0.5)
fabric = fx.Membrane(triangles, fx.OrthotropicFabric(*WOVEN), PRESTRESS, WARP, compression_stiffness=KEPT)
structure = fx.Structure(points, {"fabric": fabric}, [fx.Support(np.unique(fx.boundary_edges(triangles)))])
snow = fx.Analysis(structure).run([fx.Stage("snow", [fx.DistributedLoad(SNOW, "fabric")])])["snow"]
largest = roof.comm.allreduce(np.linalg.norm(u.x.array.reshape(-1, 3), axis=1).max(), MPI.MAX)
numbers = {"energy [J]": [roof.comm.allreduce(fem.assemble_scalar(energy))], "largest displacement [m]": [largest]}
np.testing.assert_allclose([*numbers.values()], [[snow.energy], [snow.largest_displacement]], rtol=1e-10)
assert np.count_nonzero(snow.membrane("fabric").state == "wrinkled") == 124
if roof.comm.rank == 0:
    print("Check passed: the energy and displacement of the package, with 124 of 200 cells wrinkled.")
