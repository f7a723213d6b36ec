"""Sails drawn in plan: named nodes and lines, heights, sizes, and plans that are refused."""

import subprocess
import sys

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    RoundHole,
    Structure,
    Support,
    boundary_edges,
    polyline,
    projected_stress,
    sail_mesh,
)

pytest.importorskip("gmsh")
SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]
CANOPY = {"A": (-6, -6, 0), "B": (6, -6, 1), "C": (6, 6, 0), "D": (-6, 6, 1)}


def areas(mesh):
    a, b, c = (mesh.points[corner, :2] for corner in mesh.triangles.T)
    return ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2


def edges(triangles):
    return {tuple(sorted(edge)) for cell in triangles.tolist() for edge in ((*cell[:2],), (*cell[1:],), cell[::2])}


@pytest.fixture(scope="module")
def canopy():
    return sail_mesh(
        CANOPY,
        size=1.0,
        sag={"A-B": 0.1, "C-D": -0.05},
        holes={"ring": RoundHole((0, 0, 5), 0.6), "eye": [(3, -3), (4, -3), (4, -2)]},
        lines={"ridge": ["A", ("ring", 5 / 8)], "valley": [("B-C", 0.5), (5.0, 0.5)]},
        points={"head": (-3, 3, 4)},
        sizes={"C-D": 0.3, "head": 0.2},
    )


def test_named_nodes_and_lines(canopy):
    for name, place in {**CANOPY, "head": (-3, 3, 4)}.items():
        np.testing.assert_array_equal(canopy.points[canopy.nodes[name]], place)
    assert list(canopy.lines) == ["A-B", "B-C", "C-D", "D-A", "ring", "eye", "ridge", "valley"]
    there = edges(canopy.triangles)
    for name, line in canopy.lines.items():
        assert {tuple(sorted(edge)) for edge in polyline(line).tolist()} <= there, name
    assert canopy.lines["A-B"][[0, -1]].tolist() == [canopy.nodes["A"], canopy.nodes["B"]]
    rim = {tuple(sorted(edge)) for edge in boundary_edges(canopy.triangles).tolist()}
    borders = ["A-B", "B-C", "C-D", "D-A", "ring", "eye"]
    assert rim == {tuple(sorted(edge)) for name in borders for edge in polyline(canopy.lines[name]).tolist()}


def test_edges_with_a_sag_are_arcs(canopy):
    """Of radius (1/4 + s^2) / (2 s) over the chord, and equal segments; straight edges stay straight."""
    for name, sag, chord in [("A-B", 0.1, 12.0), ("C-D", -0.05, 12.0)]:
        line = canopy.points[canopy.lines[name], :2]
        radius = chord * (0.25 + sag**2) / (2 * sag)
        middle = np.array([0.0, -6 + sag * chord - radius if name == "A-B" else 6 - sag * chord + radius])
        np.testing.assert_allclose(np.linalg.norm(line - middle, axis=1), abs(radius), rtol=1e-13)
        length = np.linalg.norm(np.diff(line, axis=0), axis=1)
        np.testing.assert_allclose(length, length[0], rtol=1e-10)
        assert 0.5 < length[0] / (0.3 if name == "C-D" else 1.0) <= 1
    straight = canopy.points[canopy.lines["D-A"]]
    np.testing.assert_allclose(straight[:, 0], -6, rtol=0, atol=1e-14)


def test_heights(canopy):
    """Straight along edges and lines with heights, those of the ring in its plane, all others between them."""
    edge, ridge = canopy.points[canopy.lines["B-C"]], canopy.points[canopy.lines["ridge"]]
    np.testing.assert_allclose(edge[:, 2], 1 - (edge[:, 1] + 6) / 12, rtol=0, atol=1e-14)
    np.testing.assert_array_equal(canopy.points[canopy.lines["ring"], 2], 5.0)
    along = np.linalg.norm(ridge - ridge[0], axis=1)
    np.testing.assert_allclose(ridge[:, 2], 5 * along / along[-1], rtol=0, atol=1e-13)
    assert canopy.points[:, 2].min() >= 0
    assert canopy.points[:, 2].max() <= 5
    assert canopy.points[canopy.lines["valley"][0]].tolist() == [6.0, 0.0, 0.5]


def test_heights_of_a_plane_are_exact():
    corners = {name: (x, y, 0.2 * x - 0.3 * y + 1) for name, (x, y) in zip("ABCD", SQUARE, strict=True)}
    mesh = sail_mesh(corners, 0.5, lines={"free": ["A", (1, 1.2)]})
    x, y, z = mesh.points.T
    np.testing.assert_allclose(z, 0.2 * x - 0.3 * y + 1, rtol=0, atol=1e-13)


