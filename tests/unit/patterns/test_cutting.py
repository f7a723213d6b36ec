"""Strips cut along seams: the same surface, its parts, and the edges of the strips."""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    OrthotropicFabric,
    Rope,
    Structure,
    Support,
    boundary_edges,
    cut_strips,
    geodesic,
    rectangle,
)
from fx_membrane.geometry.sizes import aspects, measures

pytest.importorskip("potpourri3d")

WOVEN = OrthotropicFabric(Et_warp=6e5, Et_weft=4e5, nu=0.3, Gt=2e4)


def saddle(nx=8, ny=6, **more):
    """Hypar over a rectangle 4 x 3, held at its corners."""
    points, triangles = rectangle(4.0, 3.0, nx, ny)
    points[:, 2] = 0.2 * points[:, 0] * points[:, 1]
    corners = [0, nx, ny * (nx + 1), (nx + 1) * (ny + 1) - 1]
    roof = Membrane(triangles, WOVEN, prestress=(2e3, 1e3), warp=(1, 0.5, 0))
    return Structure(points, {"roof": roof, **more}, [Support(corners)])


def on(structure, x, y):
    """Place of the saddle over a point of an edge of its plan that is a line of nodes."""
    return x, y, 0.2 * x * y


def test_area_and_nodes_remain():
    roof = saddle()
    seams = [geodesic(roof, on(roof, -2, y), on(roof, 2, y + 0.3)) for y in (-0.8, -0.1, 0.6)]
    strips = cut_strips(roof, seams)
    cut = strips.structure
    assert strips.names == ("strip 1", "strip 2", "strip 3", "strip 4")
    np.testing.assert_array_equal(cut.points[: len(roof.points)], roof.points)
    area = sum(measures(cut.points, strips.membrane(name).cells).sum() for name in strips.names)
    assert area == pytest.approx(measures(roof.points, roof.parts["roof"].cells).sum(), rel=1e-12)
    assert max(aspects(cut.points, strips.membrane(name).cells).max() for name in strips.names) < 50
    assert cut.supports[0].nodes.tolist() == roof.supports[0].nodes.tolist()


def test_edges_run_around_each_strip():
    """Sides of a strip chain to one closed line; seams come once with each neighbour, borders have it on the left."""
    roof = saddle()
    seams = [geodesic(roof, on(roof, -2, y), on(roof, 2, y)) for y in (-0.6, 0.4)]
    strips = cut_strips(roof, seams)
    for name in strips.names:
        rim = {tuple(edge) for edge in boundary_edges(strips.membrane(name).cells).tolist()}
        around = set()
        for edge in strips.edges_of(name):
            way = edge.nodes if edge.strips[0] == name else edge.nodes[::-1]
            around |= set(pairwise(way.tolist()))
        assert around == rim
    assert [edge.strips for edge in strips.edges if edge.is_seam] == [("strip 1", "strip 2"), ("strip 2", "strip 3")]
    assert len(strips.edges_of("strip 2")) == 4


@pytest.mark.parametrize("size", [None, 0.6])
def test_seam_beside_a_corner_is_led_through_it(size):
    """An edge of 2 mm between seam and corner would have cells as small."""
    pytest.importorskip("gmsh")
    roof, (x, y) = saddle(), (2.0, 1.5)
    for start in (on(roof, 2e-3 - x, -y), on(roof, -x, 3e-3 - y)):
        strips = cut_strips(roof, [geodesic(roof, start, on(roof, x, y - 4e-3))], size=size)
        lengths = {
            edge.name: np.linalg.norm(np.diff(strips.structure.points[edge.nodes], axis=0), axis=1).sum()
            for edge in strips.edges
        }
        assert sorted(lengths) == ["border 1", "border 2", "border 3", "border 4", "seam 1"]
        assert min(lengths.values()) > 2.9


@pytest.mark.parametrize(("aside", "at_corner"), [(0.02, True), (0.03, False)])
def test_seams_of_new_meshes_move_at_corners_only(aside, at_corner):
    """Within 0.05 of the shortest edge, 0.5, a seam ends in a corner; beside other nodes it keeps its place."""
    pytest.importorskip("gmsh")
    roof = saddle()
    seam = geodesic(roof, on(roof, -2, 1.5 - aside), on(roof, 2, 0.01))  # beside a corner, and beside a node
    strips = cut_strips(roof, [seam], size=0.6)
    (edge,) = [edge for edge in strips.edges if edge.is_seam]
    ends = strips.structure.points[edge.nodes[[0, -1]]]
    first, last = ends[np.argsort(ends[:, 0])]
    assert first == pytest.approx(on(roof, -2, 1.5 if at_corner else 1.5 - aside), abs=1e-6)
    assert last == pytest.approx(on(roof, 2, 0.01), abs=1e-3)


