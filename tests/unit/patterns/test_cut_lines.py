"""Cut lines: widths beyond straight and curved sides, mitres, straight cuts, and strips that have none."""

import numpy as np
import pytest

from fx_membrane.patterns.cut_lines import cut_line

pytest.importorskip("shapely.creation")  # of shapely 2
shapely = pytest.importorskip("shapely")

SQUARE = [
    np.array(side, dtype=float) for side in ([(0, 0), (1, 0)], [(1, 0), (1, 1)], [(1, 1), (0, 1)], [(0, 1), (0, 0)])
]


def area(outline):
    x, y = outline.T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def polygon(corners):
    corners = np.array(corners, dtype=float)
    return [np.array([corner, corners[(row + 1) % len(corners)]]) for row, corner in enumerate(corners)]


def test_square_with_mitred_corners():
    found = cut_line("s", SQUARE, [0.1] * 4, True, 1.5)
    assert area(found) == pytest.approx(1.44, abs=1e-8)
    assert len(found) == 4


def test_square_with_straight_corners():
    found = cut_line("s", SQUARE, [0.1] * 4, False, 1.5)
    assert area(found) == pytest.approx(1.44 - 4 * 0.5 * 0.1**2, abs=1e-8)
    assert len(found) == 8


def test_width_of_each_side_is_its_own():
    found = cut_line("s", SQUARE, [0.1, 0.02, 0.0, 0.05], True, 2.0)
    np.testing.assert_allclose(found.min(axis=0), (-0.05, -0.1), atol=1e-8)
    np.testing.assert_allclose(found.max(axis=0), (1.02, 1.0), atol=1e-8)
    assert area(found) == pytest.approx(1.07 * 1.1, abs=1e-8)


def test_no_allowance_is_the_sewing_line():
    assert area(cut_line("s", SQUARE, [0.0] * 4, True, 1.5)) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("limit", [1.0, 1.5, 3.0])
def test_sharp_corner_is_cut_at_the_limit(limit):
    """Corner of 20 degrees: a mitre would reach 5.8 widths."""
    half, width = np.radians(10.0), 0.1
    tip = (np.cos(half), 0.0)
    found = cut_line("s", polygon([tip, (0, np.sin(half)), (0, -np.sin(half))]), [width] * 3, True, limit)
    assert found[:, 0].max() - tip[0] == pytest.approx(limit * width, abs=1e-8)


def test_mitre_of_unequal_widths_and_a_narrow_one_beside_a_wide_one():
    """Two lines at 30 degrees: the cut line of the narrow side meets that of the wide one behind the corner."""
    turn = np.radians(30)
    corners = [(0, 0), (1, 0), (1 + np.cos(turn), np.sin(turn)), (0, 3)]
    found = shapely.Polygon(cut_line("s", polygon(corners), [0.2, 0.02, 0.0, 0.0], True, 1.5))
    inner = shapely.Polygon(corners)
    assert found.is_valid
    assert found.covers(inner.buffer(-1e-6))
    assert found.difference(inner.buffer(0.2 * 1.5 + 1e-6)).area < 1e-9


@pytest.mark.parametrize("sign", [1, -1])
def test_curved_side_is_moved_by_its_width(sign):
    """A quarter of a ring, radii 1 and 2; both arcs are moved apart, one convex and one hollow."""
    angle = np.linspace(0, np.pi / 2, 41)
    inner, outer = (radius * np.stack([np.cos(angle), np.sin(angle)], axis=1) for radius in (1.0, 2.0))
    sides = [outer, np.array([outer[-1], inner[-1]]), inner[::-1], np.array([inner[0], outer[0]])]
    found = cut_line("s", sides, [0.1, 0.0, 0.1, 0.0], True, 1.5)
    radius = np.linalg.norm(found, axis=1)
    assert radius.max() == pytest.approx(2.1, abs=1e-3)
    assert radius.min() == pytest.approx(0.9, abs=1e-3)
    exact = np.pi / 4 * (2.1**2 - 0.9**2)
    assert area(found) == pytest.approx(exact, rel=1e-3)


def test_strip_that_lies_on_itself_is_refused():
    with pytest.raises(ValueError, match=r"'roof 3' lies on itself.*seam"):
        cut_line("roof 3", polygon([(0, 0), (1, 1), (1, 0), (0, 1)]), [0.1] * 4, True, 1.5)


def test_allowances_that_meet_are_refused():
    """A notch that is wider inside than at its mouth, which the allowances close."""
    corners = [
        (0, 0),
        (4, 0),
        (4, 3),
        (2.1, 3),
        (2.1, 2),
        (2.8, 2),
        (2.8, 1),
        (1.2, 1),
        (1.2, 2),
        (1.9, 2),
        (1.9, 3),
        (0, 3),
    ]
    with pytest.raises(ValueError, match=r"'n'.*meet around .*smaller"):
        cut_line("n", polygon(corners), [0.15] * len(corners), True, 1.5)


def test_random_convex_polygons_have_the_area_of_their_offset():
    """Steiner: area + perimeter width + width^2 sum of tan(turn / 2), as long as no mitre is cut."""
    generator = np.random.default_rng(3)
    for _ in range(20):
        angle = np.sort(generator.uniform(0, 2 * np.pi, 12)) + 1e-3 * np.arange(12)
        corners = 3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        sides, width = polygon(corners), 0.07
        along = np.array([side[1] - side[0] for side in sides])
        turn = np.diff(np.unwrap(np.arctan2(*along.T[::-1])), append=np.arctan2(*along[0][::-1]) + 2 * np.pi)
        length = np.linalg.norm(along, axis=1).sum()
        wanted = area(corners) + width * length + width**2 * np.tan((turn % (2 * np.pi)) / 2).sum()
        assert area(cut_line("p", sides, [width] * 12, True, 1e6)) == pytest.approx(wanted, rel=1e-7)
