"""Parts and supports on new meshes: stress, warp, cables, seams, masts and held lines carried over."""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Mast,
    Membrane,
    OrthotropicFabric,
    RoundHole,
    Structure,
    Support,
    polyline,
    remeshed,
    sail_mesh,
)
from hypars import FABRIC, edges, hypar

pytest.importorskip("gmsh")


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


@pytest.mark.mpi
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
