"""Parts, supports and structures: what they hold, and which input they refuse."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, OrthotropicFabric, Structure, Support

FABRIC = Fabric(Et=1e5, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=2e5, Et_weft=1e5, nu=0.2, Gt=1e4)
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]])  # no part uses the last one
TRIANGLES = [[0, 1, 2], [0, 2, 3]]


def sheet(supports=(), points=POINTS, cells=TRIANGLES, **data):
    return Structure(points, {"fabric": Membrane(cells, FABRIC, **data)}, supports)


# Cells


@pytest.mark.parametrize(("bad", "exist"), [(-1, "0 to 4"), (5, "0 to 4"), (99, "0 to 4")])
@pytest.mark.parametrize("part", [lambda n: Membrane([[0, 1, n]], FABRIC), lambda n: Cable([[0, n]], 1e6)])
def test_cell_with_a_node_that_does_not_exist(part, bad, exist):
    with pytest.raises(ValueError, match=f"^Part 'p', cell 0, names node {bad}, which does not exist; .* {exist}"):
        Structure(POINTS, {"p": part(bad)})


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Membrane([[0, 1, 2], [1, 2, 1]], FABRIC), r"^Membrane cells: cell 1 has a node twice, \[1, 2, 1\]"),
        (lambda: Cable([[3, 3]], 1e6), r"^Cable cells: cell 0 has a node twice, \[3, 3\]"),
        (lambda: Mast([[3, 3]], 1e6), r"^Mast cells: cell 0 has a node twice, \[3, 3\]"),
        (lambda: Membrane([[0, 1]], FABRIC), r"^Membrane cells must be .*\(n, 3\).* shape \(1, 2\)"),
        (lambda: Cable([[0, 1, 2]], 1e6), r"^Cable cells must be .*\(n, 2\).* shape \(1, 3\)"),
        (lambda: Mast([[0.0, 1.0]], 1e6), "^Mast cells must be an array of whole numbers .* not float64"),
    ],
)
def test_bad_cells(make, message):
    with pytest.raises(ValueError, match=message):
        make()


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


# Stiffness


@pytest.mark.parametrize("kind", [Cable, Mast])
@pytest.mark.parametrize("value", [0, -1e6, np.nan, np.inf])
def test_axial_stiffness_must_be_positive(kind, value):
    with pytest.raises(ValueError, match=f"^{kind.__name__} axial_stiffness is {value}; "):
        kind([[0, 1]], value)


@pytest.mark.parametrize("kind", [Cable, Mast])
@pytest.mark.parametrize(
    ("E", "area", "message"),
    [(2e11, 0, "area is 0; "), (2e11, -1e-4, r"area is -0\.0001; "), (-2e11, -1e-4, "E is -2"), (0, 1, "E is 0; ")],
)
def test_modulus_and_area_must_be_positive(kind, E, area, message):
    with pytest.raises(ValueError, match=message):
        kind.from_modulus([[0, 1]], E, area)


def test_bar_from_modulus():
    mast = Mast.from_modulus([[0, 1]], 2e11, 1e-4, prestress=-5.0)
    assert isinstance(mast, Mast)
    assert (mast.axial_stiffness, mast.prestress_tensors().item()) == (2e7, -5)
    assert mast.mass == 0
    assert Cable.from_modulus([[0, 1]], 2e11, 1e-4, density=7850.0).mass == pytest.approx(0.785)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda value: Membrane(TRIANGLES, FABRIC, mass=value), "Membrane mass"),
        (lambda value: Cable([[0, 1]], 1e6, mass=value), "Cable mass"),
        (lambda value: Mast([[0, 1]], 1e6, mass=value), "Mast mass"),
        (lambda value: Mast.from_modulus([[0, 1]], 2e11, 1e-4, density=value), "Mast density"),
    ],
)
def test_mass_must_not_be_negative(make, message):
    with pytest.raises(ValueError, match=rf"^{message} is -1e-09; it must not be negative"):
        make(-1e-9)
    with pytest.raises(ValueError, match=f"^{message} is nan"):
        make(np.nan)


@pytest.mark.parametrize("material", [None, 1e5, {"Et": 1e5}])
def test_material_must_be_a_fabric(material):
    kind = type(material).__name__
    with pytest.raises(ValueError, match=f"^Membrane material is of type {kind}; give a Fabric or OrthotropicFabric"):
        Membrane(TRIANGLES, material)


# Prestress and warp

TRIANGLES3 = [[0, 1, 2], [0, 2, 3], [1, 2, 3]]  # three cells: no shape of a prestress is ambiguous
PER_CELL = np.array([[1.0, 2], [3, 4], [5, 6]])


@pytest.mark.parametrize(
    ("prestress", "expected"),
    [
        (7.0, [np.diag([7, 7])] * 3),
        ((7.0, 8.0), [np.diag([7, 8])] * 3),
        ([[7.0, 1.0], [1.0, 8.0]], [[[7, 1], [1, 8]]] * 3),
        (PER_CELL[:, :1], [np.diag([1, 1]), np.diag([3, 3]), np.diag([5, 5])]),
        (PER_CELL, [np.diag([1, 2]), np.diag([3, 4]), np.diag([5, 6])]),
        (np.arange(3)[:, None, None] * np.ones((2, 2)), [np.full((2, 2), i) for i in range(3)]),
    ],
)
def test_membrane_prestress(prestress, expected):
    membrane = Membrane(TRIANGLES3, FABRIC, prestress=prestress, warp=(1, 0, 0))
    assert membrane.prestress_tensors().tolist() == np.asarray(expected, dtype=float).tolist()


def test_two_by_two_prestress_is_one_tensor_also_for_two_cells():
    membrane = Membrane(TRIANGLES, FABRIC, prestress=[[7.0, 1.0], [1.0, 8.0]], warp=(1, 0, 0))
    assert membrane.prestress_tensors()[1].tolist() == [[7, 1], [1, 8]]


@pytest.mark.parametrize(
    ("prestress", "message"),
    [
        (np.nan, r"^Membrane prestress has a value that is not finite \(nan\)"),
        ((1.0, np.inf), r"^Membrane prestress has a value that is not finite \(inf\) at index \(1,\)"),
        ((1.0, 2.0, 3.0), r"^Membrane prestress has shape \(3,\)"),
        (np.ones((2, 3)), r"^Membrane prestress has shape \(2, 3\)"),
        ([[1.0, 2.0], [3.0, 4.0]], "^Membrane prestress is not symmetric"),
    ],
)
def test_bad_membrane_prestress(prestress, message):
    with pytest.raises(ValueError, match=message):
        Membrane(TRIANGLES3, FABRIC, prestress=prestress, warp=(1, 0, 0))


@pytest.mark.parametrize(("prestress", "expected"), [(3.0, [3, 3]), ([3.0, -4.0], [3, -4])])
def test_bar_prestress(prestress, expected):
    assert Cable([[0, 1], [1, 2]], 1e6, prestress).prestress_tensors().ravel().tolist() == expected


@pytest.mark.parametrize(
    ("prestress", "message"),
    [
        (np.inf, r"^Mast prestress has a value that is not finite \(inf\)"),
        ([1.0, 2.0, 3.0], r"^Mast prestress has shape \(3,\); .* each of the 2 cells"),
        ([[1.0], [2.0]], r"^Mast prestress has shape \(2, 1\)"),
    ],
)
def test_bad_bar_prestress(prestress, message):
    with pytest.raises(ValueError, match=message):
        Mast([[0, 1], [1, 2]], 1e6, prestress)


@pytest.mark.parametrize("data", [{"prestress": (1.0, 2.0)}, {"prestress": [[1.0, 1], [1, 1]]}, {"material": WOVEN}])
def test_what_has_a_direction_needs_a_warp(data):
    with pytest.raises(ValueError, match="give the warp as a vector"):
        Membrane(**{"cells": TRIANGLES, "material": FABRIC, **data})


@pytest.mark.parametrize(
    ("warp", "message"),
    [
        ((1.0, 0.0), r"^Membrane warp has shape \(2,\); give \(3,\) or \(2, 3\)"),
        (np.ones((3, 3)), r"^Membrane warp has shape \(3, 3\)"),
        ((1.0, np.nan, 0.0), r"^Membrane warp has a value that is not finite \(nan\)"),
    ],
)
def test_bad_warp(warp, message):
    with pytest.raises(ValueError, match=message):
        Membrane(TRIANGLES, WOVEN, warp=warp)


@pytest.mark.parametrize("warp", [(0.0, 0.0, 2.0), (0.0, 0.0, 0.0), [(1.0, 0, 0), (0.0, 0, 1)]])
def test_warp_normal_to_a_cell(warp):
    with pytest.raises(ValueError, match=r"^Part 'fabric', cell [01]: its warp \[0\.0, 0\.0, .\.0\] is zero or normal"):
        sheet(warp=warp)


def test_warp_is_projected_on_the_cell():
    assert sheet(warp=(3.0, 4.0, 100.0)).warp("fabric") == pytest.approx(np.tile([0.6, 0.8, 0], (2, 1)))


def test_default_warp_is_x_or_else_y():
    points = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    structure = sheet(points=points, cells=[[0, 1, 2], [0, 2, 3]])
    assert structure.warp("fabric").tolist() == [[1, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("name", "make"),
    [
        ("Membrane", lambda value: Membrane(TRIANGLES, FABRIC, compression_stiffness=value)),
        ("Cable", lambda value: Cable([[0, 1]], 1e6, compression_stiffness=value)),
    ],
)
@pytest.mark.parametrize(
    ("value", "message"),
    [
        (0, "is 0; it must be positive"),
        (-1e-4, r"is -0\.0001; it must be positive"),
        (1.5, r"is 1\.5; it must be at most 1"),
        (np.nan, "is nan; give a finite number"),
        ("soft", "is the text 'soft'; give a number"),
    ],
)
def test_compression_stiffness_out_of_range(name, make, value, message):
    with pytest.raises(ValueError, match=f"^{name} compression_stiffness {message}"):
        make(value)


@pytest.mark.parametrize("value", [1e-12, 1])
def test_compression_stiffness_in_range(value):
    assert Membrane(TRIANGLES, FABRIC, compression_stiffness=value).compression_stiffness == value
    assert Cable([[0, 1]], 1e6, compression_stiffness=value).compression_stiffness == value


def test_masts_have_no_compression_stiffness():
    with pytest.raises(TypeError):
        Mast([[0, 1]], 1e6, compression_stiffness=0.5)


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


def test_branching_membrane_has_no_normals():
    points = [[0.0, 0, 0], [0, 1, 0], [1, 0, 0], [1, 1, 0], [-1, 0, 0], [0, 0, 1]]
    cells = [[0, 2, 1], [2, 1, 3], [0, 1, 4], [0, 1, 5]]  # three sheets on the edge 0 1
    with pytest.raises(ValueError, match=r"^Part 'fabric' branches at the edge between nodes 0 and 1"):
        sheet(points=points, cells=cells).normals("fabric")


def test_one_sided_membrane_has_no_normals():
    points = np.random.default_rng(1).normal(size=(5, 3))
    strip = [[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]]  # the shortest Moebius strip
    structure = sheet(points=points, cells=strip)
    with pytest.raises(ValueError, match=r"^Part 'fabric' has only one side, like a Moebius strip"):
        structure.normals("fabric")


# Supports and structures


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        (5, "^Support 0 names node 5, which does not exist"),
        ([0, -1], "^Support 0 names node -1, which does not exist"),
        ([0, 4], "^Support 0 is on node 4, which no part uses"),
    ],
)
def test_support_on_a_bad_node(nodes, message):
    with pytest.raises(ValueError, match=message):
        sheet([Support(nodes)])


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([True, False, False, True, False], "^Support nodes must be .* not bool .* numpy.flatnonzero"),
        (np.nan, "^Support nodes must be a list of whole numbers, not float64"),
        ([0, np.inf], "^Support nodes must be a list of whole numbers, not float64"),
        ([[0, 1]], r"^Support nodes must be .* shape \(1, 2\)"),
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
    with pytest.raises(ValueError, match=r"^The structure has no parts"):
        Structure(POINTS, {})


def test_part_that_is_none():
    with pytest.raises(ValueError, match=r"^Part 'fabric' is of type int; give a Membrane or Cable or Mast"):
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


@pytest.mark.parametrize(
    "make",
    [
        lambda data: Membrane(TRIANGLES3, FABRIC, prestress=data),
        lambda data: Cable([[0, 1], [1, 2], [2, 3]], 1e6, data[:, 0]),
        lambda data: Mast([[0, 1], [1, 2], [2, 3]], 1e6, data[:, 0]),
    ],
)
def test_prestress_does_not_change_with_the_array_it_was_made_of(make):
    data = np.ones((3, 1))
    part = make(data)
    data[:] = np.nan
    assert part.prestress_tensors().max() == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"supports": Support(0)}, "supports must be a list of Support, not Support; put it in brackets"),
        ({"supports": [0, 1]}, "supports has 0; give a list of Support"),
        ({"parts": [1]}, "parts is a list; give a dictionary"),
        ({"points": np.zeros((2, 3), dtype=complex)}, "points must be an array of numbers"),
    ],
)
def test_objects_of_another_kind(arguments, message):
    good = {"points": [[0, 0, 0], [0, 0, 1.0]], "parts": {"cable": Cable([[0, 1]], 1.0)}, "supports": []}
    with pytest.raises(ValueError, match=message):
        Structure(**(good | arguments))
