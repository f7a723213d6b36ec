"""Checks of user input: accepted and refused values, and the name and value in the message."""

import re
from enum import Enum
from typing import Protocol

import numpy as np
import pytest

import fx_membrane
from fx_membrane import Cable, DistributedLoad, Mast
from fx_membrane.checks import validation
from fx_membrane.checks.array_entries import ODD, equal_rows


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.nan, "^Et is nan.*finite number"),
        (-np.inf, "^Et is -inf.*finite number"),
        ("stiff", "^Et is the text 'stiff'; give a number"),
        (None, "^Et.*number.*None"),
        (True, "^Et.*number.*True"),
        ([1.0, 2.0], r"^Et.*number.*\[1.0, 2.0\]"),
    ],
)
def test_number_refuses(value, message):
    with pytest.raises(ValueError, match=message):
        validation.number("Et", value)


def test_not_negative():
    with pytest.raises(ValueError, match=r"^mass is -0\.5.*negative"):
        validation.not_negative("mass", -0.5)
    assert validation.not_negative("mass", 0) == 0


@pytest.mark.parametrize("value", [0, -1.5, -1e-300])
def test_positive_refuses(value):
    with pytest.raises(ValueError, match=f"^area is {value}.*positive"):
        validation.positive("area", value)


def test_positive_returns_a_float():
    result = validation.positive("area", np.int64(3))
    assert type(result) is float
    assert result == 3


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([[0, 1], [2, np.nan]], r"^points.*value.*not finite \(nan\).*index \(1, 1\)"),
        ([np.inf, 0], r"^points.*value.*not finite \(inf\).*index \(0,\)"),
        (np.nan, r"^points.*value.*not finite \(nan\)"),
        ([[0, 1], [2]], "^points.*array.*numbers.*rows.*equal length"),
        ("abc", "^points.*array.*numbers.*'abc'"),
        (None, "^points.*array.*numbers.*None"),
    ],
)
def test_finite_refuses(value, message):
    with pytest.raises(ValueError, match=message):
        validation.finite("points", value)


def test_finite_copies_and_freezes():
    given = np.zeros(3)
    result = validation.finite("points", given)
    given[0] = 1
    assert result[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        result[0] = 2


@pytest.mark.parametrize("value", [1.0, [1, 2], [[1, 2, 3]], [1, 2, 3, 4]])
def test_vector_refuses_other_shapes(value):
    with pytest.raises(ValueError, match=rf"^force is {re.escape(repr(value))}; give three components \(x, y, z\)"):
        validation.vector("force", value)


def test_direction_refuses_zero():
    with pytest.raises(ValueError, match=r"^view is \[0, 0, 0\]; give a direction"):
        validation.direction("view", [0, 0, 0])


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (3.5, "3.5"),
        (np.float64(3.5), "3.5"),
        (np.array([1.0, 2.0]), "[1.0, 2.0]"),
        ("text", "'text'"),
        (dict, "the class dict"),
        (list(range(100)), "a list of 100 entries"),
        (np.zeros((100, 2)), "an array of float64, shape (100, 2)"),
        (DistributedLoad((0, 0, -1), "fabric", range(9)), "a DistributedLoad"),
    ],
)
def test_short_values_are_shown_and_long_ones_described(value, text):
    assert validation.short_repr(value) == text


@pytest.mark.parametrize(
    ("value", "expected"),
    [(4, [4]), ([4, 5], [4, 5]), (range(2), [0, 1]), (np.array([7], dtype=np.uint8), [7])],
)
def test_rows(value, expected):
    result = validation.indices("nodes", value)
    assert result.dtype == np.int64
    assert result.tolist() == expected


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ([True, False], r"^nodes.*list.*whole numbers.*\[True, False\]; turn.*mask .*flatnonzero"),
        ([1.0, 2.0], r"^nodes.*list.*whole numbers.*\[1\.0, 2\.0\]"),
        (3.5, r"^nodes.*list.*whole numbers.*3\.5\."),
        (np.nan, "^nodes.*list.*whole numbers, not nan"),
        ([[1, 2]], r"^nodes.*list.*whole numbers.*\[\[1, 2\]\]"),
        ([[1, 2], [3]], r"^nodes.*list.*whole numbers.*\[\[1, 2\], \[3\]\]"),
        (None, "^nodes.*list.*whole numbers.*None"),
    ],
)
def test_rows_refuse(value, message):
    with pytest.raises(ValueError, match=message):
        validation.indices("nodes", value)


