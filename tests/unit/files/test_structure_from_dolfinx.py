"""Structures from dolfinx meshes and MeshTags, on any number of processes."""

import re

import basix
import numpy as np
import pytest
import ufl
from dolfinx import mesh
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Stage,
    Structure,
    Support,
    edges_where,
    rectangle,
    structure_from_dolfinx,
)
from fx_membrane._dolfinx import create_mesh

WORLD = MPI.COMM_WORLD


def fabric(cells):
    return Membrane(cells, Fabric(Et=500e3, nu=0.3), prestress=1e3)


def cable(cells):
    return Cable(cells, axial_stiffness=1e6, prestress=1e4)


def mast(cells):
    return Mast(cells, axial_stiffness=1e7)


PARTS = {"fabric": fabric, "rope": cable}


def tagged(msh, dimension, **where):
    """MeshTags 1, 2, ... of the entities at which conditions hold."""
    msh.topology.create_connectivity(dimension, msh.topology.dim)
    msh.topology.create_connectivity(dimension, 0)
    found = [mesh.locate_entities(msh, dimension, condition) for condition in where.values()]
    values = np.repeat(np.arange(1, len(found) + 1), [len(entities) for entities in found])
    order = np.argsort(np.concatenate(found))
    return mesh.meshtags(msh, dimension, np.concatenate(found)[order], values[order].astype(np.int32))


def sail(msh):
    """Tag a plane mesh: two fabrics, a rope along x = 1, one side held, and two corners."""
    cells = tagged(msh, 2, left=lambda x: x[0] < 0.5 + 1e-9, right=lambda x: x[0] > 0.5 - 1e-9)
    edges = tagged(msh, 1, rope=lambda x: np.isclose(x[0], 1), side=lambda x: np.isclose(x[0], 0))
    corners = tagged(msh, 0, ends=lambda x: np.isclose(x[0], 1) & np.isclose(abs(2 * x[1] - 1), 1))
    return {
        "fabric": (cells, [1, 2]),
        "left": (cells, 1),
        "right": (cells, 2),
        "rope": (edges, 1),
        "side": (edges, 2),
        "ends": (corners, 1),
    }


def distributed(points, cells):
    """Mesh of all processes, from arrays of the first one."""
    first = WORLD.rank == 0
    return create_mesh(points[: None if first else 0], np.asarray(cells)[: None if first else 0], WORLD)


def state(structure):
    return Analysis(structure).run([Stage("load", [DistributedLoad((0, 0, -100.0), "fabric")])])["load"]


@pytest.mark.mpi
def test_nodes_and_cells_are_in_the_order_of_the_input():
    points, triangles = rectangle(2.0, 1.0, 6, 5)
    triangles = triangles[np.random.default_rng(1).permutation(len(triangles))]
    msh = distributed(points, triangles)
    found = structure_from_dolfinx(msh, {"fabric": msh}, {"fabric": fabric})
    np.testing.assert_array_equal(found.points, points)
    expected = Structure(points, {"fabric": fabric(triangles)})
    np.testing.assert_array_equal(found.parts["fabric"].cells, expected.parts["fabric"].cells)


@pytest.mark.mpi
def test_cells_of_a_tag_keep_the_order_of_the_input():
    points, triangles = rectangle(2.0, 1.0, 6, 5)
    msh = distributed(points, triangles)
    groups = {"right": (tagged(msh, 2, right=lambda x: x[0] > -1e-9), 1)}
    found = structure_from_dolfinx(msh, groups, {"right": fabric})
    right = triangles[(points[triangles][:, :, 0] > -1e-9).all(axis=1)]
    np.testing.assert_array_equal(found.points, points[np.unique(right)])
    np.testing.assert_array_equal(found.points[found.parts["right"].cells], points[right])


@pytest.mark.mpi
def test_plane_mesh_of_several_processes_is_that_of_one():
    supports = {"side": "xyz", "ends": "yz", "rope": "z"}
    several, one = (
        structure_from_dolfinx(msh, sail(msh), {"left": fabric, "right": fabric, "rope": cable}, supports)
        for msh in (mesh.create_unit_square(comm, 6, 4) for comm in (WORLD, MPI.COMM_SELF))
    )
    assert several.points.shape == (35, 3)
    assert not several.points[:, 2].any()
    np.testing.assert_array_equal(several.points, one.points)
    for name, part in one.parts.items():
        np.testing.assert_array_equal(several.parts[name].cells, part.cells)
    np.testing.assert_array_equal(several.supported, one.supported)
    assert [len(part.cells) for part in one.parts.values()] == [24, 24, 4]
    np.testing.assert_array_equal(one.supported.sum(axis=0), [5, 7, 10])


