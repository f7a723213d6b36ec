# %% [markdown]
# # From a dolfinx mesh, and back
#
# - In: parts and supports of a structure from the MeshTags of a mesh that dolfinx has made, read or distributed;
# - out: displacement and cell results of a state as dolfinx functions, for its writers and for forms of one's own.
#
# A quarter of a square sheet under a small load: the deflection w solves n laplace(w) = -q for the tension n, as the
# stress function of torsion does. So the volume under the whole sheet of side a is 0.1406 / 4 q a^4 / n (Timoshenko and
# Goodier, Theory of Elasticity, 1951, art. 94). Units are N and m.

# %%
from mpi4py import MPI  # isort: skip  (dolfinx of the wheel finds MPI's library after it)
import numpy as np
import ufl
from dolfinx import fem, mesh

from fx_membrane import Analysis, DistributedLoad, Fabric, Membrane, Stage, structure_from_dolfinx, to_dolfinx

a, n, q = 2.0, 1e3, 0.1
SIDES = {"x = 0": (0, 0.0), "y = 0": (1, 0.0), "x = a / 2": (0, a / 2), "y = a / 2": (1, a / 2)}
SUPPORTS = {"x = 0": "x", "y = 0": "y", "x = a / 2": "xyz", "y = a / 2": "xyz"}


def integral(integrand, domain):
    """Integral over a mesh, of all processes."""
    dx = ufl.Measure("dx", domain=domain, metadata={"quadrature_degree": 2})
    return domain.comm.allreduce(fem.assemble_scalar(fem.form(integrand * dx)))


# %% [markdown]
# ## In and out


# %%
def loaded(cells):
    """State of the sheet with a number of cells along a side, as dolfinx functions."""
    sheet = mesh.create_rectangle(MPI.COMM_WORLD, [np.zeros(2), np.full(2, a / 2)], [cells, cells])
    groups = {"fabric": sheet}
    for tag, (name, (axis, place)) in enumerate(SIDES.items()):
        edges = mesh.locate_entities_boundary(sheet, 1, lambda x, i=axis, c=place: np.isclose(x[i], c))
        groups[name] = mesh.meshtags(sheet, 1, edges, np.full(len(edges), tag, dtype=np.int32)), tag
    fabric = {"fabric": lambda triangles: Membrane(triangles, Fabric(Et=5e5, nu=0.3), prestress=n)}
    structure = structure_from_dolfinx(sheet, groups, fabric, SUPPORTS)
    state = Analysis(structure).run([Stage("load", [DistributedLoad((0, 0, q), "fabric")])])["load"]
    return to_dolfinx(state, "fabric")


found = [loaded(cells) for cells in (8, 16)]
volumes = [4 * integral(part.displacement[2], part.mesh) for part in found]
u, E = found[-1].displacement, found[-1].cells["strain"]
stretch = integral(E[0, 0] + E[1, 1], found[-1].mesh)
slopes = integral(ufl.inner(ufl.grad(u), ufl.grad(u)) / 2, found[-1].mesh)

# %% [markdown]
# ## Check
#
# The error of the volumes falls by four from mesh to mesh; extrapolated, they have the digits of the reference. Edges
# that stay in place leave no mean strain but that of the slopes: the integrals of tr(E) and of |grad u|^2 / 2 agree.

# %%
coarse, fine = np.array(volumes) / (q * a**4 / n)
assert abs((4 * fine - coarse) / 3 - 0.1406 / 4) < 0.5e-4 / 4
assert abs(stretch / slopes - 1) < 1e-9
numbers = {"volumes [m3]": volumes, "stretch [m2]": [stretch]}
if MPI.COMM_WORLD.rank == 0:
    print(f"Torsion constant {4 * (4 * fine - coarse) / 3:.5f}; strain over slopes {stretch / slopes - 1:.1e} from 1")
    print("Check passed: the volume is that of the stress function of torsion, and the strains fit the displacement.")
