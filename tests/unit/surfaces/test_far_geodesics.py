"""Geodesics on surfaces far from the origin."""

import numpy as np
import pytest

from fx_membrane import geodesic, rectangle

pytest.importorskip("potpourri3d")


def test_geodesics_are_as_straight_far_from_the_origin():
    points, triangles = rectangle(6.0, 4.0, 12, 8)
    points[:, 2] = 2.0 * np.cos(points[:, 1] / 2)  # a vault along x
    far = np.array([1e5, 2e5, 0.0])
    ends = np.array([[0.7, -2.0, points[0, 2]], [0.7, 2.0, points[0, 2]]])
    near, away = (geodesic((points + by, triangles), *(ends + by)) for by in (0 * far, far))
    assert np.ptp(near.points[:, 0]) < 1e-6
    assert np.ptp(away.points[:, 0]) < 1e-6
    assert abs(away.length - near.length) < 1e-9
