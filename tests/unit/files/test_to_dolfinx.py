"""Results as dolfinx functions, on any number of processes."""

import dataclasses

import numpy as np
import pytest
import ufl
from dolfinx import fem, io
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    BarResult,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
    to_dolfinx,
)
from fx_membrane.forms import elasticity, kinematics, loads
from fx_membrane.results.evaluation import MEMBRANE

pytestmark = pytest.mark.mpi

WORLD = MPI.COMM_WORLD
WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=6e4)
SNOW = 600.0
POINTS, TRIANGLES = rectangle(8.0, 6.0, 8, 6)
POINTS[:, 2] = POINTS[:, 0] * POINTS[:, 1] / 12
POINTS = np.vstack([[[50.0, 50, 50]], POINTS])  # a node that no part uses, before all others
TRIANGLES = TRIANGLES + 1


@pytest.fixture(scope="module")
def snow():
    parts = {
        "fabric": Membrane(TRIANGLES, WOVEN, prestress=(2e3, 3e3), warp=(1, 1, 0), compression_stiffness=1.0),
        "rope": Cable(polyline(1 + 3 * 9 + np.arange(9)), 1e6, prestress=2e4),
    }
    structure = Structure(POINTS, parts, [Support(np.unique(boundary_edges(TRIANGLES)))])
    return Analysis(structure).run([Stage("snow", [DistributedLoad((0, 0, -SNOW), "fabric")])])["snow"]


def integral(integrand, msh):
    value = fem.assemble_scalar(fem.form(integrand * ufl.Measure("dx", domain=msh, metadata={"quadrature_degree": 2})))
    return WORLD.allreduce(value)


def as_2x2(f):
    return ufl.as_matrix([[f[0, 0], f[0, 1]], [f[1, 0], f[1, 1]]])


def test_energy_of_stress_and_strain_is_that_of_the_problem(snow):
    """The total energy is that of fabric and rope less the work of the load, each an integral of functions."""
    fabric, rope = to_dolfinx(snow, "fabric"), to_dolfinx(snow, "rope")
    E, S = (as_2x2(fabric.cells[name]) for name in ("strain", "second_piola_kirchhoff"))
    sigma0 = ufl.as_matrix([[2e3, 0], [0, 3e3]])
    stored = integral(ufl.inner(sigma0 + S, E) / 2, fabric.mesh)
    e = rope.cells["strain"]
    stored += integral(2e4 * e + 1e6 * e**2 / 2, rope.mesh)
    work = integral(loads.distributed_load(ufl.as_vector([0, 0, -SNOW]), fabric.displacement), fabric.mesh)
    assert stored - work == pytest.approx(snow.energy, rel=1e-10)


def test_forms_of_the_displacement_give_the_strain(snow):
    """The strain of the displacement, in the frame of the warp, is that of the cells."""
    fabric = to_dolfinx(snow, "fabric")
    T = kinematics.membrane_frame(ufl.Jacobian(fabric.mesh), fabric.cells["warp"])
    E = kinematics.green_lagrange(kinematics.displacement_gradient(fabric.displacement, T), T)
    error = E - as_2x2(fabric.cells["strain"])
    assert integral(ufl.inner(error, error), fabric.mesh) < 1e-20 * integral(ufl.inner(E, E), fabric.mesh)
    S = elasticity.orthotropic(E, *(ufl.as_ufl(v) for v in (WOVEN.Et_warp, WOVEN.Et_weft, WOVEN.nu, WOVEN.Gt)))
    S += ufl.as_matrix([[2e3, 0], [0, 3e3]])
    error = S - as_2x2(fabric.cells["second_piola_kirchhoff"])
    assert integral(ufl.inner(error, error), fabric.mesh) < 1e-20 * integral(ufl.inner(S, S), fabric.mesh)


