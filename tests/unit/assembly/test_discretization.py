"""Transfer of nodal and cell values between the user, PETSc and the meshes, on any number of processes."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, Structure, boundary_edges, rectangle
from fx_membrane.assembly.discretization import Discretization
from fx_membrane.geometry.topology import node_graph

pytestmark = pytest.mark.mpi


@pytest.fixture(scope="module")
def structure():
    points, triangles = rectangle(3.0, 2.0, 5, 4)
    points = np.vstack([[[9.0, 9, 9]], points, [[0, 0, -1]]])  # the first one is used by no part
    triangles += 1
    return Structure(
        points,
        {
            "fabric": Membrane(triangles, Fabric(Et=1e5, nu=0.3)),
            "edge": Cable(boundary_edges(triangles), 1e6),
            "mast": Mast([[15, len(points) - 1]], 1e7),
        },
    )


@pytest.fixture(scope="module")
def discretization(structure):
    return Discretization(structure)


def nodal_values(structure):
    return np.random.default_rng(1).normal(size=structure.points.shape) * structure.used[:, None]


def test_each_used_node_has_one_owner_and_one_number(structure, discretization):
    owned = np.concatenate(discretization.comm.allgather(discretization.owned_nodes))
    used = np.flatnonzero(structure.used)
    assert sorted(owned) == used.tolist()
    assert discretization.block_of_node[owned].tolist() == list(range(len(used)))
    assert discretization.block_of_node[~structure.used].tolist() == [-1]


def test_each_cell_is_in_one_mesh(structure, discretization):
    for name, part in structure.parts.items():
        share = discretization.parts[name].cell_rows if name in discretization.parts else np.empty(0, dtype=int)
        assert sorted(np.concatenate(discretization.comm.allgather(share))) == list(range(len(part.cells)))


def test_meshes_have_the_users_points(structure, discretization):
    for mesh in discretization.parts.values():
        coordinates = mesh.u.function_space.tabulate_dof_coordinates()
        assert coordinates == pytest.approx(structure.points[discretization.local_nodes[mesh.node_rows]], abs=1e-14)


def test_distribute_and_gather_are_inverse(structure, discretization):
    values = nodal_values(structure)
    assert np.array_equal(discretization.to_numpy(discretization.to_petsc(values)), values)


def test_nodes_that_no_part_uses_are_gathered_as_zero(structure, discretization):
    gathered = discretization.to_numpy(discretization.to_petsc(np.ones(structure.points.shape)))
    assert gathered.tolist() == np.where(structure.used[:, None], np.ones(3), 0).tolist()


def test_meshes_see_the_users_values(structure, discretization):
    values = nodal_values(structure)
    discretization.scatter(discretization.to_petsc(values))
    for mesh in discretization.parts.values():
        assert np.array_equal(mesh.u.x.array.reshape(-1, 3), values[discretization.local_nodes[mesh.node_rows]])


def test_mesh_vectors_add_up_at_shared_nodes(structure, discretization):
    shares = ((mesh, np.ones(3 * len(mesh.node_rows))) for mesh in discretization.parts.values())
    total = discretization.create_vector()
    discretization.scatter_add(shares, total)
    count = np.zeros(len(structure.points))  # number of meshes with a node, over all processes
    for meshes in discretization.comm.allgather(
        [discretization.local_nodes[mesh.node_rows] for mesh in discretization.parts.values()]
    ):
        for nodes in meshes:
            count[nodes] += 1
    assert discretization.to_numpy(total).tolist() == np.repeat(count[:, None], 3, axis=1).tolist()


def test_cell_values_are_gathered_in_the_users_order(structure, discretization):
    for name, part in structure.parts.items():
        expected = np.random.default_rng(2).normal(size=(len(part.cells), 2))
        mesh = discretization.parts.get(name)
        values = np.empty((0, 2)) if mesh is None else mesh.cell_field(expected).x.array.reshape(-1, 2)
        assert np.array_equal(discretization.gather_cells(name, values), expected)


def test_matrix_has_exactly_the_pattern_of_all_parts(structure, discretization):
    A = discretization.create_matrix()
    used = np.flatnonzero(structure.used)
    graph = node_graph((part.cells for part in structure.parts.values()), len(structure.points))
    A.assemble()
    allocated = A.getInfo(A.InfoType.GLOBAL_SUM)["nz_allocated"]
    assert A.getSize() == (3 * len(used), 3 * len(used))
    assert allocated == 9 * graph.nnz


def test_dofs_of_a_mask(structure, discretization):
    mask = np.zeros(structure.points.shape, dtype=bool)
    mask[3, 1] = mask[7] = True
    dofs = np.concatenate(discretization.comm.allgather(discretization.dofs(mask)))
    number = discretization.block_of_node
    assert sorted(dofs) == sorted([3 * number[3] + 1, *(3 * number[7] + np.arange(3))])
