"""Fields to draw: numbers and states are accepted, everything else is refused with its title."""

from decimal import Decimal
from types import SimpleNamespace

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, plot, rectangle
from fx_membrane.plot.fields import checked, checked_scale, smooth
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


FLAT, TRIANGLES = rectangle(4.0, 4.0, 8, 8)
WEST = FLAT[TRIANGLES].mean(axis=1)[:, 0] < 0
HALVES = {name: Membrane(TRIANGLES[cells], Fabric(1e5, 0.3)) for name, cells in (("west", WEST), ("east", ~WEST))}


def test_means_at_nodes():
    """They keep constants, give linear fields back inside, stay within the values, and jump from part to part."""
    constant = smooth(HALVES, FLAT, "title", {"west": np.full(64, 3.0), "east": np.full(64, 5.0)})
    assert np.allclose(constant["west"], 3.0)
    assert np.allclose(constant["east"], 5.0)
    heights = FLAT[HALVES["west"].cells].mean(axis=1)[:, 1]
    found = smooth(HALVES, FLAT, "title", {"west": heights})
    corners = FLAT[HALVES["west"].cells]
    inside = (np.abs(corners[:, :, 1]) < 1.9) & (np.abs(corners[:, :, 0] + 1) < 0.9)
    assert found["west"][inside] == pytest.approx(corners[inside][:, 1])
    assert heights.min() <= found["west"].min()
    assert found["west"].max() <= heights.max()


def test_means_weigh_by_area():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (-3, 0, 0)], dtype=float)
    pair = {"pair": Membrane([[0, 1, 2], [0, 2, 3]], Fabric(1e5, 0.3))}
    found = smooth(pair, points, "title", {"pair": np.array([4.0, 8.0])})["pair"]
    assert found == pytest.approx(np.array([[7, 4, 7], [7, 7, 8]]))


@pytest.mark.parametrize(
    ("field", "message"),
    [
        (np.zeros(81), "^smoothed names 'title', which has values at nodes already; leave it out"),
        ({"west": np.full(64, "taut")}, "^smoothed names 'title', which has states, which have no mean; leave it out"),
    ],
)
def test_means_of_others_are_refused(field, message):
    with pytest.raises(ValueError, match=message):
        smooth(HALVES, FLAT, "title", field)
