"""Pieces of cloth: areas with allowances, marks that match across seams, copies, names and warp arrow."""

import numpy as np
import pytest

from cone_gores import FAR, NEAR, SINE, cone_gores
from cushions import cushion
from fx_membrane import Allowances, cut_pieces, cut_strips, cutting_pattern, planar_cut
from fx_membrane.patterns.cloth_pieces import PieceSide, _words_along
from fx_membrane.patterns.seam_marks import beside

pytest.importorskip("shapely.creation")  # of shapely 2
shapely = pytest.importorskip("shapely")


@pytest.fixture(scope="module")
def pattern():
    return cone_gores(12, across=16)


def test_areas_of_gores(pattern):
    pieces = cut_pieces(pattern)
    turn = 2 * np.pi / 12 * SINE
    assert len(pieces) == 12
    for piece in pieces.values():
        assert piece.sewn_area == pytest.approx(0.5 * turn * (FAR**2 - NEAR**2), rel=1e-4)
        # Wider by .02 beside the seams, by .05 at both arcs, and mitred at four corners.
        added = 2 * 0.02 * (FAR - NEAR) + 0.05 * turn * (FAR + NEAR) + 4 * 0.02 * 0.05
        assert piece.cut_area - piece.sewn_area == pytest.approx(added, rel=1e-3)


def test_single_edges_and_pockets_have_their_widths(pattern):
    given = Allowances(seam=0.0, border=0.0, pocket=0.1, edges={"base 1": 0.3})
    first, second = list(cut_pieces(pattern, given).values())[:2]
    assert [side.allowance for side in first.sides] == [0.3, 0.0, 0.1, 0.0]
    assert [side.allowance for side in second.sides] == [0.0, 0.0, 0.1, 0.0]


def test_edges_have_the_width_of_their_line(pattern):
    """The name of a cable stands for all edges along it; that of an edge goes first."""
    line = next(edge.line for edge in pattern.strips.edges if edge.line)
    given = Allowances(seam=0.0, border=0.0, pocket=0.1, edges={line: 0.2, "ring 2": 0.3})
    widths = {edge.name: given.of(edge) for edge in pattern.strips.edges}
    alongside = [edge.name for edge in pattern.strips.edges if edge.line == line]
    assert len(alongside) > 1
    assert {name for name, width in widths.items() if width > 0} == {*alongside, "ring 2"}
    assert {widths[name] for name in alongside if name != "ring 2"} == {0.2}
    assert widths["ring 2"] == 0.3
    with pytest.raises(ValueError, match=rf"edges\['{line}'\] is 9, more than half"):
        cut_pieces(pattern, Allowances(edges={line: 9.0}))


def test_marks_stand_at_the_same_points_of_both_strips(pattern):
    """The distance of a mark from the ends of its seam is the same on both pieces."""
    pieces = cut_pieces(pattern, mark_spacing=0.5)
    count = round(5 * np.sqrt(2) / 0.5) - 1
    places = {name: {} for name in pieces}
    for name, piece in pieces.items():
        for mark in piece.marks:
            places[name][mark.edge, mark.number] = np.linalg.norm(mark.line[0])  # from the apex of the cone
    for gore in range(1, 13):
        here, there = places[f"gore {gore}"], places[f"gore {(gore - 2) % 12 + 1}"]
        shared = here.keys() & there.keys()
        assert len(shared) == count
        for key in shared:
            assert here[key] == pytest.approx(there[key], rel=1e-12)
            assert here[key] == pytest.approx(FAR - key[1] * (FAR - NEAR) / (count + 1), rel=1e-12)


def test_marks_run_from_the_sewing_line_to_the_cut_line(pattern):
    piece = cut_pieces(pattern)["gore 5"]
    sewing, cut = shapely.LinearRing(piece.sewing), shapely.LinearRing(piece.cut)
    for mark in piece.marks:
        assert sewing.distance(shapely.Point(mark.line[0])) < 1e-9
        assert cut.distance(shapely.Point(mark.line[1])) < 1e-7


def test_names_of_neighbours_and_of_parts_along_edges(pattern):
    piece = cut_pieces(pattern)["gore 1"]
    assert [(side.edge, side.beside) for side in piece.sides] == [
        ("base 1", ""),
        ("seam 2", "gore 2"),
        ("ring 1", "ring"),
        ("seam 1", "gore 12"),
    ]
    words = [label.words for label in piece.labels]
    assert words[:5] == ["gore 1", "base 1", "seam 2 / gore 2", "ring 1 / ring", "seam 1 / gore 12"]
    outline = shapely.Polygon(piece.sewing)
    assert all(outline.contains(shapely.Point(label.place)) for label in piece.labels)


