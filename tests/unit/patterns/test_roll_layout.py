"""Layout on the roll: within its width, no piece on another, as often as cut, with the waste that it has."""

import numpy as np
import pytest

from cone_gores import cone_gores
from fx_membrane import Allowances, cut_pieces, laid_on_roll
from fx_membrane.patterns.cloth_pieces import Piece

pytest.importorskip("shapely.creation")  # of shapely 2
shapely = pytest.importorskip("shapely")


def rectangle(name, length, width, copies=1):
    outline = np.array([(0, 0), (length, 0), (length, width), (0, width)], dtype=float)
    names = (name, *(f"{name} copy {number}" for number in range(1, copies)))
    return Piece(name, names, frozenset(), outline, outline, (), (), outline[:2], ())


def check(pieces, layout):
    """Refuse pieces on each other, beyond the roll, or turned off the warp."""
    placed = [(entry, shapely.Polygon(entry.moved(pieces[entry.piece].cut))) for entry in layout.placements]
    low = np.array([polygon.bounds for _, polygon in placed]).min(axis=0)
    high = np.array([polygon.bounds for _, polygon in placed]).max(axis=0)
    assert low[0] >= -1e-9
    assert low[1] >= -1e-9
    assert high[2] <= layout.length + 1e-9
    assert high[3] <= layout.width + 1e-9
    for number, (_, one) in enumerate(placed):
        for _, other in placed[number + 1 :]:
            assert one.intersection(other).area < 1e-9
    cut = sum(polygon.area for _, polygon in placed)
    assert layout.cut_area == pytest.approx(cut)
    assert layout.waste == pytest.approx(1 - cut / (layout.width * layout.length))
    assert sorted(entry.strip for entry in layout.placements) == sorted(
        name for piece in pieces.values() for name in piece.copies
    )


def test_narrow_strips_lie_beside_each_other():
    pieces = {"a": rectangle("a", 10.0, 1.0, copies=4), "b": rectangle("b", 4.0, 0.9)}
    layout = laid_on_roll(pieces, 2.05, gap=0.02)
    check(pieces, layout)
    assert layout.length == pytest.approx(10 + 10 + 4 + 2 * 0.02)


def test_no_gap_fills_the_roll():
    pieces = {"a": rectangle("a", 3.0, 0.5, copies=8)}
    layout = laid_on_roll(pieces, 2.0, gap=0.0)
    check(pieces, layout)
    assert layout.length == 6.0
    assert layout.waste == pytest.approx(0.0, abs=1e-12)


def test_tapered_strips_lie_head_to_tail():
    pieces = cut_pieces(cone_gores(12, copies=True), Allowances(0.0, 0.0))
    layout = laid_on_roll(pieces, 6.3)
    check(pieces, layout)
    assert {entry.turned for entry in layout.placements} == {False, True}
    width = pieces["gore 1"].width
    assert layout.width < 2 * width  # two of them beside each other unturned would not fit
    assert layout.length == pytest.approx(6 * pieces["gore 1"].length + 5 * 0.01)


def test_random_pieces():
    generator = np.random.default_rng(8)
    for _ in range(10):
        pieces = {}
        for number in range(12):
            corners = generator.uniform(0, 1, (8, 2)) * generator.uniform((1, 0.2), (8, 1.5))
            hull = np.asarray(shapely.convex_hull(shapely.MultiPoint(corners)).exterior.coords)[:-1]
            hull = hull if shapely.LinearRing(hull).is_ccw else hull[::-1]
            name = f"p{number}"
            pieces[name] = Piece(name, (name,), frozenset(), hull, hull, (), (), hull[:2], ())
        check(pieces, laid_on_roll(pieces, generator.uniform(1.5, 4)))


def test_strip_wider_than_the_roll_is_refused():
    pieces = {"a": rectangle("a", 3.0, 0.5), "wide one": rectangle("wide one", 2.0, 3.25)}
    with pytest.raises(ValueError, match=r"is 3, and 1 of 2 pieces.*'wide one' with 3.25.*narrower strips"):
        laid_on_roll(pieces, 3.0)


def test_piece_as_wide_as_the_roll_fits():
    pieces = {"a": rectangle("a", 3.0, 2.0)}
    assert laid_on_roll(pieces, 2.0).waste == pytest.approx(0.0, abs=1e-12)


def test_no_pieces_are_refused():
    with pytest.raises(ValueError, match="empty"):
        laid_on_roll({}, 2.0)


def test_mirrored_copies_are_turned_over():
    """A triangle with a right angle: its mirror image is no turned copy."""
    corners = np.array([(0, 0), (3, 0), (3, 1)], dtype=float)
    piece = Piece("a", ("a", "b", "c"), frozenset({"b"}), corners, corners, (), (), corners[:2], ())
    layout = laid_on_roll({"a": piece}, 1.2)
    check({"a": piece}, layout)
    senses = {}
    for entry in layout.placements:
        x, y = entry.moved(corners).T
        senses[entry.strip] = np.sign(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    assert senses == {"a": 1, "b": -1, "c": 1}
