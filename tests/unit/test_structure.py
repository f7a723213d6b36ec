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
    with pytest.raises(ValueError, match=f"^Part 'p' names node {bad}, which does not exist; .* {exist}"):
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
    [(2e11, 0, "^area is 0; "), (2e11, -1e-4, r"^area is -0\.0001; "), (-2e11, -1e-4, "^E is -2"), (0, 1, "^E is 0; ")],
)
def test_modulus_and_area_must_be_positive(kind, E, area, message):
    with pytest.raises(ValueError, match=message):
        kind.from_modulus([[0, 1]], E, area)


def test_bar_from_modulus():
    mast = Mast.from_modulus([[0, 1]], 2e11, 1e-4, prestress=-5.0)
    assert isinstance(mast, Mast)
    assert (mast.axial_stiffness, mast.prestress_tensors().item()) == (2e7, -5)


@pytest.mark.parametrize("material", [None, 1e5, {"Et": 1e5}])
def test_material_must_be_a_fabric(material):
    with pytest.raises(ValueError, match=r"^Membrane material is ") as error:
        Membrane(TRIANGLES, material)
    assert repr(material) in str(error.value)


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


# Supports and structures


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        (5, "^A support names node 5, which does not exist"),
        ([0, -1], "^A support names node -1, which does not exist"),
        ([0, 4], "^A support is on node 4, which no part uses"),
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
    with pytest.raises(ValueError, match=r"^Part 'fabric' is 5; give a Membrane, Cable or Mast"):
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