def test_area_and_sense(canopy):
    """All cells counter-clockwise; the area is that of the polygon, whatever the sense of the corners."""
    circle = 12 * 0.6**2 * np.sin(2 * np.pi / 12) / 2
    assert areas(canopy).min() > 0
    for corners in (SQUARE, SQUARE[::-1]):
        mesh = sail_mesh(corners, 0.5, sag=0.0, holes={"ring": RoundHole((2, 2), 0.6)})
        assert areas(mesh).min() > 0
        assert areas(mesh).sum() == pytest.approx(16 - circle, rel=1e-12)
        arcs = sail_mesh(corners, 0.5, sag=0.1)
        assert areas(arcs).sum() < 16 - 4 * 4 * 0.4 / 2


@pytest.mark.parametrize("size", [2.0, 1.0, 0.5, 0.25])
def test_cells_have_the_size(size):
    mesh = sail_mesh(SQUARE, size)
    length = np.array([np.linalg.norm(mesh.points[a] - mesh.points[b]) for a, b in edges(mesh.triangles)])
    assert 0.6 * size < length.mean() < 1.1 * size
    assert length.max() < 1.9 * size
    a, b, c = (mesh.points[corner] for corner in mesh.triangles.T)
    sides = np.stack([np.linalg.norm(p - q, axis=1) for p, q in [(a, b), (b, c), (c, a)]])
    quality = 4 * np.sqrt(3) * areas(mesh) / (sides**2).sum(axis=0)  # 1 for equal sides
    assert quality.min() > 0.5


def test_sizes_are_local(canopy):
    near = np.linalg.norm(canopy.points[canopy.triangles].mean(axis=1)[:, :2] - [-3, 3], axis=1)
    assert np.sqrt(areas(canopy)[near < 0.3].mean()) < 0.3
    assert np.sqrt(areas(canopy).mean()) > 0.3


def test_sail_is_found_from_its_mesh():
    """Attach cables and supports, and find the form: the use of it all, with nothing prepared."""
    mesh = sail_mesh(CANOPY, 1.5, sag=0.1, holes={"ring": RoundHole((0, 0, 5), 0.6)})
    radius = 12 * (0.25 + 0.01) / 0.2
    roof = Membrane(mesh.triangles, Fabric(4e5, 0.3), prestress=1e3)
    names = ("A-B", "B-C", "C-D", "D-A")
    cables = {name: Cable(polyline(mesh.lines[name]), 1e7, prestress=1e3 * radius) for name in names}
    corners = [mesh.nodes[name] for name in CANOPY]
    form = projected_stress(
        Structure(mesh.points, {"roof": roof, **cables}, [Support([*corners, *mesh.lines["ring"][:-1]])])
    )
    assert form.converged
    np.testing.assert_allclose(form.points[:, :2], mesh.points[:, :2], rtol=0, atol=0.1)


@pytest.mark.mpi
def test_same_on_all_processes():
    mesh = sail_mesh(SQUARE, 0.5, sag=0.1, points={"p": (2, 2, 1)})
    others = MPI.COMM_WORLD.allgather((mesh.points, mesh.triangles, mesh.lines, mesh.nodes))
    for points, triangles, lines, nodes in others:
        np.testing.assert_array_equal(points, mesh.points)
        np.testing.assert_array_equal(triangles, mesh.triangles)
        assert {name: line.tolist() for name, line in lines.items()} == {
            name: line.tolist() for name, line in mesh.lines.items()
        }
        assert nodes == mesh.nodes


USER = """
import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.123)
gmsh.model.add("mine")
gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
gmsh.model.occ.synchronize()
gmsh.model.mesh.generate(2)
before = gmsh.model.mesh.getNodes()[1]
from fx_membrane import sail_mesh
mesh = sail_mesh([[0, 0], [4, 0], [4, 4]], 0.5)
assert gmsh.model.getCurrent() == "mine" and gmsh.model.list() == MODELS
assert (gmsh.model.mesh.getNodes()[1] == before).all()
assert gmsh.option.getNumber("Mesh.MeshSizeMax") == 0.123
gmsh.finalize()
print(len(mesh.points))
"""


