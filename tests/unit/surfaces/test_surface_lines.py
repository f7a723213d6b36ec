"""Geodesics and lines along the warp: across edges, through nodes, along rims; refusals."""

import numpy as np
import pytest
from mpi4py import MPI
from scipy.sparse import coo_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial.distance import cdist

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    SurfaceLine,
    boundary_edges,
    geodesic,
    rectangle,
    warp_along,
    warp_lines,
)

pytest.importorskip("potpourri3d")

FABRIC = Fabric(4e5, 0.3)


def sheet(n=8, height=None, size=4.0):
    points, triangles = rectangle(size, size, n, n)
    if height is not None:
        points[:, 2] = height(points[:, 0], points[:, 1])
    return points, triangles


def hilly(seed=1, n=12):
    random = np.random.default_rng(seed)
    a, b = random.uniform(-1, 1, (2, 3))
    points, triangles = sheet(n, lambda x, y: 0.4 * sum(np.sin(p * x + q * y + p) for p, q in zip(a, b, strict=True)))
    inner = np.setdiff1d(np.arange(len(points)), np.unique(boundary_edges(triangles)))
    points[inner, :2] += random.uniform(-0.08, 0.08, (len(inner), 2))
    return points, triangles


def kinks(surface, line):
    """Angles that a line makes with the edges it crosses, before less after, and its distance from its cells."""
    points, triangles = surface
    found, off = [], []
    for k in range(len(line.cells)):
        a, b, c = points[triangles[line.cells[k]]]
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal)
        off += [abs((place - a) @ normal) for place in line.points[k : k + 2]]
    for k in range(1, len(line.cells)):
        common = np.intersect1d(triangles[line.cells[k - 1]], triangles[line.cells[k]])
        if len(common) == 2:
            edge = points[common[1]] - points[common[0]]
            before, after = line.directions[k - 1 : k + 1] @ edge / np.linalg.norm(edge)
            at_node = np.linalg.norm(points[common] - line.points[k], axis=1).min() < 1e-9
            found.append(0.0 if at_node else before - after)
    return np.abs(found).max(), max(off)


@pytest.mark.parametrize("direction", [(1, 0, 0), (1, 1, 0), (1, 0.3, 0), (0, -1, 0), (-1, -0.7, 0), (1, 2, 5)])
@pytest.mark.parametrize("start", [40, (0.1, 0.05, 0.0), (0.25, 0.0, 0.0), (0.25, 0.25, 0.0)])
def test_straight_in_the_plane(start, direction):
    """From a node, a cell and an edge, through nodes and along edges."""
    surface = sheet()
    line = geodesic(surface, start, direction=direction)
    first = surface[0][start] if isinstance(start, int) else np.array(start)
    np.testing.assert_allclose(line.points[0], first, rtol=0, atol=1e-15)
    along = np.array([*direction[:2], 0]) / np.hypot(*direction[:2])
    offset = line.points - first
    np.testing.assert_allclose(np.cross(offset, along), 0, atol=1e-12)
    assert np.abs(line.points[-1][:2]).max() == pytest.approx(2.0, rel=1e-12)
    assert line.length == pytest.approx(offset[-1] @ along, rel=1e-12)
    assert (np.diff(offset @ along) > 0).all()
    again = geodesic(surface, start, line.points[-1])
    assert again.length == pytest.approx(line.length, rel=1e-12)


def test_length():
    surface = sheet()
    line = geodesic(surface, 40, direction=(3, 1, 0), length=1.234)
    assert line.length == pytest.approx(1.234, rel=1e-13)
    assert geodesic(surface, 40, direction=(3, 1, 0), length=100.0).points[-1][0] == pytest.approx(2.0)


def test_along_the_rim_and_past_a_corner_of_it():
    """Straight on along the rim; past the corner of a hole, where the sheet is on one side only."""
    surface = sheet()
    assert geodesic(surface, 0, direction=(1, 0, 0)).length == pytest.approx(4.0, rel=1e-12)
    points, triangles = surface
    centre = points[triangles].mean(axis=1)
    angle = points, triangles[~((centre[:, 0] > 0) & (centre[:, 1] > 0))]
    line = geodesic(angle, (-1.0, 1.0, 0.0), direction=(1, -1, 0))
    np.testing.assert_allclose(line.points[-1], [2, -2, 0], atol=1e-12)
    bent = geodesic(angle, (-1.0, 2.0, 0.0), (2.0, -1.0, 0.0))
    assert bent.length == pytest.approx(2 * np.hypot(1, 2), rel=1e-12)
    assert np.linalg.norm(bent.points, axis=1).min() < 1e-12  # around the corner