def test_distinct_refuses_a_number_twice():
    assert validation.unique_indices("cells", [5, 3], "cell").tolist() == [5, 3]
    with pytest.raises(ValueError, match=r"^cells names cell 3 twice; name.*once.*add.*second load"):
        validation.unique_indices("cells", [5, 3, 7, 3], "cell")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (None, r"^cells must be .*, not None"),
        ([[0, 1, 2], [3]], r"^cells must be .*, not \[\[0, 1, 2\], \[3\]\]"),
        ([[0, 1]], r"^cells must be .* shape \(n, 3\) .*, not int64 of shape \(1, 2\)"),
        ([0, 1, 2], r"^cells must be .* not int64 of shape \(3,\)"),
        (np.empty((0, 3), dtype=int), r"^cells must be .* with n >= 1, not int64 of shape \(0, 3\)"),
        ([[0.0, 1.0, 2.0]], r"^cells.*array.*whole numbers.*\[\[0\.0, 1\.0, 2\.0\]\]"),
        (np.ones((2, 3), dtype=bool), "^cells.*array.*whole numbers.*not bool"),
        ([[0, 1, 2], [3, 4, 3]], r"^cells: cell 1.*node twice, \[3, 4, 3\]"),
        ([[4, 5, 6], [0, 1, 2], [1, 3, 2], [2, 0, 1]], r"^cells: cells 1 and 3 have the same nodes, \[0, 1, 2\]"),
    ],
)
def test_cells_refuse(value, message):
    with pytest.raises(ValueError, match=message):
        validation.cells("cells", value, 3)


def test_cells_with_equal_sums_are_distinct():
    """Sums of rows find those that may be equal."""
    odd = int(ODD.view(np.int64))
    assert equal_rows(np.array([[0, 1], [odd, 0]])) is None
    assert equal_rows(np.array([[0, 1], [odd, 0], [5, 5], [odd, 0]])) == (1, 3)


def test_cells_are_copied_and_frozen():
    given = np.array([[0, 1, 2]])
    result = validation.cells("cells", given, 3)
    given[0, 0] = 9
    assert result.tolist() == [[0, 1, 2]]
    assert not result.flags.writeable


@pytest.mark.parametrize("bad", [-1, 3, 100])
def test_in_range_refuses(bad):
    with pytest.raises(ValueError, match=f"^A support names node {bad}.*not exist.*0 to 2"):
        validation.in_range("A support", np.array([0, bad]), 3, "node")


def test_in_range_accepts_first_and_last():
    validation.in_range("A support", np.array([0, 2]), 3, "node")


@pytest.mark.parametrize(("value", "expected"), [("xyz", (0, 1, 2)), ("z", (2,)), ("zx", (2, 0))])
def test_components(value, expected):
    assert validation.components("components", value) == expected


@pytest.mark.parametrize("value", ["", "xx", "w", "XY", "x y", 2, None, ["x"]])
def test_components_refuse(value):
    with pytest.raises(ValueError, match=r"^components is ") as error:
        validation.components("components", value)
    assert repr(value) in str(error.value)


def test_unique_refuses_a_name_given_twice():
    validation.unique("Stage", ["a", "b"])
    with pytest.raises(ValueError, match=r"^Stage 'a' is given twice"):
        validation.unique("Stage", ["a", "b", "a"])


@pytest.mark.parametrize("value", [0, -1, 2.0, np.nan, "2", None, True])
def test_whole_refuses(value):
    with pytest.raises(ValueError, match=f"^steps is {value!r}.*whole number above zero"):
        validation.positive_integer("steps", value)


def test_whole_accepts_a_number_of_numpy():
    assert validation.positive_integer("steps", np.int32(4)) == 4


# Names


PUBLIC = [getattr(fx_membrane, name) for name in fx_membrane.__all__]


NOT_CALLED = (dict, Enum, Protocol)


@pytest.mark.parametrize(
    "public", [entry for entry in PUBLIC if isinstance(entry, type) and not set(NOT_CALLED) & set(entry.__mro__)]
)
def test_wrong_arguments_are_refused_under_the_public_name(public):
    with pytest.raises(TypeError, match=f"^{public.__name__}\\b"):
        public(no_such_argument=0)


@pytest.mark.parametrize("kind", [Cable, Mast])
def test_missing_modulus_is_refused_under_a_public_name(kind):
    with pytest.raises(TypeError, match=r"^[A-Z].* 'E' and 'area'$"):
        kind.from_modulus([[0, 1]])


def test_rounding_of_places_is_told_as_zero():
    assert validation.format_point(np.array([-8.8e-17, 1e-3, 0.5])) == "(0, 0.001, 0.5)"
    assert validation.format_point(np.array([1e-17, 0.0, -2e-17])) == "(0, 0, 0)"  # all of it is rounding
    assert validation.format_point(np.array([2e-9, 0.0, -1e-8])) == "(2e-09, 0, -1e-08)"
    assert validation.format_point(np.zeros(3)) == "(0, 0, 0)"