@pytest.mark.mpi
def test_answer_is_that_of_a_structure_of_arrays():
    msh = mesh.create_unit_square(WORLD, 6, 4)
    found = structure_from_dolfinx(msh, sail(msh), PARTS, {"side": "xyz", "ends": "xyz"})
    points, triangles = found.points, found.parts["fabric"].cells
    held = np.isclose(points[:, 0], 0) | (np.isclose(points[:, 0], 1) & np.isclose(abs(2 * points[:, 1] - 1), 1))
    rope = edges_where(points, triangles, lambda x: np.isclose(x[0], 1))
    expected = Structure(
        points, {"fabric": fabric(triangles), "rope": cable(rope)}, [Support(np.flatnonzero(held), "xyz")]
    )
    a, b = state(found), state(expected)
    assert a.largest_displacement > 1e-3
    np.testing.assert_allclose(a.displacement, b.displacement, rtol=0, atol=1e-12)
    np.testing.assert_allclose(np.sort(a.cable("rope").force), np.sort(b.cable("rope").force), rtol=1e-10)


@pytest.mark.mpi
def test_process_without_cells():
    points, triangles = rectangle(1.0, 1.0, 1, 1)
    msh = distributed(points, triangles[:1])
    groups = {"fabric": msh, "rope": (tagged(msh, 1, bottom=lambda x: np.isclose(x[1], -0.5)), 1)}
    groups["ends"] = tagged(msh, 0, ends=lambda x: np.isclose(x[1], -0.5)), 1
    found = structure_from_dolfinx(msh, groups, PARTS, {"ends": "xyz"})
    np.testing.assert_array_equal(found.points[found.parts["fabric"].cells], points[triangles[:1]])
    np.testing.assert_array_equal(found.parts["rope"].cells, [[0, 1]])
    np.testing.assert_array_equal(found.supported.all(axis=1), [True, True, False])


@pytest.mark.mpi
def test_sub_mesh_of_a_solid_is_the_same_on_any_number_of_processes():
    found = []
    for comm in (WORLD, MPI.COMM_SELF):
        box = mesh.create_unit_cube(comm, 3, 2, 2)
        top = mesh.locate_entities_boundary(box, 2, lambda x: np.isclose(x[2], 1))
        sheet = mesh.create_submesh(box, 2, top)[0]
        sheet.geometry.x[:, 2] += sheet.geometry.x[:, 0] * sheet.geometry.x[:, 1]
        groups = {"fabric": sheet, "corner": (tagged(sheet, 0, corner=lambda x: np.isclose(x[0] + x[1], 2)), 1)}
        found.append(structure_from_dolfinx(sheet, groups, {"fabric": fabric}, {"corner": "xy"}))
    several, one = found
    assert one.points.shape == (12, 3)
    assert len(one.parts["fabric"].cells) == 12
    np.testing.assert_allclose(one.points[:, 2], 1 + one.points[:, 0] * one.points[:, 1])
    np.testing.assert_array_equal(several.points, one.points)
    np.testing.assert_array_equal(several.parts["fabric"].cells, one.parts["fabric"].cells)
    np.testing.assert_array_equal(several.supported, one.supported)


@pytest.mark.mpi
def test_tagged_faces_of_a_solid_make_a_membrane():
    box = mesh.create_unit_cube(WORLD, 2, 2, 2)
    groups = {"skin": (tagged(box, 2, skin=lambda x: np.isclose(x[2], 1)), 1)}
    skin = structure_from_dolfinx(box, groups, {"skin": fabric})
    assert skin.points.shape == (9, 3)
    np.testing.assert_array_equal(skin.points[:, 2], 1.0)


@pytest.mark.mpi
def test_mesh_of_intervals_joins_at_equal_places():
    """Two guys from corners of the sheet to the ground, in a mesh of their own."""
    points, triangles = rectangle(2.0, 1.0, 4, 4)
    sheet = distributed(points, triangles)
    ends = np.array([[1, 0.5, 0], [2, 0.5, -1], [1, -0.5, 0], [2, -0.5, -1]])
    guys = distributed(ends, np.array([[0, 1], [2, 3]]))
    groups = {"fabric": sheet, "guys": guys, "feet": (tagged(guys, 0, feet=lambda x: np.isclose(x[2], -1)), 1)}
    groups["side"] = tagged(sheet, 1, side=lambda x: np.isclose(x[0], -1)), 1
    supports = {"feet": "xyz", "side": "xyz"}
    found = structure_from_dolfinx([sheet, guys], groups, {"fabric": fabric, "guys": mast}, supports)
    assert found.points.shape == (27, 3)
    np.testing.assert_array_equal(found.points[:25], points)
    shared = np.intersect1d(found.parts["fabric"].cells, found.parts["guys"].cells)
    np.testing.assert_array_equal(found.points[shared], [[1, -0.5, 0], [1, 0.5, 0]])


