"""Masts that have fallen, tilted or can move freely are told; those that lean a little are not."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
    stability,
    updated_reference,
)

pytestmark = pytest.mark.filterwarnings(
    "ignore::fx_membrane.UnstableStateWarning", "ignore::fx_membrane.LostPrestressWarning"
)


def hypar_and_pole():
    """Make a roof held along its edge, and beside it a pole without its third guy; return the head too."""
    points, triangles = rectangle(8.0, 6.0, 8, 8)
    points = np.column_stack([points[:, :2], points[:, 0] * points[:, 1] / 12])
    edge, n = np.unique(boundary_edges(triangles)), len(points)
    pole = np.add([[0, 0, 0], [0, 0, 4.0], [3, 0, 0], [-1.5, 2.598, 0]], [15.0, 0, 0])
    parts = {
        "fabric": Membrane(triangles, Fabric(5e5, 0.3), 2e3),
        "ridge": Cable(polyline(36 + np.arange(9)), 1e7, 2e4),
        "pole": Mast([[n, n + 1]], 2e8),
        "guys": Cable([[n + 1, n + 2], [n + 1, n + 3]], 1e6),
    }
    return Structure(np.vstack([points, pole]), parts, [Support([*edge, n, n + 2, n + 3])]), n + 1


def tent(stays, k=8):
    """Make a square sail with two corners on the ground and two on masts, with some of four stays."""
    points, triangles = rectangle(10.0, 10.0, k, k)
    c, d, n = 0.5**0.5, 10 * 0.5**0.5, len(points)
    x, y = c * (points[:, 0] - points[:, 1]), c * (points[:, 0] + points[:, 1])
    points = np.column_stack([x, y, 2.5 + 1.5 * (x**2 - y**2) / d**2])
    west, east, south, north = (int(i) for i in (x.argmin(), x.argmax(), y.argmin(), y.argmax()))
    parts = {
        "fabric": Membrane(triangles, Fabric(800e3, 0.2), 2.5e3),
        "edges": Cable(boundary_edges(triangles), 2e7, 25e3),
    }
    found = updated_reference(Structure(points, parts, [Support([west, east, south, north])])).structure
    ground = [[0.8 - d, 0, 0], [d - 0.8, 0, 0], *([s * (d + 3), t, 0] for s in (-1, 1) for t in (2.5, -2.5))]
    cells = np.array([[n + 2, west], [n + 3, west], [n + 4, east], [n + 5, east]])[stays]
    masts, ties = Mast([[n, west], [n + 1, east]], 3e8, -62e3), Cable(cells, 2e7, 32e3)
    points = np.vstack([found.points, ground])
    supports = [Support([south, north, n, n + 1, *cells[:, 0]])]
    return Structure(points, {**found.parts, "masts": masts, "stays": ties}, supports), (west, east)


def told(result):
    return [remark for remark in result.remarks if "has tilted by" in remark]


def test_pole_upside_down_beside_a_roof_is_told():
    structure, head = hypar_and_pole()
    stage = Stage("snow", [DistributedLoad((0, 0, -600), "fabric"), PointLoad(head, (30, 50.0, -50))])
    result = Analysis(structure).run([stage])["snow"]
    moved = np.linalg.norm(result.displacement[head])
    assert result.position[head, 2] < 0
    words = told(result)[0]
    assert f"node {head} moved by {moved:.3g}, more than half" in words
    assert "mast 'pole' (cell 0) has tilted by 1" in words


@pytest.mark.parametrize("snow", [100.0, 600.0])
@pytest.mark.parametrize("stays", [[2, 3], [1, 2, 3]])
def test_mast_of_a_tent_without_its_stays_is_told(stays, snow):
    structure, heads = tent(stays)
    result = Analysis(structure).run([Stage("snow", [DistributedLoad((0, 0, -snow), "fabric")])])["snow"]
    assert len(told(result)) == 1
    moved = np.linalg.norm(result.displacement[heads[0]])
    assert "mast 'masts' (cell 0) has tilted by" in told(result)[0]
    assert f"its node {heads[0]} moved by {moved:.3g}" in told(result)[0]


def test_tent_with_all_its_stays_gets_no_remark():
    structure, _ = tent([0, 1, 2, 3])
    wind = Stage("wind", [DistributedLoad((200, 0, 400), "fabric")], after="rest")
    snow = Stage("snow", [DistributedLoad((0, 0, -600), "fabric")], after="rest")
    at_once = Stage("at once", [DistributedLoad((0, 0, -600), "fabric")])
    results = Analysis(structure).run([Stage("rest"), wind, snow, at_once])
    assert [result.remarks for result in results.values()] == [()] * 4


@pytest.mark.mpi
def test_mast_that_is_tilted_by_prescription_is_not_told():
    points = [[0.0, 0, 0], [0, 0, 4], [3, 0, 0], [-3, 2, 0], [-3, -2, 0]]
    guys = Cable([[1, 2], [1, 3], [1, 4]], 1e5, 1e3)
    structure = Structure(points, {"mast": Mast([[0, 1]], 2e8), "guys": guys}, [Support([2, 3, 4])])
    ends = [PrescribedDisplacement(0, (0, 0, 0)), PrescribedDisplacement(1, (2.0, 0, -0.5))]
    head = Stage("head", displacements=ends)
    foot = Stage("foot", displacements=[PrescribedDisplacement(0, (1.5, 0, 0))])
    results = Analysis(structure).run([head, foot])
    assert not told(results["head"])
    assert not told(results["foot"])


def in_one_plane(feet, prestress=1e3):
    """Two masts with a cable between their heads and a guy each, and more guys from the first one."""
    points = [[0.0, 0, 0], [0, 0, 4], [6, 0, 0], [6, 0, 4], [-3, 0, 0], [9, 0, 0], *feet]
    cells = [[1, 3], [1, 4], [3, 5], *([1, 6 + i] for i in range(len(feet)))]
    forces = [prestress * 0.6, prestress, prestress, *[prestress] * len(feet)]
    parts = {"masts": Mast([[0, 1], [2, 3]], 2e8, -0.8 * prestress), "cables": Cable(cells, 12e6, forces)}
    return Structure(points, parts, [Support([0, 2, 4, 5, *range(6, len(points))])])


def test_mast_between_two_guys_in_one_plane_is_free_across():
    points = [[0.0, 0, 0], [0, 0, 4], [3, 0, 0], [-3, 0, 0]]
    structure = Structure(
        points, {"mast": Mast([[0, 1]], 2e8), "guys": Cable([[1, 2], [1, 3]], 12e6, 1e3)}, [Support([0, 2, 3])]
    )
    along = Stage("along", [PointLoad(1, (100.0, 0, 0))], after="rest")
    results = Analysis(structure).run([Stage("rest"), along])
    for result in results.values():
        assert stability(result).free == 1
        assert not stability(result).held_by_slack
        words = result.remarks[0].replace("-1", "1")
        assert "mast 'mast' (cell 0, at node 1) is not held in the direction (0, 1, 0)" in words


def test_masts_in_one_plane_are_free_together():
    result = Analysis(in_one_plane([])).run([Stage("rest")])["rest"]
    assert stability(result).free == 1
    assert any("mast 'masts'" in remark and "moves without resistance" in remark for remark in result.remarks)


def test_masts_with_guys_across_are_held():
    structure = in_one_plane([[0, 3.0, 0], [0, -3.0, 0]])
    parts = {**structure.parts, "tie": Cable([[3, 6], [3, 7]], 12e6, 1e3)}
    held = Structure(structure.points, parts, structure.supports)
    result = Analysis(held).run([Stage("load", [DistributedLoad((0, 0, -1.0), "cables")])])["load"]
    assert stability(result).stable
    assert result.remarks == ()
