"""New meshes of structures: size and shape of the cells, on surfaces of every kind."""

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Form,
    Membrane,
    Pressure,
    RoundHole,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    remeshed,
    sail_mesh,
)
from hypars import FABRIC, area, edges, hypar

pytest.importorskip("gmsh")


def mean_edge(structure, name):
    return np.mean(
        [np.linalg.norm(np.diff(structure.points[list(edge)], axis=0)) for edge in edges(structure.parts[name].cells)]
    )


@pytest.mark.parametrize("size", [1.5, 0.5, 0.2, 0.1])
def test_cells_have_the_size(size):
    points, triangles, roof = hypar()
    found = remeshed(Structure(points, {"roof": roof}, [Support(np.unique(boundary_edges(triangles)))]), size).structure
    assert 0.6 * size < mean_edge(found, "roof") < 1.15 * size
    normals = found.normals("roof")
    assert normals[:, 2].min() > 0  # on the same side
    rim = np.unique(boundary_edges(found.parts["roof"].cells))
    assert sorted(found.supports[0].nodes.tolist()) == rim.tolist()
    np.testing.assert_allclose(np.abs(found.points[rim][:, :2]).max(axis=1), 2.0, rtol=0, atol=1e-13)
    assert area(found, "roof") == pytest.approx(area(Structure(points, {"roof": roof}), "roof"), rel=0.02)


def test_flat_sheet_stays_flat():
    """Also in any orientation: of the same area, with its corners."""
    random = np.random.default_rng(4)
    axes = np.linalg.qr(random.normal(size=(3, 3)))[0]
    points, triangles = rectangle(3.0, 2.0, 6, 5)
    sheet = Structure(points @ axes.T + [5, -3, 2], {"sheet": Membrane(triangles, FABRIC, 1e3)})
    found = remeshed(sheet, 0.17)
    there = (found.structure.points - [5, -3, 2]) @ axes
    np.testing.assert_allclose(there[:, 2], 0, atol=1e-13)
    assert area(found.structure, "sheet") == pytest.approx(6.0, rel=1e-12)
    corners = [0, 6, 35, 41]
    np.testing.assert_array_equal(found.structure.points[found.nodes[corners]], sheet.points[corners])
    assert (found.nodes >= 0).sum() == 4
    a = found.structure.normals("sheet") @ axes
    np.testing.assert_allclose(a[:, 2], sheet.normals("sheet")[0] @ axes[:, 2], rtol=1e-12)


def test_new_nodes_are_on_the_curved_surface():
    """On a sphere and a cylinder, ten times nearer than flat cells and straight segments, rims included."""
    points, triangles = rectangle(2.0, 2.0, 8, 8)
    for square in (points[:, 0] ** 2 + points[:, 1] ** 2, points[:, 0] ** 2):
        shell = points + np.outer(np.sqrt(9 - square), [0, 0, 1])
        found = remeshed(Structure(shell, {"shell": Membrane(triangles, FABRIC, 1e3)}), 0.17).structure.points
        radius = np.sqrt(found[:, 2] ** 2 + found[:, 0] ** 2 + (found[:, 1] ** 2 if square[0] == 2 else 0))
        assert np.abs(radius - 3).max() < 0.1 * 2 * 0.125**2 / 6


def test_ring_stays_where_it_is():
    mesh = sail_mesh([[-4, -4], [4, -4], [4, 4], [-4, 4]], 1.0, holes={"ring": RoundHole((0, 0, 6), 0.5)})
    found = remeshed(Structure(mesh.points, {"cone": Membrane(mesh.triangles, FABRIC, 1e3)}), 0.4).structure
    ring = np.isclose(found.points[:, 2], 6)
    assert ring.sum() == 12
    np.testing.assert_allclose(np.linalg.norm(found.points[ring][:, :2], axis=1), 0.5, rtol=0, atol=1e-12)


def tube(radius):
    """Surface of revolution about z from -1 to 1, 24 by 12 cells; its radius is a function of z."""
    points, triangles = rectangle(2 * np.pi, 2.0, 24, 12)
    angle, z = points[:, 0], points[:, 1]
    shell = np.stack([radius(z) * np.cos(angle), radius(z) * np.sin(angle), z], axis=1)
    node = np.arange(len(points)).reshape(13, 25)
    node[:, 24] = node[:, 0]
    used, cells = np.unique(node.ravel()[triangles], return_inverse=True)
    return shell[used], cells.reshape(-1, 3)


def helicoid():
    points, triangles = rectangle(2.0, 9.4, 8, 40)
    r, angle, _ = points.T
    return np.stack([r * np.cos(angle), r * np.sin(angle), 0.5 * angle], axis=1), triangles


