"""Water on surfaces with known depressions: depth exact at nodes, area and volume at second order.

A paraboloid bowl z = (x^2 + y^2) / (2 R) in a square of half side a spills over the middles of its sides: depth
a^2 / (2 R), area pi a^2, volume pi a^4 / (4 R). Two bowls side by side spill into each other while the saddle between
them is below the rim, and are one depression then; their depths follow from the heights of rim and saddle.
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