def test_open_model_is_left_alone():
    code = USER.replace("MODELS", "models").replace("before =", "models = gmsh.model.list()\nbefore =")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert int(done.stdout) > 20


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"size": 0}, "^size is 0; it must be positive"),
        ({"size": -1.0}, "^size is -1.0; it must be positive"),
        ({"size": 5.0}, "^size is 5, more than that of the plan, 4"),
        ({"size": 1e-6}, "^size is 1e-06.*too many cells"),
        ({"corners": SQUARE[:2]}, "^corners has 2"),
        ({"corners": [[0, 0], [4, 0], [0, 4], [4, 4]]}, r"^The plan folds.*'1-2'.*'3-0' meet at \(2, 2\); give"),
        ({"corners": [[0, 0], [4, 0], [8, 0]]}, "^The corners lie on one line"),
        ({"corners": [*SQUARE, [0, 4]]}, r"^The corner '4' is at the place of '3', \(0, 4\)"),
        ({"corners": [[0, 0], [4, 0], [4, np.nan]]}, "^corners has a value that is not finite"),
        ({"corners": [[0, 0], [4, 0], [4, 4], [2, 0], [0, 4]]}, r"^The plan folds.*'0-1'.*'3-4' meet at \(2, 0\)"),
        ({"sag": 0.49}, "^The plan folds over itself: the edge '0-1' and the edge '1-2' meet at"),
        ({"sag": 0.5}, "^sag of '0-1' is 0.5, an arc beyond half a circle"),
        ({"sag": {"A-B": 0.1}}, "^sag names 'A-B', which is no edge; those are"),
        ({"holes": {"ring": RoundHole((6, 6), 0.3)}}, r"^The hole 'ring' is outside the edges of the plan at \("),
        ({"holes": {"ring": RoundHole((3.9, 2), 0.3)}}, r"^The edge '1-2' and the hole 'ring' meet at \(4, "),
        ({"holes": {"ring": RoundHole((3.7, 2), 0.3)}}, r"^The edge '1-2' and the hole 'ring' meet at \(4, 2\)"),
        (
            {"holes": {"ring": RoundHole((2, 2), 3.5)}},
            r"^The hole 'ring' is outside the edges|^The edge .* 'ring' meet",
        ),
        ({"holes": {"a": RoundHole((2, 2), 0.3), "b": RoundHole((2, 2), 0.2)}}, "^The hole 'b' is within the hole 'a'"),
        (
            {"holes": {"a": RoundHole((2, 2), 0.3), "b": RoundHole((2.4, 2), 0.3)}},
            "^The hole 'a' and the hole 'b' meet",
        ),
        ({"holes": {"a": [(1, 1), (2, 2)]}}, "^The hole 'a' has 2 corners"),
        (
            {"holes": {"a": [(1, 1), (2, 2), (2, 1), (1, 2)]}},
            r"^The hole 'a' crosses itself at \(1\.5, 1\.5\); give its points in order, each once",
        ),
        ({"lines": {"l": [(1, 1), (2, 1), (1, 1)]}}, r"^The line 'l' crosses itself at \(.*; give its points in order"),
        ({"lines": {"l": ["0", "2"], "m": ["1", "3"]}}, r"^The line 'l' and the line 'm' meet at \(2, 2\)"),
        ({"lines": {"l": ["0", "1"]}}, "^The edge '0-1' and the line 'l' meet"),
        ({"lines": {"l": ["0", (5, 5)]}}, "^The line 'l' is outside the edges"),
        ({"lines": {"l": ["0", "x"]}}, "^The line 'l' names 'x', which is no corner or point"),
        ({"lines": {"l": ["0", ("0-1", 1.5)]}}, "^The line 'l' has the share 1.5 of '0-1'"),
        ({"lines": {"l": ["0"]}}, "^The line 'l' is .*at least two points"),
        (
            {"lines": {"l": ["0", "2"]}, "holes": {"ring": RoundHole((2, 2), 0.5)}},
            "^The hole 'ring' and the line 'l' meet",
        ),
        ({"points": {"p": (5, 5, 1)}}, r"^The point 'p' is outside the edges of the plan, at \(5, 5\)"),
        ({"points": {"p": (2, 2)}, "holes": {"r": RoundHole((2, 2), 0.5)}}, "^The point 'p' is within a hole"),
        ({"points": {"p": (2, 2, 1)}, "lines": {"l": [(1, 2, 0), (2, 2, 2)]}}, "^The line 'l' has the height 2 at"),
        ({"points": {"0": (2, 2, 1)}}, "^The name '0' is given twice"),
        ({"holes": {"0-1": RoundHole((2, 2), 0.5)}}, "^The name '0-1' is given twice"),
        ({"sizes": {"x": 0.1}}, "^sizes names 'x', which is not in the plan"),
        ({"sizes": {"0-1": 0.0}}, "^sizes of '0-1' is 0.0; it must be positive"),
    ],
)
def test_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        sail_mesh(**{"corners": SQUARE, "size": 0.5, **changes})


def test_ring_of_no_radius():
    with pytest.raises(ValueError, match=r"^RoundHole radius is 0; it must be positive"):
        RoundHole((0, 0), 0)
    with pytest.raises(ValueError, match=r"^RoundHole centre is .*give \(x, y\)"):
        RoundHole((0, 0, 0, 0), 1)


@pytest.mark.parametrize("unit", [1e3, 0.3048, 1e-2])
def test_mesh_does_not_depend_on_the_unit(unit):
    def drawn(scale):
        corners = {"A": (0, 0, 0), "B": (12, 0, 3), "C": (11, 9, 0), "D": (0.3, 12, 3)}
        scaled = {name: tuple(scale * x for x in place) for name, place in corners.items()}
        ring = RoundHole((5.1 * scale, 6.2 * scale, 5 * scale), 0.6 * scale)
        return sail_mesh(scaled, 0.9 * scale, sag=0.1, holes={"ring": ring})

    metres, other = drawn(1.0), drawn(unit)
    np.testing.assert_array_equal(other.triangles, metres.triangles)
    np.testing.assert_allclose(other.points / unit, metres.points, atol=1e-12 * 12)