def test_stress_in_space_remains():
    roof = saddle()
    strips = cut_strips(roof, [geodesic(roof, on(roof, -2, -0.4), on(roof, 2, 0.7))])

    def stress(structure, name):
        warp, normal = structure.warp(name), structure.normals(name)
        frame = np.stack([warp, np.cross(normal, warp)], axis=1)
        return np.einsum("cki,ckl,clj->cij", frame, structure.parts[name].prestress_tensors(), frame)

    before = stress(roof, "roof")
    centres = roof.points[roof.parts["roof"].cells].mean(axis=1)
    for name in strips.names:
        cells = strips.membrane(name).cells
        whole = np.flatnonzero((cells < len(roof.points)).all(axis=1))
        there = strips.structure.points[cells[whole]].mean(axis=1)
        for row, centre in zip(whole, there, strict=True):
            old = np.linalg.norm(centres - centre, axis=1).argmin()
            if np.linalg.norm(centres[old] - centre) < 1e-12:
                np.testing.assert_allclose(stress(strips.structure, name)[row], before[old], atol=1e-9)
        warp = strips.structure.warp(name)
        assert np.abs(warp[:, 0]).min() > 0.85


def test_cables_ropes_and_supports_take_new_nodes():
    roof = saddle()
    rim = boundary_edges(roof.parts["roof"].cells)
    west = rim[(roof.points[rim][:, :, 0] == -2).all(axis=1)]
    east = np.flatnonzero(roof.points[:, 0] == 2)
    middle = np.flatnonzero(roof.points[:, 1] == 0)
    valley = np.column_stack([middle[:-1], middle[1:]])
    roof = saddle(
        west=Cable(west, 1e6, np.linspace(1e3, 2e3, len(west))),
        east=Rope(east, 1e6, force=1e3),
        valley=Cable(valley, 1e6),
    )
    roof = Structure(roof.points, roof.parts, [Support(east), Support(middle[[0, -1]], "xy")])
    strips = cut_strips(roof, [geodesic(roof, on(roof, -2, y), on(roof, 2, y - 0.2)) for y in (-0.7, 0.3)])
    cut = strips.structure
    for name in ("west", "valley"):
        old, new = (measures(one.points, one.parts[name].cells).sum() for one in (roof, cut))
        assert new == pytest.approx(old, rel=1e-12)
    assert len(cut.parts["west"].prestress) == len(west) + 2
    assert len(cut.parts["east"].nodes) == len(east) + 2
    edges = {tuple(sorted(edge)) for name in strips.names for edge in _sides(strips.membrane(name).cells)}
    for name in ("west", "valley"):
        assert {tuple(sorted(cell)) for cell in cut.parts[name].cells.tolist()} <= edges
    assert set(cut.parts["east"].nodes) == set(cut.supports[0].nodes)
    assert cut.supports[1].nodes.tolist() == middle[[0, -1]].tolist()
    lines = {edge.line for edge in strips.edges_of("strip 2")}
    assert {"west", "east"} <= lines
    assert {edge.held for edge in strips.edges if edge.line == "east"} == {True}


def _sides(cells):
    return np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]).tolist()


def tube(around=12, along=4, radius=1.0):
    """Tube of squares along z."""
    angle = 2 * np.pi * np.arange(around) / around
    z = np.linspace(0, 2.0, along + 1)
    points = np.array([[radius * np.cos(a), radius * np.sin(a), h] for h in z for a in angle])
    node = np.arange((along + 1) * around).reshape(along + 1, around)
    cells = []
    for low, high in pairwise(node):
        for k in range(around):
            following = (k + 1) % around
            cells += [[low[k], low[following], high[following]], [low[k], high[following], high[k]]]
    return Structure(points, {"tube": Membrane(cells, Fabric(1e5, 0.3), 1e3)}, [Support(node[0])]), node


def test_tube_opened_by_one_seam():
    shape, node = tube()
    strips = cut_strips(shape, [geodesic(shape, int(node[0, 0]), int(node[-1, 0]))])
    assert strips.names == ("tube",)
    (seam,) = (edge for edge in strips.edges if edge.is_seam)
    assert seam.strips == ("tube", "tube")
    assert sorted(seam.nodes.tolist()) == node[:, 0].tolist()
    assert len(strips.edges_of("tube")) == 3


def test_tube_without_a_seam_is_refused():
    with pytest.raises(ValueError, match=r"Strip 'tube' around \(.*\) is no disc, but a tube .* lead a seam"):
        cut_strips(tube()[0], [])
