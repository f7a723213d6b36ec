"""New meshes of structures: lines, supports, stress and warp carried over; shapes that are refused."""

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Form,
    Mast,
    Membrane,
    OrthotropicFabric,
    Pressure,
    RoundHole,
    Stage,
    Structure,
    Support,
    boundary_edges,
    force_density,
    polyline,
    rectangle,
    remeshed,
    sail_mesh,
)

pytest.importorskip("gmsh")
FABRIC = Fabric(4e5, 0.3)


def edges(triangles):
    return {tuple(sorted(edge)) for cell in triangles.tolist() for edge in (cell[:2], cell[1:], cell[::2])}


def mean_edge(structure, name):
    return np.mean(
        [np.linalg.norm(np.diff(structure.points[list(edge)], axis=0)) for edge in edges(structure.parts[name].cells)]
    )


def area(structure, name):
    a, b, c = (structure.points[corner] for corner in structure.parts[name].cells.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def hypar(n=8, **changes):
    points, triangles = rectangle(4.0, 4.0, n, n)
    points[:, 2] = points[:, 0] * points[:, 1] / 8
    roof = Membrane(triangles, FABRIC, **{"prestress": 2e3, **changes})
    return points, triangles, roof


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


def test_constant_stress_stays_constant():
    woven = OrthotropicFabric(6e5, 4e5, 0.3, 2e4)
    for changes in (
        {"material": woven, "prestress": (3e3, 1e3), "warp": (1, 1, 0)},
        {"material": woven, "prestress": [[3e3, 200.0], [200.0, 1e3]], "warp": (1, 1, 0)},
        {"prestress": np.full((128, 1), 2e3)},
        {"material": woven, "prestress": np.full((128, 2), 2e3) * [2, 1], "warp": np.tile([0.0, 1, 0], (128, 1))},
    ):
        points, triangles, roof = hypar()
        roof = Membrane(triangles, **{"material": FABRIC, **changes})
        structure = Structure(points, {"roof": roof})
        found = remeshed(structure, 0.3).structure
        part = found.parts["roof"]
        expected = np.broadcast_to(roof.prestress_tensors()[:1], (len(part.cells), 2, 2))
        np.testing.assert_allclose(part.prestress_tensors(), expected, rtol=1e-13, atol=1e-10)
        assert part.material == roof.material
        if roof.warp is not None:
            wanted = np.broadcast_to(structure.warp("roof")[:1] * 0 + np.ravel(roof.warp)[:3], (len(part.cells), 3))
            cosine = np.sum(found.warp("roof") * wanted, axis=1) / np.linalg.norm(wanted, axis=1)
            assert cosine.min() > 0.8  # the projection of the same vector


def test_radial_warp_and_stress_of_place():
    """An annulus with stress 1 + r along the radius: second order in the middle, first at the rims."""
    errors = []
    for size in (0.4, 0.2):
        mesh = sail_mesh(
            [[2 * np.cos(a), 2 * np.sin(a)] for a in np.arange(24) * np.pi / 12],
            size,
            holes={"r": RoundHole((0, 0), 1)},
        )
        centre = mesh.points[mesh.triangles].mean(axis=1)
        r = np.linalg.norm(centre, axis=1)
        part = Membrane(mesh.triangles, FABRIC, prestress=np.column_stack([1e3 * r, np.full(len(r), 1e3)]), warp=centre)
        found = remeshed(Structure(mesh.points, {"a": part}), size).structure
        place = found.points[found.parts["a"].cells].mean(axis=1)
        radius = np.linalg.norm(place, axis=1)
        middle = (radius > 1.4) & (radius < 1.6)
        error = np.abs(found.parts["a"].prestress_tensors()[:, 0, 0] - 1e3 * radius) / 1e3
        turn = 1 - np.abs(np.sum(found.warp("a") * place, axis=1) / radius)
        errors.append((error[middle].max(), error.max(), turn.max()))
    (fine_middle, fine, fine_turn), (coarse_middle, coarse, _) = errors[1], errors[0]
    assert fine_middle < coarse_middle < 0.1
    assert fine < coarse < 0.3
    assert fine_turn < 1e-2


def test_edge_cables_keep_their_force():
    points, _, roof = hypar()
    lines = {
        name: np.flatnonzero(np.isclose(points[:, axis], side))
        for name, axis, side in [("s", 1, -2.0), ("e", 0, 2.0), ("n", 1, 2.0), ("w", 0, -2.0)]
    }
    parts = {"roof": roof, **{name: Cable(polyline(line), 1e7, 3e3, mass=2.0) for name, line in lines.items()}}
    rising = np.linspace(1e3, 2e3, 17)[1::2]
    parts["n"] = Cable(polyline(lines["n"]), 1e7, prestress=rising)
    parts["valley"] = Cable(polyline(np.arange(4, 81, 9)), 1e7, 5e3)
    found = remeshed(Structure(points, parts, [Support([0, 8, 72, 80])]), 0.25).structure
    fabric = edges(found.parts["roof"].cells)
    for name, part in found.parts.items():
        if name == "roof":
            continue
        assert {tuple(sorted(cell)) for cell in part.cells.tolist()} <= fabric
        length = np.linalg.norm(np.diff(found.points[part.cells], axis=1), axis=2).sum()
        old = np.linalg.norm(np.diff(points[parts[name].cells], axis=1), axis=2).sum()
        assert length == pytest.approx(old, rel=1e-12)
        assert len(part.cells) == {"valley": 16, "e": 17, "w": 17}.get(name, 18)  # in halves
    assert float(found.parts["s"].prestress) == 3e3
    assert found.parts["s"].mass == 2.0
    middle = found.points[found.parts["n"].cells].mean(axis=1)[:, 0]
    inner = np.abs(middle) < 1.75
    np.testing.assert_allclose(found.parts["n"].prestress[inner], (1500 + 250 * middle)[inner], rtol=3e-2)
    assert [len(support.nodes) for support in found.supports] == [4]
    assert (found.supported.sum(axis=1) == 3).sum() == 4


def test_closed_cable_around_a_ring():
    mesh = sail_mesh(
        [[-3, -3], [3, -3], [3, 3], [-3, 3]], 0.6, holes={"ring": RoundHole((0, 0, 2), 0.6)}, sizes={"ring": 0.15}
    )
    ring = mesh.lines["ring"]
    force = 1e3 + 100 * np.cos(np.arange(len(ring) - 1) / (len(ring) - 1) * 2 * np.pi)
    parts = {"roof": Membrane(mesh.triangles, FABRIC, 1e3), "ring": Cable(polyline(ring), 1e7, force)}
    structure = Structure(mesh.points, parts, [Support(ring[:-1], "z"), Support(list(mesh.nodes.values()))])
    found = remeshed(structure, 0.6).structure
    cable = found.parts["ring"]
    assert np.bincount(np.unique(cable.cells, return_inverse=True)[1].ravel()).tolist() == [2] * len(cable.cells)
    assert len(cable.cells) == 12
    assert np.asarray(cable.prestress).min() < 920
    assert np.asarray(cable.prestress).max() > 1080
    assert sorted(found.supports[0].nodes.tolist()) == sorted(np.unique(cable.cells).tolist())


def test_seam_between_membranes_stays_shared():
    points, triangles, _ = hypar()
    left = points[triangles].mean(axis=1)[:, 0] < 0
    parts = {"left": Membrane(triangles[left], FABRIC, 2e3), "right": Membrane(triangles[~left], FABRIC, 1e3)}
    found = remeshed(Structure(points, parts), 0.3).structure
    both = np.intersect1d(found.parts["left"].cells, found.parts["right"].cells)
    np.testing.assert_allclose(found.points[both][:, 0], 0, atol=1e-14)
    assert len(both) == 15
    ordered = both[np.argsort(found.points[both][:, 1])]
    for name in parts:
        assert {tuple(sorted(edge)) for edge in polyline(ordered).tolist()} <= edges(found.parts[name].cells)


def test_masts_guys_and_held_lines():
    """Bars off the membrane keep their nodes; a line of held nodes stays held, cell by cell."""
    points, _, roof = hypar()
    head = 4 * 9 + 4
    points = np.vstack([points, [[0, 0, -3], [3, 3, -3], [2.5, 2.5, -1]]])
    parts = {
        "roof": roof,
        "mast": Mast([[head, 81]], 1e8, prestress=-2e3),
        "guy": Cable([[80, 83], [83, 82]], 1e7, prestress=[1e3, 2e3]),
    }
    supports = [
        Support([81, 82]),
        Support(np.arange(9)),
        Support([2 * 9 + k for k in range(2, 6)], "z"),
        Support([60], "x"),
    ]
    found = remeshed(Structure(points, parts, supports), 0.25, keep=[50])
    new, number = found.structure, found.nodes
    np.testing.assert_array_equal(
        new.points[number[[head, 81, 82, 83, 80, 60, 50]]], points[[head, 81, 82, 83, 80, 60, 50]]
    )
    assert new.parts["mast"].cells.tolist() == [[number[head], number[81]]]
    assert float(new.parts["mast"].prestress) == -2e3
    assert new.parts["guy"].cells.tolist() == number[[[80, 83], [83, 82]]].tolist()
    assert new.parts["guy"].prestress.tolist() == [1e3, 2e3]
    held = [new.points[support.nodes] for support in new.supports]
    assert len(held[1]) == 18
    np.testing.assert_array_equal(held[1][:, 1], -2.0)
    assert len(held[2]) == 8
    np.testing.assert_allclose(held[2][:, 1], -1.0, atol=1e-14)
    assert new.supports[3].nodes.tolist() == [number[60]]
    assert [support.components for support in new.supports] == ["xyz", "xyz", "z", "x"]


def test_sheet_held_all_over():
    points, _, roof = hypar()
    found = remeshed(Structure(points, {"roof": roof}, [Support(range(81), "z"), Support([0, 8, 72])]), 0.3).structure
    assert found.supported[:, 2].all()
    assert found.supported[:, 0].sum() == 3


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


def sphere(n=8):
    """Blow up a cube: a closed surface."""
    points, triangles = rectangle(2.0, 2.0, n, n)
    up = np.array([0.0, 0.0, 1.0])
    faces = [points + up, points * [1, -1, 1] - up]
    faces += [faces[side][:, axes] for axes in ([2, 0, 1], [1, 2, 0]) for side in range(2)]
    every = np.vstack(faces)
    cells = np.vstack([triangles + k * len(points) for k in range(6)])
    _, first, which = np.unique(np.round(every, 9), axis=0, return_index=True, return_inverse=True)
    every = every[first]
    return every / np.linalg.norm(every, axis=1, keepdims=True), which.ravel()[cells]


@pytest.mark.parametrize(
    ("size", "message"),
    [
        (0, "^size is 0; it must be positive"),
        (-1.0, "^size is -1.0; it must be positive"),
        (9.0, "^size is 9, more than that of the membranes, 4"),
        (lambda x: -(x[0] ** 2), "^size, as a function of places, gives .*positive numbers"),
        (lambda x: np.ones(3), "^size, as a function of places, gives .*one for each place"),
    ],
)
def test_size_refused(size, message):
    points, _, roof = hypar()
    with pytest.raises(ValueError, match=message):
        remeshed(Structure(points, {"roof": roof}), size)


def test_shapes_refused():
    points, triangles, roof = hypar()
    ball, cells = sphere()
    closed = Structure(ball, {"ball": Membrane(cells, FABRIC, 1e3)})
    with pytest.raises(ValueError, match=r"^Part 'ball' is closed around \(.*make it of two parts"):
        remeshed(closed, 0.3)
    with pytest.raises(ValueError, match=r"^The structure has no membrane to mesh anew; its parts are \['rope'\]"):
        remeshed(Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6)}), 0.3)
    with pytest.raises(ValueError, match=r"^keep names node 99, which does not exist"):
        remeshed(Structure(points, {"roof": roof}), 0.3, keep=[99])
    with pytest.raises(ValueError, match=r"^remeshed shape is 5; give a Structure or Form"):
        remeshed(5, 0.3)
    net = force_density(points[:3], polyline([0, 1, 2]), 1.0, [Support([0, 2])])
    with pytest.raises(ValueError, match=r"^The form of a net has no stiffness"):
        remeshed(net, 0.3)
    fin = Structure(np.vstack([points, [0, 0, 5]]), {"roof": Membrane([*triangles, [40, 41, 81]], FABRIC, 1e3)})
    with pytest.raises(ValueError, match=r"^Part 'roof' branches"):
        remeshed(fin, 0.3)
    centre = points[triangles].mean(axis=1)
    kite = triangles[(centre[:, 0] > 0) != (centre[:, 1] > 0)]
    sheet = Structure(points, {"kite": Membrane(np.vstack([kite, [[0, 1, 10]]]), FABRIC, 1e3)})
    assert remeshed(sheet, 0.5).structure.parts["kite"].cells.shape[1] == 3  # pieces that meet in a node
    hollow = np.setdiff1d(np.arange(128), np.flatnonzero((triangles == 40).any(axis=1))[[0, 3]])
    with pytest.raises(ValueError, match=r"^Part 'roof' touches itself in a node of its rim, at \("):
        remeshed(Structure(points, {"roof": Membrane(triangles[hollow], FABRIC, 1e3)}), 0.5)
