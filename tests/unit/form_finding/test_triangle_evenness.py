"""Evenness of triangles: its derivatives against differences, and its least value."""

import numpy as np

from fx_membrane.form_finding.nearest_stress import triangle_evenness
from fx_membrane.geometry.vector_columns import columns


def evenness_of(corners):
    """Evenness with the cells first."""
    found = triangle_evenness.evenness_of(columns(corners))
    return type(found)(*(np.moveaxis(values, -1, 0) for values in found))


def value(corners):
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    return np.sum(sides**2, axis=(1, 2)) / area


def test_derivatives():
    corners = np.random.default_rng(0).normal(size=(5, 3, 3))
    found = evenness_of(corners)
    for number in range(9):
        step = 1e-6 * np.eye(9)[number].reshape(3, 3)
        slope = (value(corners + step) - value(corners - step)) / 2e-6
        turn = (evenness_of(corners + step).slopes - evenness_of(corners - step).slopes) / 2e-6
        second = (found.convex + found.bent).reshape(5, 9, 9)[:, :, number]
        assert np.allclose(found.slopes.reshape(5, 9)[:, number], slope, rtol=1e-6, atol=1e-6)
        assert np.allclose(second, turn.reshape(5, 9), rtol=1e-6, atol=1e-6 * np.abs(second).max())
    assert np.linalg.eigvalsh(found.convex.reshape(5, 9, 9)).min() > -1e-10 * np.abs(found.convex).max()


def test_equal_sides_are_the_least():
    even = np.array([[[0, 0, 0], [1, 0, 0], [0.5, np.sqrt(0.75), 0]]])
    assert np.abs(evenness_of(even).slopes).max() < 1e-12
    moved = value(even + 0.1 * np.random.default_rng(1).normal(size=(20, 3, 3)))
    assert (moved > value(even)).all()