@pytest.mark.parametrize("name", ["fabric", "rope"])
def test_rows_lead_back_to_the_order_of_the_user(snow, name):
    found, part, result = to_dolfinx(snow, name), snow.structure.parts[name], snow.parts[name]
    count = found.displacement.function_space.dofmap.index_map.size_local
    x = found.displacement.function_space.tabulate_dof_coordinates()
    np.testing.assert_allclose(x, snow.structure.points[found.node_rows], atol=1e-14)
    np.testing.assert_array_equal(found.displacement.x.array.reshape(-1, 3), snow.displacement[found.node_rows])
    nodes = np.concatenate(WORLD.allgather(found.node_rows[:count]))
    np.testing.assert_array_equal(np.sort(nodes), np.unique(part.cells))
    cells = np.concatenate(WORLD.allgather(found.cell_rows))
    np.testing.assert_array_equal(np.sort(cells), np.arange(len(part.cells)))
    strain = found.cells["strain"].x.array.reshape(-1, *result.strain.shape[1:])
    np.testing.assert_array_equal(strain, result.strain[found.cell_rows])
    area = integral(1.0 * ufl.as_ufl(1), found.mesh)
    assert area == pytest.approx(_measure(POINTS, part.cells), rel=1e-12)


def _measure(points, cells):
    corner = points[cells]
    if cells.shape[1] == 2:
        return np.linalg.norm(corner[:, 1] - corner[:, 0], axis=1).sum()
    return np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1).sum() / 2


def test_names_shapes_and_states():
    """A sheet sheared beyond its prestress has wrinkled cells; a cable given too long is slack."""
    points, triangles = rectangle(1.0, 1.0, 4, 4)
    moved = points[:, [1]] * [0.05, 0, 0]
    parts = {"fabric": Membrane(triangles, Fabric(1e5, 0.3), prestress=10.0), "rope": Cable([[0, 24]], 1e5, -1e3)}
    structure = Structure(points, parts)
    edge = np.unique(boundary_edges(triangles))
    stage = Stage("shear", displacements=[PrescribedDisplacement(int(i), moved[i]) for i in edge])
    state = Analysis(structure).run([stage])["shear"]
    fabric, rope = to_dolfinx(state, "fabric"), to_dolfinx(state, "rope")
    words = np.array(["taut", "wrinkled", "slack"])[fabric.cells["state"].x.array.astype(int)]
    np.testing.assert_array_equal(words, state.membrane("fabric").state[fabric.cell_rows])
    assert "wrinkled" in state.membrane("fabric").state
    np.testing.assert_array_equal(rope.cells["slack"].x.array, state.cable("rope").slack[rope.cell_rows])
    shapes = {name: tuple(function.ufl_shape) for name, function in fabric.cells.items()}
    assert shapes == MEMBRANE | {"warp": (3,)}
    shapes = {name: function.ufl_shape for name, function in rope.cells.items()}
    assert shapes == {field.name: () for field in dataclasses.fields(BarResult)}
    assert fabric.displacement.name == "displacement"
    assert all(function.name == name for name, function in fabric.cells.items())


@pytest.mark.parametrize("name", ["fabric", "rope"])
def test_writer_of_dolfinx(snow, name, tmp_path):
    """XDMF takes mesh, displacement and all cell functions, and reads the mesh again."""
    found = to_dolfinx(snow, name)
    file = WORLD.bcast(tmp_path) / "snow.xdmf"
    with io.XDMFFile(WORLD, str(file), "w") as target:
        target.write_mesh(found.mesh)
        for function in (found.displacement, *found.cells.values()):
            target.write_function(function)
    WORLD.Barrier()
    text = file.read_text()
    assert all(f'Name="{function}"' in text for function in ("displacement", *found.cells))
    with io.XDMFFile(WORLD, str(file), "r") as source:
        again = source.read_mesh()
    assert again.topology.index_map(again.topology.dim).size_global == len(snow.structure.parts[name].cells)


def test_smaller_communicator(snow):
    """A mesh of each process alone has all cells."""
    found = to_dolfinx(snow, "fabric", MPI.COMM_SELF)
    np.testing.assert_array_equal(np.sort(found.cell_rows), np.arange(len(TRIANGLES)))


def test_refusals(snow):
    with pytest.raises(ValueError, match=r"No part is named 'roof'; those are \['fabric', 'rope'\]"):
        to_dolfinx(snow, "roof")
    with pytest.raises(ValueError, match="to_dolfinx state is 3; give a StageResult"):
        to_dolfinx(3, "fabric")
    with pytest.raises(ValueError, match="to_dolfinx comm is 3"):
        to_dolfinx(snow, "fabric", 3)
