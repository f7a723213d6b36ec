"""Supports and structures: their data, and refused input."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, Structure, Support

FABRIC = Fabric(Et=1e5, nu=0.3)
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]])  # no part uses the last one
TRIANGLES = [[0, 1, 2], [0, 2, 3]]


def sheet(supports=(), points=POINTS, cells=TRIANGLES, **data):
    return Structure(points, {"fabric": Membrane(cells, FABRIC, **data)}, supports)


# Cells


@pytest.mark.parametrize(("bad", "exist"), [(-1, "0 to 4"), (5, "0 to 4"), (99, "0 to 4")])
@pytest.mark.parametrize("part", [lambda n: Membrane([[0, 1, n]], FABRIC), lambda n: Cable([[0, n]], 1e6)])
def test_cell_with_a_node_that_does_not_exist(part, bad, exist):
    with pytest.raises(ValueError, match=f"^Part 'p', cell 0, names node {bad}.*not exist.*{exist}"):
        Structure(POINTS, {"p": part(bad)})


@pytest.mark.parametrize("third", [[2.0, 0, 0], [0.3, 0, 0], [1, 0, 0], [0.5, 1e-14, 0]])
@pytest.mark.parametrize("scale", [1e-3, 1, 1e4])
def test_triangle_without_area(third, scale):
    points = scale * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], third])
    with pytest.raises(ValueError, match=r"^Part 'fabric', cell 1 \(nodes \[0, 1, 3\]\) has no area"):
        sheet(points=points, cells=[[0, 1, 2], [0, 1, 3]])


@pytest.mark.parametrize("kind", [Cable, Mast])
def test_segment_without_length(kind):
    points = [[0.0, 0, 0], [1, 0, 0], [1, 0, 0]]
    with pytest.raises(ValueError, match=r"^Part 'bars', cell 1 \(nodes \[1, 2\]\) has no length"):
        Structure(points, {"bars": kind([[0, 1], [1, 2]], 1e6)})


# Warp


@pytest.mark.parametrize("warp", [(0.0, 0.0, 2.0), (0.0, 0.0, 0.0), [(1.0, 0, 0), (0.0, 0, 1)]])
def test_warp_normal_to_a_cell(warp):
    with pytest.raises(ValueError, match=r"^Part 'fabric', cell [01].*warp \[0\.0, 0\.0, .\.0\].*zero.*normal"):
        sheet(warp=warp)


def test_warp_is_projected_on_the_cell():
    assert sheet(warp=(3.0, 4.0, 100.0)).warp("fabric") == pytest.approx(np.tile([0.6, 0.8, 0], (2, 1)))


def test_default_warp_is_x_or_else_y():
    points = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    structure = sheet(points=points, cells=[[0, 1, 2], [0, 2, 3]])
    assert structure.warp("fabric").tolist() == [[1, 0, 0], [0, 1, 0]]


# Normals


OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)])
FACES = np.array([[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]])


@pytest.mark.parametrize("seed", range(4))
def test_normals_of_a_closed_surface_are_all_on_the_side_of_the_first(seed):
    flip = np.random.default_rng(seed).random(8) < 0.5
    cells = np.where(flip[:, None], FACES[:, ::-1], FACES)
    outwards = np.sign(OCTAHEDRON[FACES].mean(axis=1)) / np.sqrt(3)
    sign = -1.0 if flip[0] else 1.0
    assert sheet(points=OCTAHEDRON, cells=cells).normals("fabric") == pytest.approx(sign * outwards, abs=1e-14)


def test_one_sense_is_found_when_the_structure_is_made(monkeypatch):
    made = sheet(points=OCTAHEDRON, cells=FACES)
    monkeypatch.setattr("fx_membrane.model.parts.with_one_side", None)
    assert made.normals("fabric").shape == (8, 3)


def test_branching_membrane_has_no_normals():
    points = [[0.0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [0, 0, 1]]
    cells = [[0, 2, 1], [2, 1, 3], [0, 1, 4], [0, 1, 5]]  # three sheets on the edge 0 1
    with pytest.raises(ValueError, match=r"^Part 'fabric' branches.*edge between nodes 0 and 1"):
        sheet(points=points, cells=cells).normals("fabric")


def test_one_sided_membrane_has_no_normals():
    points = np.random.default_rng(1).normal(size=(5, 3))
    strip = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]  # the shortest Moebius strip
    structure = sheet(points=points, cells=strip)  # is allowed
    with pytest.raises(ValueError, match=r"^Part 'fabric'.*one side.*Moebius strip"):
        structure.normals("fabric")
    assert structure.parts["fabric"].cells.tolist() == strip


def test_cells_are_turned_to_the_sense_of_the_first():
    structure = sheet(cells=[[0, 2, 1], [0, 2, 3]])  # the first seen from below, the second from above
    assert structure.parts["fabric"].cells.tolist() == [[0, 2, 1], [0, 3, 2]]
    assert structure.normals("fabric").tolist() == [[0, 0, -1], [0, 0, -1]]


@pytest.mark.parametrize("ask", ["normals", "warp"])
@pytest.mark.parametrize("name", ["roof", "cable", 3])
def test_only_membranes_have_normals(ask, name):
    parts = {"fabric": Membrane(TRIANGLES, FABRIC), "cable": Cable([[0, 1]], 1e6)}
    with pytest.raises(ValueError, match=rf"^No Membrane.*{name!r}.*structure.*\['fabric'\]"):
        getattr(Structure(POINTS, parts), ask)(name)


# Supports and structures


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        (5, "^Support 0 names node 5.*not exist"),
        ([0, -1], "^Support 0 names node -1.*not exist"),
        ([0, 4], r"^Support 0.*node 4.*no part uses.*\(5, 5, 5\); mend"),
    ],
)
def test_support_on_a_bad_node(nodes, message):
    with pytest.raises(ValueError, match=message):
        sheet([Support(nodes)])


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([True, False, True], r"^Support nodes must be .* not \[True, False, True\]; .* numpy.flatnonzero"),
        (np.nan, "^Support nodes.*list.*whole numbers, not nan"),
        ([0, np.inf], r"^Support nodes.*list.*whole numbers.*\[0, inf\]"),
        ([[0, 1]], r"^Support nodes must be .* not \[\[0, 1\]\]"),
    ],
)
def test_support_nodes_must_be_numbers(nodes, message):
    with pytest.raises(ValueError, match=message):
        Support(nodes)


@pytest.mark.parametrize("components", ["xw", "", "zz", 3])
def test_support_components(components):
    with pytest.raises(ValueError, match=f"^Support components is {components!r}"):
        Support(0, components)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (np.where(np.arange(5)[:, None] == 2, np.nan, POINTS), r"^points has .* not finite \(nan\) at index \(2, 0\)"),
        (np.where(np.arange(5)[:, None] == 4, np.inf, POINTS), r"^points has .* not finite \(inf\) at index \(4, 0\)"),
        (POINTS[:, :2], r"^points has shape \(5, 2\); give \(n, 3\)"),
        (POINTS.ravel(), r"^points has shape \(15,\)"),
    ],
)
def test_bad_points(points, message):
    with pytest.raises(ValueError, match=message):
        sheet(points=points)


def test_structure_without_parts():
    with pytest.raises(ValueError, match=r"^The structure.*no parts"):
        Structure(POINTS, {})


def test_part_that_is_none():
    with pytest.raises(ValueError, match=r"^Part 'fabric' is 5; give a Membrane or Cable or Mast"):
        Structure(POINTS, {"fabric": 5})


def test_used_and_supported():
    structure = sheet([Support(0), Support([1, 3], "z"), Support(3, "x")])
    assert structure.used.tolist() == [True, True, True, True, False]
    expected = np.zeros((5, 3), dtype=bool)
    expected[0] = expected[[1, 3], 2] = expected[3, 0] = True
    assert structure.supported.tolist() == expected.tolist()


def test_structure_does_not_change_with_the_arrays_it_was_made_of():
    points, cells = POINTS.copy(), np.array(TRIANGLES)
    structure = sheet(points=points, cells=cells)
    points[:], cells[:] = 0, 0
    assert structure.points.tolist() == POINTS.tolist()
    assert structure.parts["fabric"].cells.tolist() == TRIANGLES


# Objects of another kind


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"supports": Support(0)}, "^supports.*list.*Support.*Support\\(.*brackets"),
        ({"supports": [0, 1]}, "^supports.*0.*list.*Support"),
        ({"parts": [1]}, "^parts.*list.*dictionary"),
        (
            {"points": np.zeros((2, 3), dtype=complex)},
            "^points.*array.*numbers.*\\[\\[0j, 0j, 0j\\]",
        ),
    ],
)
def test_objects_of_another_kind(arguments, message):
    good = {"points": [[0, 0, 0], [0, 0, 1.0]], "parts": {"cable": Cable([[0, 1]], 1.0)}, "supports": []}
    with pytest.raises(ValueError, match=message):
        Structure(**(good | arguments))