@pytest.mark.parametrize("seed", range(4))
def test_unfolded_lines_are_straight(seed):
    """Equal angles at each edge, on a hilly surface, for both kinds of geodesics; and back again."""
    surface = hilly(seed)
    line = geodesic(surface, 14, direction=(1, 0.4 + 0.2 * seed, 0))
    assert max(kinks(surface, line)) < 1e-10
    assert len(line.cells) > 12
    back = geodesic(surface, line.points[-1], direction=-line.directions[-1], length=line.length)
    np.testing.assert_allclose(back.points[-1], line.points[0], atol=1e-9)
    between = geodesic(surface, line.points[0], line.points[-1])
    assert between.length <= line.length * (1 + 1e-12)
    shortest = geodesic(surface, 14, 14 + 9 * 13 + 9)
    assert max(kinks(surface, shortest)) < 1e-9


def test_shorter_than_lines_beside_it():
    """Against the shortest way over the edges of a much finer mesh of the same flat cells."""
    surface = hilly(2, 6)
    points, triangles = surface
    line = geodesic(surface, 0, 48)
    n = 24
    i, j = np.mgrid[: n + 1, : n + 1].reshape(2, -1)
    shares = np.stack([n - i - j, i, j], axis=1)[i + j <= n] / n
    fine = np.einsum("sk,cki->csi", shares, points[triangles]).reshape(-1, 3)
    _, first, which = np.unique(np.round(fine, 9), axis=0, return_index=True, return_inverse=True)
    own = which.ravel().reshape(len(triangles), -1)
    rim = np.flatnonzero(shares.min(axis=1) == 0)
    a = own[:, rim][:, :, None].repeat(len(rim), 2).ravel()
    b = own[:, rim][:, None, :].repeat(len(rim), 1).ravel()
    weight = np.concatenate(
        [cdist(*[fine.reshape(len(triangles), -1, 3)[c][rim]] * 2).ravel() for c in range(len(triangles))]
    )
    _, keep = np.unique(a * len(first) + b, return_index=True)
    graph = coo_array((weight[keep], (a[keep], b[keep])), shape=(len(first), len(first))).tocsr()
    ends = [np.flatnonzero(np.linalg.norm(fine[first] - points[node], axis=1) < 1e-9)[0] for node in (0, 48)]
    by_graph = dijkstra(graph, indices=ends[0])[ends[1]]
    assert line.length <= by_graph <= line.length * (1 + 2e-3)


def test_within_one_cell_and_along_an_edge():
    surface = sheet()
    line = geodesic(surface, (0.3, 0.1, 0), (0.4, 0.2, 0))
    np.testing.assert_allclose(line.points, [[0.3, 0.1, 0], [0.4, 0.2, 0]], atol=1e-14)
    assert geodesic(surface, 0, 1).cells.shape == (1,)
    assert geodesic(surface, 0, (-1.7, -2.0, 0)).length == pytest.approx(0.3, rel=1e-12)


def test_shapes_with_parts():
    """A line crosses the seam between two membranes; of one of them it ends there. A state is taken as deformed."""
    points, triangles = sheet()
    left = points[triangles].mean(axis=1)[:, 0] < 0
    parts = {"left": Membrane(triangles[left], FABRIC, 1e3), "right": Membrane(triangles[~left], FABRIC, 1e3)}
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    assert geodesic(structure, (-1, 0.1, 0), direction=(1, 0, 0)).points[-1][0] == pytest.approx(2)
    seam = geodesic(structure, (-1, 0.1, 0), direction=(1, 0, 0), part="left")
    assert seam.points[-1][0] == pytest.approx(0, abs=1e-14)
    assert seam.cells.max() < left.sum()
    state = Analysis(structure, progress=False).run([Stage("p")])["p"]
    assert geodesic(state, 0, 80).length == pytest.approx(4 * np.sqrt(2), rel=1e-12)
    with pytest.raises(ValueError, match=r"^The structure has the membranes \['left', 'right'\]; name the one"):
        warp_lines(structure, [40])
    both = np.vstack([points, points + np.array([10, 0, 0])]), np.vstack([triangles, triangles + len(points)])
    with pytest.raises(ValueError, match=r"^start and end, .* are on pieces of the surface that share no node"):
        geodesic(both, 0, 100)


