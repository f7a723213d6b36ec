"""Grids, edges, areas, lengths and normals."""

import numpy as np
import pytest
from scipy.sparse.csgraph import connected_components

from fx_membrane import boundary_edges, polyline, rectangle
from fx_membrane.geometry.sizes import measures, normals
from fx_membrane.geometry.topology import (
    boundary_cells,
    connected,
    from_smallest,
    node_graph,
    orientation,
    with_one_sense,
)

DIAGONALS = ["right", "left", "to centre"]


@pytest.mark.parametrize("diagonals", DIAGONALS)
def test_rectangle_is_covered_once_with_normals_up(diagonals):
    points, triangles = rectangle(3.0, 2.0, 5, 4, diagonals)
    assert points.shape == (30, 3)
    assert triangles.shape == (40, 3)
    assert measures(points, triangles) == pytest.approx(3.0 * 2.0 / 40)
    assert normals(points, triangles) == pytest.approx(np.tile([0, 0, 1], (40, 1)))
    # Signed areas of one size add up to the whole only if no triangles overlap and none is missing.
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
        ({"width": 0}, "^width is 0.*positive"),
        ({"height": -2.0}, r"^height is -2\.0.*positive"),
        ({"height": np.nan}, "^height is nan.*finite number"),
        ({"columns": 0}, "^columns is 0.*whole number above zero"),
        ({"rows": -1}, "^rows is -1.*whole number above zero"),
        ({"diagonals": "up"}, "^diagonals is 'up'; give "),
    ],
)
def test_rectangle_refuses(change, message):
    with pytest.raises(ValueError, match=message):
        rectangle(**{"width": 1.0, "height": 1.0, "columns": 2, "rows": 2, **change})


@pytest.mark.parametrize("name", ["columns", "rows"])
def test_rectangle_refuses_numbers_of_cells_that_are_not_whole(name):
    with pytest.raises(ValueError, match=rf"^{name} is 2\.5.*whole number"):
        rectangle(**{"width": 1.0, "height": 1.0, "columns": 2, "rows": 2, name: 2.5})


@pytest.mark.parametrize("diagonals", DIAGONALS)
def test_boundary_runs_once_around_counter_clockwise(diagonals):
    points, triangles = rectangle(3.0, 2.0, 3, 4, diagonals)
    edges = boundary_edges(triangles)
    assert len(edges) == 2 * (3 + 4)
    assert np.unique(edges[:, 0], return_counts=True)[1].tolist() == [1] * 14
    (x0, y0), (x1, y1) = points[edges[:, 0], :2].T, points[edges[:, 1], :2].T
    assert np.sum(x0 * y1 - x1 * y0) / 2 == pytest.approx(6.0)


def test_boundary_of_a_list_and_of_what_is_none():
    assert boundary_edges([[0, 1, 2]]).tolist() == [[0, 1], [2, 0], [1, 2]]
    for wrong in (5, [[0, 1]], [[0.0, 1, 2]]):
        with pytest.raises(ValueError, match=r"^triangles.*array.*whole numbers.*shape \(n, 3\)"):
            boundary_edges(wrong)


def test_polyline_joins_consecutive_nodes():
    assert polyline([4, 7, 2, 4]).tolist() == [[4, 7], [7, 2], [2, 4]]


@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([3], r"^nodes is \[3\].*least two"),
        ([0.5, 1], r"^nodes.*list.*whole numbers.*\[0\.5, 1\]"),
    ],
)
def test_polyline_of_too_little(nodes, message):
    with pytest.raises(ValueError, match=message):
        polyline(nodes)


def test_boundary_of_a_sheet_with_a_hole():
    points, triangles = rectangle(3.0, 3.0, 3, 3)
    outside = np.abs(points[triangles].mean(axis=1)[:, :2]).max(axis=1) > 0.5
    assert len(boundary_edges(triangles[outside])) == 12 + 4


def test_measures_and_normals_in_space():
    points = np.array([[1.0, 1, 1], [1, 3, 1], [1, 1, 4]])
    assert measures(points, np.array([[0, 1], [1, 2]])) == pytest.approx([2, np.sqrt(13)])
    assert measures(points, np.array([[0, 1, 2]])) == pytest.approx([3])
    assert normals(points, np.array([[0, 1, 2], [0, 2, 1]])) == pytest.approx(np.array([[1, 0, 0], [-1, 0, 0]]))


# One sense for all triangles of a piece

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
OCTAHEDRON = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)  # nodes 0 to 5 on +x, -x, +y, -y, +z, -z; all triangles seen from outside


def flipped(triangles, seed):
    """Triangles, some in the other sense, and the sign of each."""
    signs = np.random.default_rng(seed).choice([1.0, -1.0], size=len(triangles))
    return np.where(signs[:, None] > 0, triangles, triangles[:, ::-1]), signs


