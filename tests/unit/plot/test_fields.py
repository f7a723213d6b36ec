"""Fields to draw: numbers and states are accepted, everything else is refused with its title."""

from decimal import Decimal
from types import SimpleNamespace

import numpy as np
import pytest

from fx_membrane import plot
from fx_membrane.plot.fields import checked, checked_scale
from models import MIXED

RESULT = SimpleNamespace(structure=MIXED)  # a check needs the structure of the result only
N = len(MIXED.points)


@pytest.mark.parametrize(
    "values",
    [range(N), [Decimal(1)] * N, np.arange(N) > 3, [True] * N, np.arange(N, dtype=np.float32), np.ma.arange(N)],
    ids=["range", "decimals", "truths", "list of truths", "float32", "nothing masked"],
)
def test_numbers_at_nodes(values):
    found = checked(RESULT, "title", values)
    assert type(found) is np.ndarray
    assert found.dtype == np.float64
    assert found.tolist() == [float(value) for value in values]


@pytest.mark.parametrize(
    "states", [["taut", "slack"], np.array(["taut", "slack"]), np.array(["taut", "slack"], dtype=object)]
)
def test_states_of_cells(states):
    assert checked(RESULT, "title", {"edge": states})["edge"].tolist() == ["taut", "slack"]


@pytest.mark.parametrize(
    ("field", "message"),
    [
        (np.full(N, 1 + 1j), "array.*numbers .*complex128"),
        ([1j] * N, "array.*numbers"),
        (np.ma.array(np.zeros(N), mask=np.arange(N) == 2), "has masked entries"),
        (["1"] + [2.0] * (N - 1), "array.*numbers"),
        (np.full(N, 3, "m8[s]"), "array.*numbers"),
        ([True] + [2.0] * (N - 1), "array.*numbers .*True"),
        (np.full(N, 1e300), r"has the value 1e\+300 at index \(0,\)"),
        ({"edge": [1.0, "taut"]}, "array.*numbers"),
        ({"edge": ["taut", "slack"], "mast": [1.0]}, "states.*parts.*numbers.*others"),
        ({3: [1.0]}, r"parts \[3\]"),
    ],
)
def test_others_are_refused(field, message):
    with pytest.raises(ValueError, match=f"^Field 'title'.*{message}"):
        checked(RESULT, "title", field)


@pytest.mark.mpi_once
@pytest.mark.parametrize(("given", "message"), [(None, "parts is None"), ({}, "parts is empty")])
def test_lines_of_nothing(tmp_path, given, message):
    with pytest.raises(ValueError, match=message):
        plot.wireframe(MIXED.points, given, tmp_path / "never.png")


@pytest.mark.parametrize("scale", [1e30, -1e30, 2.1e4])
def test_scale_that_leaves_no_shape(scale):
    result = SimpleNamespace(structure=MIXED, displacement=np.full(MIXED.points.shape, 1.0))
    with pytest.raises(ValueError, match=r"^scale is .*, with which .* give at most 2\.0e\+04 in size"):
        checked_scale(result, scale)
    assert checked_scale(result, Decimal(20000)) == 20000
    assert checked_scale(SimpleNamespace(structure=MIXED, displacement=np.zeros((N, 3))), scale) == scale