def test_warp_lines():
    """Straight for a constant warp, in its sense, whatever the numbers of nodes; carried along by a deformation."""
    points, triangles = sheet()
    roof = Membrane(triangles, FABRIC, 1e3, warp=(1, 0.5, 0))
    structure = Structure(points, {"roof": roof}, [Support(np.unique(boundary_edges(triangles)))])
    for start in (40, (0.1, 0.2, 0), (0.25, 0.0, 0)):
        (line,) = warp_lines(structure, [start])
        place = points[start] if isinstance(start, int) else np.array(start)
        np.testing.assert_allclose(np.cross(line.points - place, [1, 0.5, 0]), 0, atol=1e-12)
        np.testing.assert_allclose(np.abs(line.points[[0, -1], :2]).max(axis=1), 2, rtol=1e-12)
        assert line.directions[0] @ [1, 0.5, 0] > 0
    signs = np.where(np.arange(len(triangles)) % 2, 1.0, -1.0)[:, None] * [1, 0.5, 0]
    turned = Structure(points, {"roof": Membrane(triangles, FABRIC, 1e3, warp=signs)})
    (line,) = warp_lines(turned, [(0.1, 0.2, 0)])
    np.testing.assert_allclose(np.cross(line.points - [0.1, 0.2, 0], [1, 0.5, 0]), 0, atol=1e-12)
    edge = Structure(points, {"roof": Membrane(triangles, FABRIC, 1e3, warp=(1, 0, 0))})
    (line,) = warp_lines(edge, [40])
    np.testing.assert_allclose(line.points[[0, -1]], [[-2, 0, 0], [2, 0, 0]], atol=1e-12)


def test_warp_along_geodesics():
    """Constant between parallel lines; halfway between two that enclose an angle; usable as warp of a membrane."""
    points, triangles = sheet(16)
    lines = [
        geodesic((points, triangles), (0, y, 0), direction=(s, 0.1 * s * y, 0)) for y in (-1.5, 1.5) for s in (1, -1)
    ]
    warp = warp_along((points, triangles), lines)
    roof = Structure(points, {"roof": Membrane(triangles, FABRIC, (2e3, 1e3), warp=warp)})
    np.testing.assert_allclose(roof.warp("roof"), warp, atol=1e-12)
    assert (warp @ warp[0]).min() > 0.9  # one sense
    middle = np.abs(points[triangles].mean(axis=1)[:, 1]) < 0.2
    np.testing.assert_allclose(np.abs(warp[middle, 0]), 1, atol=1e-3)
    for line in lines:
        np.testing.assert_allclose(np.abs(np.sum(warp[line.cells] * line.directions, axis=1)), 1, atol=1e-12)
    hill = hilly(3)
    warp = warp_along(hill, [geodesic(hill, 14, direction=(1, 1, 0)), geodesic(hill, 100, direction=(1, 0.8, 0))])
    np.testing.assert_allclose(np.linalg.norm(warp, axis=1), 1, rtol=1e-12)


@pytest.mark.mpi
def test_same_on_all_processes():
    surface = hilly()
    line = geodesic(surface, 0, 100)
    for points in MPI.COMM_WORLD.allgather(line.points):
        np.testing.assert_array_equal(points, line.points)


@pytest.mark.parametrize(
    ("arguments", "changes", "message"),
    [
        ((0,), {}, "^geodesic has both an end and a direction, or neither"),
        ((0, 1), {"direction": (1, 0, 0)}, "^geodesic has both an end and a direction, or neither"),
        ((0, 1), {"length": 1.0}, "^length is given with an end"),
        ((0, 0), {}, r"^start and end are the same point, \(-2, -2, 0\)"),
        ((999, 1), {}, "^start is node 999, which is not on the surface"),
        (
            (0, (0, 0, 1.0)),
            {},
            r"^end \(0, 0, 1\) is not on the surface, but 1 from it; the nearest point is \(0, 0, 0\)",
        ),
        ((0,), {"direction": (-1, 0, 0)}, "^direction .* leads off the surface, or is normal to it, at"),
        ((40,), {"direction": (0, 0, 1)}, "^direction .* leads off the surface, or is normal to it, at"),
        ((40,), {"direction": (0, 0, 0)}, "^direction is"),
        ((40,), {"direction": (1, 0, 0), "length": 0}, "^length is 0; it must be positive"),
    ],
)
def test_refused(arguments, changes, message):
    with pytest.raises(ValueError, match=message):
        geodesic(sheet(), *arguments, **changes)