@pytest.mark.parametrize("surface", [TETRAHEDRON, OCTAHEDRON, rectangle(1.0, 1.0, 5, 3)[1]])
@pytest.mark.parametrize("seed", range(5))
def test_orientation_undoes_flips(surface, seed):
    triangles, signs = flipped(surface, seed)
    assert orientation(triangles).tolist() == (signs * signs[0]).tolist()


def test_each_piece_follows_its_first_triangle():
    pieces = np.concatenate([OCTAHEDRON + 10, TETRAHEDRON])
    order = np.random.default_rng(1).permutation(len(pieces))
    triangles, signs = flipped(pieces[order], 2)
    found = orientation(triangles) * signs
    for piece in (order < 8, order >= 8):
        first = signs[piece][0]
        assert found[piece].tolist() == [first] * np.count_nonzero(piece)


def test_pieces_that_share_a_node_only_are_apart():
    triangles = np.array([[0, 1, 2], [0, 4, 3]])
    assert orientation(triangles).tolist() == [1, 1]


def test_three_sheets_on_one_edge_have_each_their_own_sense():
    # No sense of all three is consistent; none is requested.
    triangles = np.array([[0, 1, 2], [2, 3, 1], [0, 1, 4], [0, 1, 5], [5, 1, 6]])
    assert orientation(triangles).tolist() == [1, -1, 1, 1, 1]


def strip(n, turned):
    """Strip of n rectangles, closed with half a turn or without."""
    low, high = np.arange(n), n + np.arange(n)
    next_low, next_high = np.roll(low, -1), np.roll(high, -1)
    if turned:
        next_low[-1], next_high[-1] = high[0], low[0]
    return np.concatenate([np.stack([low, next_low, next_high], axis=1), np.stack([low, next_high, high], axis=1)])


@pytest.mark.parametrize("seed", range(3))
def test_moebius_strip_has_no_orientation(seed):
    assert orientation(flipped(strip(6, turned=True), seed)[0]) is None
    assert orientation(flipped(strip(6, turned=False), seed)[0]) is not None


def test_one_sided_piece_beside_another_is_found():
    assert orientation(np.concatenate([OCTAHEDRON + 50, strip(6, turned=True)])) is None


@pytest.mark.parametrize("seed", range(3))
def test_triangles_are_turned_about_their_first_node(seed):
    triangles, signs = flipped(OCTAHEDRON, seed)
    found, reason = with_one_sense(triangles)
    assert reason == ""
    assert found[:, 0].tolist() == triangles[:, 0].tolist()
    assert orientation(found).tolist() == [1] * 8
    kept = signs == signs[0]
    assert found[kept].tolist() == triangles[kept].tolist()


def test_cells_from_their_smallest_node():
    assert from_smallest(np.array([[3, 1, 2], [5, 6, 4], [0, 8, 7]])).tolist() == [[1, 2, 3], [4, 5, 6], [0, 8, 7]]
    assert from_smallest(np.array([[2, 1], [0, 5]])).tolist() == [[1, 2], [0, 5]]


@pytest.mark.parametrize("seed", range(5))
def test_pieces_are_those_of_the_node_graph_without_the_other_nodes(seed):
    random = np.random.default_rng(seed)
    triangles = np.array([random.choice(60, 3, replace=False) for _ in range(15)])
    bars = np.array([random.choice(60, 2, replace=False) for _ in range(10)])
    joining = random.random(60) < 0.7
    found = connected([triangles, bars], joining)
    graph = node_graph([triangles, bars], 60).tolil()
    graph[~joining], graph[:, ~joining] = 0, 0
    expected = connected_components(graph.tocsr(), directed=False)[1]
    assert len(found.nodes) == 60
    assert ((found.nodes[:, None] == found.nodes) == (expected[:, None] == expected)).all()
    for cells, pieces in zip([triangles, bars], found.cells, strict=True):
        for cell, piece in zip(cells, pieces, strict=True):
            assert set(found.nodes[cell[joining[cell]]]) <= {piece}
    assert len({*found.nodes, *found.cells[0], *found.cells[1]}) == found.pieces


@pytest.mark.parametrize("seed", range(3))
def test_boundary_cells_are_those_of_the_boundary_edges(seed):
    triangles = np.random.default_rng(seed).permutation(rectangle(2.0, 1.0, 5, 4)[1])
    edges, cells = boundary_edges(triangles), boundary_cells(triangles)
    assert len(edges) == len(cells)
    sides = np.stack([np.roll(triangles[cells], turned, axis=1)[:, :2] for turned in range(3)])
    assert (sides == edges).all(axis=2).any(axis=0).all()  # with the sense of their triangle


@pytest.mark.parametrize(("columns", "rows"), [(100_000_000, 1), (100_000_000, 16), (1, 100_000_000), (10_000, 10_000)])
def test_grid_of_too_many_cells_is_refused_before_it_takes_memory(columns, rows):
    with pytest.raises(ValueError, match=rf"columns is {columns} and rows is {rows}: too many cells"):
        rectangle(1.0, 1.0, columns, rows)
