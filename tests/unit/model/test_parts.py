"""Membranes, cables and masts: their data, and refused input."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, OrthotropicFabric

FABRIC = Fabric(Et=1e5, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=2e5, Et_weft=1e5, nu=0.2, Gt=1e4)
TRIANGLES = [[0, 1, 2], [0, 2, 3]]
TRIANGLES3 = [[0, 1, 2], [0, 2, 3], [1, 2, 3]]  # three cells: no shape of a prestress is ambiguous
PER_CELL = np.array([[1.0, 2], [3, 4], [5, 6]])


# Cells, stiffness, material


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Membrane([[0, 1, 2], [1, 2, 1]], FABRIC), r"^Membrane cells: cell 1.*node twice, \[1, 2, 1\]"),
        (lambda: Cable([[3, 3]], 1e6), r"^Cable cells: cell 0.*node twice, \[3, 3\]"),
        (lambda: Mast([[3, 3]], 1e6), r"^Mast cells: cell 0.*node twice, \[3, 3\]"),
        (lambda: Membrane([[0, 1]], FABRIC), r"^Membrane cells must be .*\(n, 3\).* shape \(1, 2\)"),
        (lambda: Cable([[0, 1, 2]], 1e6), r"^Cable cells must be .*\(n, 2\).* shape \(1, 3\)"),
        (lambda: Mast([[0.0, 1.0]], 1e6), r"^Mast cells.*array.*whole numbers.*\[\[0\.0, 1\.0\]\]"),
    ],
)
def test_bad_cells(make, message):
    with pytest.raises(ValueError, match=message):
        make()


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
    with pytest.raises(ValueError, match=f"^{kind.__name__} {message}"):
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
    with pytest.raises(ValueError, match=rf"^{message} is -1e-09.*negative"):
        make(-1e-9)
    with pytest.raises(ValueError, match=f"^{message} is nan"):
        make(np.nan)


@pytest.mark.parametrize("material", [None, 1e5, {"Et": 1e5}])
def test_material_must_be_a_fabric(material):
    with pytest.raises(ValueError, match=f"^Membrane material is {material}.*Fabric.*law.*your own"):
        Membrane(TRIANGLES, material)


# Prestress and warp


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
        (np.nan, r"^Membrane prestress.*value.*not finite \(nan\)"),
        ((1.0, np.inf), r"^Membrane prestress.*value.*not finite \(inf\).*index \(1,\)"),
        ((1.0, 2.0, 3.0), r"^Membrane prestress has shape \(3,\)"),
        (np.ones((2, 3)), r"^Membrane prestress has shape \(2, 3\)"),
        ([[1.0, 2.0], [3.0, 4.0]], r"^Membrane prestress \[\[1\.0, 2\.0\], \[3\.0, 4\.0\]\] is not symmetric"),
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
        (np.inf, r"^Mast prestress.*value.*not finite \(inf\)"),
        ([1.0, 2.0, 3.0], r"^Mast prestress has shape \(3,\); .* each of the 2 cells"),
        ([[1.0], [2.0]], r"^Mast prestress has shape \(2, 1\)"),
    ],
)
def test_bad_bar_prestress(prestress, message):
    with pytest.raises(ValueError, match=message):
        Mast([[0, 1], [1, 2]], 1e6, prestress)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"prestress": (1.0, 2.0)}, r"^Membrane prestress is \[1\.0, 2\.0\],"),
        ({"prestress": [[1.0, 1], [1, 1]]}, r"^Membrane prestress is \[\[1\.0, 1\.0\], \[1\.0, 1\.0\]\],"),
        ({"material": WOVEN}, "^Membrane material is an OrthotropicFabric,"),
    ],
)
def test_what_has_a_direction_needs_a_warp(data, message):
    with pytest.raises(ValueError, match=message + ".*warp.*weft.*warp.*vector"):
        Membrane(**{"cells": TRIANGLES, "material": FABRIC, **data})


@pytest.mark.parametrize(
    ("warp", "message"),
    [
        ((1.0, 0.0), r"^Membrane warp has shape \(2,\); give \(3,\) or \(2, 3\)"),
        (np.ones((3, 3)), r"^Membrane warp has shape \(3, 3\)"),
        ((1.0, np.nan, 0.0), r"^Membrane warp.*value.*not finite \(nan\)"),
    ],
)
def test_bad_warp(warp, message):
    with pytest.raises(ValueError, match=message):
        Membrane(TRIANGLES, WOVEN, warp=warp)


# Stiffness in compression


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
        (0, "is 0.*positive"),
        (-1e-4, r"is -0\.0001.*positive"),
        (1.5, r"is 1\.5.*1"),
        (np.nan, "is nan.*finite number"),
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
        Mast([[0, 1]], 1e6, compression_stiffness=0.5)  # type: ignore[call-arg]


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