def test_surfaces_refused():
    points, triangles = sheet()
    with pytest.raises(ValueError, match=r"^The surface branches at \("):
        geodesic((np.vstack([points, [0, 0, 5]]), [*triangles, [40, 41, 81]]), 0, 80)
    tube, cells = points.copy(), triangles.copy()
    tube[:, 0], tube[:, 2] = np.cos(points[:, 0] * np.pi / 2), np.sin(points[:, 0] * np.pi / 2)
    seam = np.arange(len(points)).reshape(9, 9)
    seam[:, 8] = seam[:, 0]
    cells = seam.ravel()[cells]
    with pytest.raises(ValueError, match=r"^The line from \(.*\) reaches no rim, but runs round the surface"):
        geodesic((tube, cells), 40, direction=(0, 0, 1) if abs(tube[40, 2]) < 0.5 else (1, 0, 0))
    around = geodesic((tube, cells), 40, direction=(0, 0, 1) if abs(tube[40, 2]) < 0.5 else (1, 0, 0), length=3.0)
    assert around.length == pytest.approx(3, rel=1e-12)
    ring = Structure(tube, {"tube": Membrane(cells, FABRIC, 1e3, warp=np.cross(tube[cells].mean(axis=1), [0, 1, 0]))})
    with pytest.raises(ValueError, match=r"^The line from \(.*\) reaches no rim"):
        warp_lines(ring, [40])
    with pytest.raises(ValueError, match=r"^warp_lines shape is .*give a Structure"):
        warp_lines((points, triangles), [40])
    with pytest.raises(ValueError, match=r"^starts is 40; give a list"):
        warp_lines(ring, 40)


@pytest.mark.parametrize("spacing", [3.9, 4.1, 1e3])
def test_spacing_larger_than_all_lines_is_refused(spacing):
    points, triangles = sheet()
    sail = Structure(points, {"sail": Membrane(triangles, FABRIC, 1e3, warp=(1, 0, 0))})
    if spacing < 4:
        assert len(warp_lines(sail, spacing=spacing)) == 1
        return
    with pytest.raises(ValueError, match=rf"^spacing is {spacing:g}, and no line along the warp is as long; give a"):
        warp_lines(sail, spacing=spacing)


def test_piece_without_length_has_no_direction():
    surface = sheet()
    line = geodesic(surface, 40, direction=(1, 0, 0))
    longer = SurfaceLine(np.concatenate([line.points, line.points[-1:]]), np.append(line.cells, line.cells[-1]))
    assert not longer.directions[-1].any()
    assert warp_along(surface, [longer]) == pytest.approx(warp_along(surface, [line]))
    with pytest.raises(ValueError, match=r"^lines, entry 1, at \(0, 0, 0\), has no length, and so no direction"):
        warp_along(surface, [line, SurfaceLine(surface[0][[40, 40]], line.cells[:1])])


def test_warp_along_refused():
    surface = sheet()
    line = geodesic(surface, 40, direction=(1, 0, 0))
    pieces = np.vstack([surface[0], surface[0] + [9, 0, 0]]), np.vstack([surface[1], surface[1] + 81])
    with pytest.raises(ValueError, match=r"^The piece of the surface with cell \d+, at \(.*has no line"):
        warp_along(pieces, [line])
    with pytest.raises(ValueError, match=r"^lines must be a list of SurfaceLine"):
        warp_along(surface, line)
    with pytest.raises(ValueError, match=r"^lines, entry 0, .* is of another surface"):
        warp_along((surface[0] + [9, 0, 0], surface[1]), [line])
    cross = [
        geodesic(surface, (-1, -1.9, 0), direction=(0, 1, 0)),
        geodesic(surface, (1.9, -1, 0), direction=(0, 1, 0)),
    ]
    assert warp_along(surface, cross).shape == (128, 3)