def dome(share=0.5):
    """Share of a unit sphere around its top."""
    points, triangles = rectangle(2.0, 2.0, 16, 16)
    r = np.abs(points).max(axis=1) * np.pi * share
    length = np.linalg.norm(points, axis=1)
    flat = points * np.divide(np.sin(r), length, where=length > 0, out=np.zeros(len(r)))[:, None]
    flat[:, 2] = np.cos(r)
    return flat, triangles


@pytest.mark.parametrize(
    ("shape", "exact"),
    [
        (tube(np.cosh), np.pi * (2 + np.sinh(2))),
        (tube(lambda z: 1 + 0 * z), 4 * np.pi),
        (tube(lambda z: 1.2 - z), np.sqrt(2) * np.pi * (2.2**2 - 0.2**2)),
        (helicoid(), None),
        (dome(), 2 * np.pi),
        (dome(0.8), 2 * np.pi * (1 - np.cos(0.8 * np.pi))),
    ],
    ids=["catenoid", "tube", "cone", "helicoid", "hemisphere", "most of a sphere"],
)
def test_shapes_without_a_plan(shape, exact):
    """Cells of the size all over, on one side, and the area of the surface."""
    points, triangles = shape
    old = Structure(points, {"shell": Membrane(triangles, FABRIC, 1e3)})
    found = remeshed(old, 0.12).structure
    a, b, c = (found.points[corner] for corner in found.parts["shell"].cells.T)
    sides = np.stack([np.linalg.norm(p - q, axis=1) for p, q in [(a, b), (b, c), (c, a)]])
    assert 0.08 < sides.mean() < 0.14
    assert sides.max() < 0.3
    quality = 4 * np.sqrt(3) * np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2 / (sides**2).sum(axis=0)
    assert quality.min() > 0.1
    assert np.mean(quality) > 0.85
    assert area(found, "shell") == pytest.approx(exact or area(old, "shell"), rel=2e-2)
    near = np.linalg.norm(
        points[triangles].mean(axis=1)[None] - found.points[found.parts["shell"].cells].mean(axis=1)[:, None], axis=2
    ).argmin(axis=1)
    agree = np.sum(old.normals("shell")[near] * found.normals("shell"), axis=1)
    assert agree.min() > 0.5


def test_two_pieces_of_one_membrane():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    both = np.vstack([points, points + np.array([3, 0, 1])])
    cells = np.vstack([triangles, triangles + len(points)])
    found = remeshed(Structure(both, {"sails": Membrane(cells, FABRIC, 1e3)}), 0.25).structure
    assert area(found, "sails") == pytest.approx(8.0, rel=1e-12)
    np.testing.assert_allclose(found.points[:, 2], np.round(found.points[:, 2]), rtol=0, atol=1e-13)


def test_size_of_place():
    points, _, roof = hypar()
    found = remeshed(Structure(points, {"roof": roof}), lambda x: 0.1 + 0.15 * (x[0] + 2)).structure
    centre = found.points[found.parts["roof"].cells].mean(axis=1)
    a, b, c = (found.points[corner] for corner in found.parts["roof"].cells.T)
    size = np.sqrt(np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2 / 0.433)
    for low, high in [(-2, -1.5), (1.0, 2.0)]:
        here = (centre[:, 0] > low) & (centre[:, 0] < high)
        assert size[here].mean() == pytest.approx((0.1 + 0.15 * (centre[here, 0] + 2)).mean(), rel=0.15)


def test_structure_is_as_good_as_another():
    """Analysis, and a form, take it; a form gives the same as its structure."""
    points, triangles, roof = hypar()
    structure = Structure(points, {"roof": roof}, [Support(np.unique(boundary_edges(triangles)))])
    found = remeshed(structure, 0.4)
    form = Form(points, {}, np.zeros_like(points), made=structure)
    np.testing.assert_array_equal(remeshed(form, 0.4).structure.points, found.structure.points)
    state = Analysis(found.structure, progress=False).run([Stage("wind", [Pressure(100.0, "roof")])])["wind"]
    assert state.displacement[:, 2].max() > 1e-3
    assert repr(found).startswith("Remeshed(Structure(")


@pytest.mark.mpi
def test_same_on_all_processes():
    points, triangles, roof = hypar()
    found = remeshed(Structure(points, {"roof": roof, "edge": Cable(boundary_edges(triangles), 1e7, 2e3)}), 0.5)
    for points, cells, edge, nodes in MPI.COMM_WORLD.allgather(
        (found.structure.points, found.structure.parts["roof"].cells, found.structure.parts["edge"].cells, found.nodes)
    ):
        np.testing.assert_array_equal(points, found.structure.points)
        np.testing.assert_array_equal(cells, found.structure.parts["roof"].cells)
        np.testing.assert_array_equal(edge, found.structure.parts["edge"].cells)
        np.testing.assert_array_equal(nodes, found.nodes)
