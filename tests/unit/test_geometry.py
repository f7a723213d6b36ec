"""Ready-made grids, edges, areas, lengths and normals."""

import numpy as np
import pytest

from fx_membrane import boundary, rectangle
from fx_membrane.geometry import measures, normals

DIAGONALS = ["right", "left", "to centre"]


@pytest.mark.parametrize("diagonals", DIAGONALS)
def test_rectangle_is_covered_once_with_normals_up(diagonals):
    points, triangles = rectangle(3.0, 2.0, 5, 4, diagonals)
    assert points.shape == (30, 3)
    assert triangles.shape == (40, 3)
    assert measures(points, triangles) == pytest.approx(3.0 * 2.0 / 40)
    assert normals(points, triangles) == pytest.approx(np.tile([0, 0, 1], (40, 1)))
    # Signed areas of the same size add up to the whole only if no two triangles overlap and none is missing.
    centres = points[triangles].mean(axis=1)
    assert len(np.unique(centres.round(9), axis=0)) == 40


def test_rectangle_numbers_nodes_row_by_row_from_the_lower_left():
    points, _ = rectangle(4.0, 2.0, 4, 2)
    assert points[0].tolist() == [-2, -1, 0]
    assert points[4].tolist() == [2, -1, 0]
    assert points[5 * 1 + 3].tolist() == [1, 0, 0]
    assert points[14].tolist() == [2, 1, 0]


@pytest.mark.parametrize(
    ("diagonals", "expected"),
    [
        ("right", [{0, 4}, {1, 5}, {3, 7}, {4, 8}]),
        ("left", [{1, 3}, {2, 4}, {4, 6}, {5, 7}]),
        ("to centre", [{0, 4}, {2, 4}, {4, 6}, {4, 8}]),
    ],
)
def test_diagonals(diagonals, expected):
    points, triangles = rectangle(2.0, 2.0, 2, 2, diagonals)
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    slanted = edges[measures(points, edges) > 1.1]
    assert {frozenset(edge) for edge in slanted.tolist()} == {frozenset(edge) for edge in expected}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"width": 0}, "^width is 0; it must be positive"),
        ({"height": -2.0}, r"^height is -2\.0; it must be positive"),
        ({"height": np.nan}, "^height is nan; give a finite number"),
        ({"columns": 0}, "^columns is 0; give a whole number above zero"),
        ({"rows": -1}, "^rows is -1; give a whole number above zero"),
        ({"diagonals": "up"}, "^diagonals is 'up'; give "),
    ],
)
def test_rectangle_refuses(change, message):
    with pytest.raises(ValueError, match=message):
        rectangle(**{"width": 1.0, "height": 1.0, "columns": 2, "rows": 2, **change})


@pytest.mark.parametrize("name", ["columns", "rows"])
def test_rectangle_refuses_numbers_of_cells_that_are_not_whole(name):
    with pytest.raises(ValueError, match=rf"^{name} is 2\.5; give a whole number"):
        rectangle(**{"width": 1.0, "height": 1.0, "columns": 2, "rows": 2, name: 2.5})


@pytest.mark.parametrize("diagonals", DIAGONALS)
def test_boundary_runs_once_around_counter_clockwise(diagonals):
    points, triangles = rectangle(3.0, 2.0, 3, 4, diagonals)
    edges = boundary(triangles)
    assert len(edges) == 2 * (3 + 4)
    assert np.unique(edges[:, 0], return_counts=True)[1].tolist() == [1] * 14
    (x0, y0), (x1, y1) = points[edges[:, 0], :2].T, points[edges[:, 1], :2].T
    assert np.sum(x0 * y1 - x1 * y0) / 2 == pytest.approx(6.0)


def test_boundary_of_a_sheet_with_a_hole():
    points, triangles = rectangle(3.0, 3.0, 3, 3)
    outside = np.abs(points[triangles].mean(axis=1)[:, :2]).max(axis=1) > 0.5
    assert len(boundary(triangles[outside])) == 12 + 4


def test_measures_and_normals_in_space():
    points = np.array([[1.0, 1, 1], [1, 3, 1], [1, 1, 4]])
    assert measures(points, np.array([[0, 1], [1, 2]])) == pytest.approx([2, np.sqrt(13)])
    assert measures(points, np.array([[0, 1, 2]])) == pytest.approx([3])
    assert normals(points, np.array([[0, 1, 2], [0, 2, 1]])) == pytest.approx(np.array([[1, 0, 0], [-1, 0, 0]]))
