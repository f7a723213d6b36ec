"""Water on surfaces with known depressions: depth exact at nodes, area and volume at second order.

A paraboloid bowl z = (x^2 + y^2) / (2 R) in a square of half side a spills over the middles of its sides: depth
a^2 / (2 R), area pi a^2, volume pi a^4 / (4 R). Two bowls side by side spill into each other while the saddle between
them is below the rim, and are one depression then; their depths follow from the heights of rim and saddle. Valleys and
gutters have the slope of their bottom, which is exact on flat planes.
"""

import numpy as np
import pytest

from fx_membrane import drainage, rectangle

SOURCE = "volume of a paraboloid"

A, R = 1.5, 4.0


def bowl(n):
    points, triangles = rectangle(2 * A, 2 * A, n, n)
    points[:, 2] = (points[:, 0] ** 2 + points[:, 1] ** 2) / (2 * R)
    return drainage((points, triangles))


def test_bowl(verified):
    errors = []
    for n in (16, 32, 64):
        (pond,) = bowl(n).depressions
        assert pond.depth == pytest.approx(A**2 / (2 * R), rel=1e-14)
        errors.append((pond.area / (np.pi * A**2) - 1, pond.volume / (np.pi * A**4 / (4 * R)) - 1))
    order = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    assert (order > 1.9).all(), order
    assert np.abs(errors[-1]).max() < 2e-3
    verified("volume of a pond [m3]", np.pi * A**4 / (4 * R), pond.volume, order[-1, 1])


def test_slope_of_the_bowl():
    """Least in the cells around its lowest node: that of the plane through three of their corners."""
    found = bowl(32)
    h = 2 * A / 32
    assert found.least_slope == pytest.approx(np.sqrt(2) * h / (2 * R), rel=1e-12)
    assert np.linalg.norm(found.place[:2]) < h


def two_bowls(distance, n=80):
    """Two pits at x = -distance and distance, the second higher by 0.02; a saddle between them at x near 0."""
    points, triangles = rectangle(4.0, 2.0, 2 * n, n)
    x, y, _ = points.T
    points[:, 2] = np.minimum((x + distance) ** 2 + y**2, (x - distance) ** 2 + y**2 + 0.02)
    return points, drainage((points, triangles)).depressions


def test_two_ponds_merge():
    """With the saddle below the rim, of height 1 at y = 1, there is one depression of both."""
    points, ponds = two_bowls(0.5)
    (pond,) = ponds
    np.testing.assert_allclose(points[pond.pits], [[-0.5, 0, 0], [0.5, 0, 0.02]], rtol=0, atol=1e-12)
    assert pond.depth == pytest.approx(1.0, rel=1e-12)
    assert pond.level == pytest.approx(1.0, rel=1e-12)


def test_two_ponds_apart():
    """With the saddle above the rim, here of height (2 - distance)^2 at the ends, there are two."""
    points, ponds = two_bowls(1.2)
    assert [pond.pits.size for pond in ponds] == [1, 1]
    np.testing.assert_allclose([pond.depth for pond in ponds], 0.64, rtol=1e-12)
    np.testing.assert_allclose([points[pond.node, 0] for pond in ponds], [-1.2, 1.2], rtol=1e-12)
    areas = [pond.area for pond in ponds]
    np.testing.assert_allclose(areas, np.pi * 0.64, rtol=5e-3)


def test_hypar_drains_over_two_low_corners():
    for n in (8, 33):
        points, triangles = rectangle(6.0, 6.0, n, n)
        points[:, 2] = points[:, 0] * points[:, 1] / 9.0
        found = drainage((points, triangles))
        assert found.drains
        assert found.least_slope < 6.0 / n / 9.0 * (1 + 1e-12)


@pytest.mark.parametrize("fall", [0.0, 0.02])
@pytest.mark.parametrize("unit", [1.0, 1e3])
@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_valley_between_two_planes(fall, unit, turn):
    """z = |x| / 2 + fall y: water of both planes runs along y, by that slope; at a ridge it runs apart."""
    flat, triangles = rectangle(4.0, 3.0, 8, 6)
    flat[:, 2] = np.abs(flat[:, 0]) / 2 + fall * flat[:, 1]
    across, along = np.array([np.cos(turn), np.sin(turn), 0]), np.array([-np.sin(turn), np.cos(turn), 0])
    points = unit * flat @ [across, along, (0, 0, 1)]
    found = drainage((points, triangles))
    bottom = np.flatnonzero(flat[:, 0] == 0)
    assert found.valleys.tolist() == np.stack([bottom[:-1], bottom[1:]], axis=1).tolist()
    np.testing.assert_allclose(found.valley_slope, fall, rtol=1e-9, atol=1e-12)
    assert found.least_slope == pytest.approx(np.hypot(0.5, fall), rel=1e-12)
    assert found.drains
    assert ("a level valley" in str(found)) == (fall == 0)
    assert len(drainage((points * [1, 1, -1], triangles)).valleys) == 0


def test_gutter_at_a_wall():
    """A plane that falls by 50 % to a wall, and by 2 % along it to an open corner."""
    points, triangles = rectangle(4.0, 3.0, 8, 6)
    points[:, 2] = points @ [0.5, 0.02, 0]
    wall = np.flatnonzero((points[:, 0] == -2) & (points[:, 1] > -1.5))
    found = drainage((points, triangles), walls=wall)
    assert found.drains
    assert len(found.valleys) == 5
    np.testing.assert_allclose(found.valley_slope, 0.02, rtol=1e-12)


def test_valley_of_a_smooth_surface():
    """z = x^2 + y / 10 has its valley along x = 0, with a slope of 10 %."""
    points, triangles = rectangle(2.0, 2.0, 32, 32)
    points[:, 2] = points[:, 0] ** 2 + points[:, 1] / 10
    found = drainage((points, triangles))
    assert found.least_valley_slope == pytest.approx(0.1, rel=1e-9)
    assert np.abs(points[found.valleys, 0]).max() == 0
