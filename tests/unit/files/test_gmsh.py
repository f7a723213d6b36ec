"""Cables along the edges of a membrane: given as node lines, picked from its mesh, or a physical curve of gmsh."""

import re

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    edges_where,
    rectangle,
    structure_from_gmsh,
)

gmsh = pytest.importorskip("gmsh")
PARTS = {
    "fabric": lambda cells: Membrane(cells, Fabric(Et=500e3, nu=0.3), prestress=1e3),
    "cable": lambda cells: Cable(cells, axial_stiffness=1e6, prestress=1e4),
}
SUPPORTS = {"fixed": "xyz", "corners": "xyz"}


@pytest.fixture
def model(tmp_path):
    """Rectangle, held along one side and at the ends of the opposite one, where a cable is; and its file."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("sail")
    surface = gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
    gmsh.model.occ.synchronize()
    sides = [tag for _, tag in gmsh.model.getBoundary([(2, surface)], oriented=False)]
    ends = [tag for _, tag in gmsh.model.getBoundary([(1, sides[0])], oriented=False)]
    for name, dimension, tags in [
        ("fabric", 2, [surface]),
        ("cable", 1, [sides[0]]),
        ("fixed", 1, [sides[2]]),
        ("corners", 0, ends),
    ]:
        gmsh.model.setPhysicalName(dimension, gmsh.model.addPhysicalGroup(dimension, tags), name)
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.2)
    gmsh.model.mesh.generate(2)
    file = tmp_path / "sail.msh"
    gmsh.write(str(file))
    yield file
    gmsh.finalize()


def state(structure):
    return Analysis(structure).run([Stage("load", [DistributedLoad((0, 0, -100.0), "fabric")])])["load"]


@pytest.mark.mpi
def test_model_in_memory_and_file_are_the_same(model):
    memory, file = (structure_from_gmsh(source, PARTS, SUPPORTS) for source in (None, model))
    np.testing.assert_allclose(file.points, memory.points, atol=1e-15)
    for name in PARTS:
        np.testing.assert_array_equal(file.parts[name].cells, memory.parts[name].cells)
    assert gmsh.model.getCurrent() == "sail"  # the open model stays open


@pytest.mark.mpi
def test_physical_curve_node_line_and_submesh_give_the_same(model):
    by_gmsh = structure_from_gmsh(model, PARTS, SUPPORTS)
    points, triangles = by_gmsh.points, by_gmsh.parts["fabric"].cells
    picked = edges_where(points, triangles, lambda x: np.isclose(x[1], 0))
    on_side = np.flatnonzero(np.isclose(points[:, 1], 0))
    line = on_side[np.argsort(points[on_side, 0])]
    expected = state(by_gmsh)
    force = expected.cable("cable").force[np.argsort(points[by_gmsh.parts["cable"].cells].mean(axis=1)[:, 0])]
    assert force.min() > 0
    for cells in (picked, np.column_stack([line[:-1], line[1:]])):
        cable = PARTS["cable"](cells)
        found = state(Structure(points, {"fabric": by_gmsh.parts["fabric"], "cable": cable}, by_gmsh.supports))
        np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-12)
        ordered = found.cable("cable").force[np.argsort(points[cells].mean(axis=1)[:, 0])]
        np.testing.assert_allclose(ordered, force, rtol=1e-10)


def test_interior_edges_can_be_picked():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    cells = edges_where(points, triangles, lambda x: np.isclose(x[1], 0))
    assert {tuple(sorted(map(int, cell))) for cell in cells} == {(10, 11), (11, 12), (12, 13), (13, 14)}


def test_no_edge_to_pick():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    with pytest.raises(ValueError, match=r"No edge.*membrane"):
        edges_where(points, triangles, lambda x: np.isclose(x[1], 0.1))


@pytest.mark.mpi
def test_file_that_does_not_exist(tmp_path):
    with pytest.raises(ValueError, match=r"There is no file .*roof\.msh"):
        structure_from_gmsh(tmp_path / "roof.msh", PARTS)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("roof.msh", ""),
        ("roof.msh", "not a mesh\n"),
        ("roof.msh", "$MeshFormat\n9.9 0 8\n$EndMeshFormat\n"),
        ("roof.py", "print(1)\n"),
        ("roof.geo", 'SetFactory("OpenCASCADE"); Rectangle(1) = {0, 0, 0, 1, 1};'),
    ],
)
def test_file_that_is_not_a_mesh(name, content, tmp_path):
    file = tmp_path / name
    file.write_text(content)
    message = (
        rf"{re.escape(name)} (does not begin with .MeshFormat, as meshes of gmsh|is not a file that gmsh can read \()"
    )
    with pytest.raises(ValueError, match=message):
        structure_from_gmsh(file, PARTS)


@pytest.mark.mpi
def test_model_without_a_mesh(model):
    gmsh.model.mesh.clear()
    with pytest.raises(ValueError, match=r"^The gmsh model.*open.*no mesh.*gmsh\.model\.mesh\.gen"):
        structure_from_gmsh(None, PARTS)


@pytest.mark.parametrize(
    ("group", "kind", "message"),
    [
        ("fabric", "cable", "triangles.*Membrane.*no part: Cable cells.*\\(n, 2\\)"),
        ("cable", "fabric", "segments.*Cable.*Mast.*no part: Membrane cells.*\\(n, 3\\)"),
    ],
)
def test_part_of_the_wrong_kind(model, group, kind, message):
    with pytest.raises(ValueError, match=f"^The physical group '{group}' has {message}"):
        structure_from_gmsh(model, {group: PARTS[kind]})


def test_unknown_physical_name(model):
    with pytest.raises(ValueError, match=r"no physical group 'roof'; it has \['cable', 'corners', 'fabric', 'fixed'\]"):
        structure_from_gmsh(model, {"roof": PARTS["fabric"]})


@pytest.mark.parametrize(
    ("dimension", "message"),
    [(0, r"a point \(tag 77\) and a surface \(tag 1\)"), (1, r"a curve \(tag 77\) and a surface \(tag 1\)")],
)
def test_two_groups_of_one_name(model, dimension, message):
    """Groups of different dimension: within one, gmsh itself keeps names apart."""
    gmsh.model.addPhysicalGroup(dimension, [1], 77)
    gmsh.model.setPhysicalName(dimension, 77, "fabric")
    gmsh.write(str(model))
    for source in (None, model):
        with pytest.raises(ValueError, match=rf"^The mesh has 2 physical groups 'fabric', {message}; give each"):
            structure_from_gmsh(source, {"fabric": PARTS["fabric"]})
        with pytest.raises(ValueError, match=r"^The mesh has 2 physical groups 'fabric'"):
            structure_from_gmsh(source, {"cable": PARTS["cable"]}, {"fabric": "xyz"})
        assert list(structure_from_gmsh(source, {"cable": PARTS["cable"]}).parts) == ["cable"]  # not asked for


def test_group_that_is_a_part_and_a_support(model):
    structure = structure_from_gmsh(model, PARTS, {"fabric": "z"})
    assert structure.supported.tolist() == [[False, False, True]] * len(structure.points)


def test_support_on_no_part(model):
    message = r"support 'fixed' has nodes that no part uses, (\d+) of \1, as gmsh's node \d+ at \([\d.]+, 1, 0\); put"
    with pytest.raises(ValueError, match=message):
        structure_from_gmsh(model, {"cable": PARTS["cable"]}, {"fixed": "xyz"})


def test_points_as_cells(model):
    with pytest.raises(ValueError, match=r"'corners'.*elements.*type Point"):
        structure_from_gmsh(model, {"corners": PARTS["cable"]})


def test_supports_are_those_of_the_groups(model):
    structure = structure_from_gmsh(model, PARTS, SUPPORTS)
    held = structure.supported.all(axis=1)
    on_side = np.isclose(structure.points[:, 1], 1.0)
    ends = np.isclose(structure.points[:, 1], 0.0) & (np.abs(structure.points[:, 0] - 1) > 0.999)
    np.testing.assert_array_equal(held, on_side | ends)
    assert isinstance(structure.supports[0], Support)
    assert MPI.COMM_WORLD.allreduce(len(structure.points), MPI.MAX) == len(structure.points)


@pytest.mark.parametrize(
    ("on", "message"),
    [
        (5, "^on is 5.*function.*positions"),
        (lambda x: 3, "^on gives 3; it must give True or False for each position"),
        (lambda x: x[:, 0] > 0, r"^on gives \[False, False, False\]; it must"),
        (lambda x: x[1], r"^on.*array.*float64, shape \(25,\)"),
    ],
)
def test_edges_on_needs_a_mask(on, message):
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    with pytest.raises(ValueError, match=message):
        edges_where(points, triangles, on)