@pytest.mark.mpi
def test_separate_parts_of_one_mesh():
    """Two skins with nodes of their own, in one mesh."""
    points, triangles = rectangle(1.0, 1.0, 2, 2)
    both = np.vstack([points, points])
    msh = distributed(both, np.vstack([triangles, triangles + len(points)]))
    half = len(triangles)
    count = msh.topology.index_map(2).size_local + msh.topology.index_map(2).num_ghosts
    values = (np.asarray(msh.topology.original_cell_index) >= half).astype(np.int32)
    tags = mesh.meshtags(msh, 2, np.arange(count, dtype=np.int32), values)
    groups = {"bottom": (tags, 0), "top": (tags, 1)}
    skins = structure_from_dolfinx(msh, groups, {"bottom": fabric, "top": fabric}, separate=[("bottom", "top")])
    assert skins.points.shape == (18, 3)


def _square(cell=None):
    kinds = () if cell is None else (cell,)
    return mesh.create_unit_square(WORLD, 2, 2, *kinds)


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mesh": 5}, "mesh is 5; give a dolfinx Mesh"),
        ({"mesh": []}, "mesh is []; give a dolfinx Mesh"),
        ({"mesh": lambda: _square(mesh.CellType.quadrilateral)}, "kind quadrilateral"),
        ({"groups": {}}, "There is no group 'fabric'; those given are []"),
        ({"groups": {"fabric": 3}}, "The group 'fabric' is 3; give (MeshTags, value), or a mesh"),
        ({"groups": {"fabric": (3, 4)}}, "The group 'fabric' is (3, 4); give (MeshTags, value)"),
        ({"groups": 5}, "groups is 5; give a dictionary"),
        ({"supports": {"ends": "abc"}}, "The support 'ends' is 'abc'"),
        ({"supports": {"feet": "xyz"}}, "There is no group 'feet'"),
        ({"parts": {}}, "parts is empty"),
        ({"parts": {"fabric": 3}}, "part 'fabric' is 3"),
        ({"parts": {"ends": fabric}}, "group 'ends' has vertices"),
        ({"parts": {"rope": fabric}}, "group 'rope' has segments"),
        ({"parts": {"left": fabric}}, "'ends' has nodes that no part uses, 2 of 2"),
    ],
)
def test_refusals(change, words):
    msh = _square()
    given = {"mesh": msh, "groups": sail(msh), "parts": {"fabric": fabric}, "supports": {"ends": "xyz"}} | change
    if callable(given["mesh"]):
        given["mesh"] = given["mesh"]()
    with pytest.raises(ValueError, match=re.escape(words)):
        structure_from_dolfinx(**given)


@pytest.mark.mpi
def test_tag_that_no_entity_has():
    msh = _square()
    groups = sail(msh)
    groups["rope"] = groups["rope"][0], 7
    words = "'rope' has no edges with the tag [7]; those that the tags have are [1, 2]"
    with pytest.raises(ValueError, match=re.escape(words)):
        structure_from_dolfinx(msh, groups, PARTS)


@pytest.mark.mpi
def test_tags_of_another_mesh():
    msh, other = _square(), _square()
    with pytest.raises(ValueError, match=r"'fabric'.*MeshTags.*mesh"):
        structure_from_dolfinx(msh, sail(other), PARTS)
    with pytest.raises(ValueError, match=r"'fabric'.*mesh"):
        structure_from_dolfinx(msh, {"fabric": other}, {"fabric": fabric})


@pytest.mark.mpi
def test_curved_cells(curved):
    with pytest.raises(ValueError, match=r"curved cells.*degree 2"):
        structure_from_dolfinx(curved, {"fabric": curved}, {"fabric": fabric})


@pytest.fixture
def curved():
    """One triangle of degree 2."""
    x = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0, 0.5], [0.5, 0]])
    cells = np.arange(6, dtype=np.int64)[None]
    if hasattr(basix, "ufl"):
        element = ufl.Mesh(basix.ufl.element("Lagrange", "triangle", 2, shape=(2,)))
        return mesh.create_mesh(MPI.COMM_SELF, cells=cells, x=x, e=element)
    return mesh.create_mesh(MPI.COMM_SELF, cells, x, ufl.Mesh(ufl.VectorElement("Lagrange", ufl.triangle, 2)))