def test_warp_arrow_is_along_the_warp_inside(pattern):
    for piece in cut_pieces(pattern).values():
        assert piece.warp[1, 0] > piece.warp[0, 0]
        assert piece.warp[1, 1] == piece.warp[0, 1]
        assert shapely.Polygon(piece.sewing).contains(shapely.LineString(piece.warp))


def test_copies_are_one_piece():
    pieces = cut_pieces(cone_gores(6, copies=True))
    assert list(pieces) == ["gore 1"]
    assert pieces["gore 1"].copies == tuple(f"gore {number}" for number in range(1, 7))
    assert pieces["gore 1"].labels[0].words == "gore 1 (6 times)"


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"seam": -0.1}, "seam.*-0.1"),
        ({"edges": {"seam 1": -1.0}}, "'seam 1'"),
        ({"corners": "round"}, "mitre"),
        ({"mitre_limit": 0.5}, "0.5.*at least 1"),
    ],
)
def test_wrong_allowances_are_refused(given, words):
    with pytest.raises(ValueError, match=words):
        Allowances(**given)


def test_allowance_of_no_edge_is_refused(pattern):
    with pytest.raises(ValueError, match=r"'seam 99'.*there are seam 1"):
        cut_pieces(pattern, Allowances(edges={"seam 99": 0.1}))


def test_spacing_of_marks_in_another_unit_is_refused(pattern):
    with pytest.raises(ValueError, match=r"mark_spacing is 1e-09: \d+ marks along 'seam .*'.*; enlarge it"):
        cut_pieces(pattern, mark_spacing=1e-9)


def test_spacing_of_marks_beyond_the_seam_leaves_none(pattern):
    assert not cut_pieces(pattern, mark_spacing=100.0)["gore 1"].marks


@pytest.mark.parametrize("parted", [False, True])
def test_corners_of_the_rim_of_a_cushion_are_marked(parted):
    """A rim is one seam of both films around its corners; whole films have it closed, without an end."""
    films = cushion(6)
    strips = cut_strips(films, planar_cut(films, (0, 0, 0), (0, 1, 0)) if parted else [])
    pattern = cutting_pattern(strips)
    pieces = cut_pieces(pattern, mark_spacing=0.3)
    for edge in strips.edges:
        if set(edge.strips) in ({"top 1", "top 2"}, {"bottom 1", "bottom 2"}):
            continue
        corners = [node for node in edge.nodes[: None if parted else -1] if np.abs(films.points[node, :2]).min() == 1]
        assert len(corners) == (2 if parted else 4)
        numbers = []
        for name in edge.strips:
            flat, marks = pattern.cloth[name], [mark for mark in pieces[name].marks if mark.edge == edge.name]
            starts = np.array([mark.line[0] for mark in marks])
            away = [np.linalg.norm(starts - flat.points[flat.nodes == node], axis=1) for node in corners]
            assert max(found.min() for found in away) < 1e-9
            numbers.append([marks[int(found.argmin())].number for found in away])
            spacing = np.linalg.norm(np.diff(starts, axis=0), axis=1)
            assert spacing.max() < 1.3 * 0.3
        assert numbers[0] == numbers[1]


@pytest.mark.parametrize(("length", "angle"), [(3.0, -90.0), (0.5, 0.0)])
def test_name_of_a_short_edge_goes_into_the_piece(length, angle):
    """The edge is at the right end of a piece, across the warp; thirteen letters take 1.2 m."""
    side = PieceSide("ring 1", "ring", np.array([(0.0, 0.0), (0.0, length)]), 0.1)
    label = _words_along(side, 0.1)
    assert label.angle == pytest.approx(angle)
    assert label.place[1] == pytest.approx(length / 2)
    reach = 0.5 * 1.17 if angle == 0 else 0.05
    assert label.place[0] + reach < 0
    np.testing.assert_allclose(label.outside, [(0.1, length / 2), (1, 0)])


def test_mark_at_a_corner_halves_its_angle():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)])
    half = np.sqrt(0.5)
    np.testing.assert_allclose(beside(square, 1.0)[1], (half, -half))
    np.testing.assert_allclose(beside(square, 0.0)[1], (0, -1))
    for station in (0.0, 4.0):
        np.testing.assert_allclose(beside(square, station, closed=True), [(0, 0), (-half, -half)])
    np.testing.assert_allclose(beside(square, 1.5), [(1, 0.5), (1, 0)])
