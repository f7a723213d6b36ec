"""Roof to draw, and the content of its pictures."""

import numpy as np
import pytest

from fx_membrane import rectangle

image = pytest.importorskip("matplotlib.image")

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
POINTS = np.vstack([POINTS, [[0, 0, -0.8]]])
HALF = np.flatnonzero(POINTS[TRIANGLES].mean(axis=1)[:, 1] < 0)
FOOT, CENTRE = 25, 12


def picture(path):
    """Colours of a PNG, in [0, 1], shape (height, width, 3)."""
    assert path.read_bytes().startswith(b"\x89PNG")
    return image.imread(path)[:, :, :3]


def count_colours(pixels, shades):
    """Count distinct colours, of a number of shades in each channel."""
    red, green, blue = np.moveaxis((pixels * (shades - 1)).round().astype(int), -1, 0)
    return np.count_nonzero(np.bincount(((red * shades + green) * shades + blue).ravel()))


def assert_drawn(path, colours=10):
    """Check for a picture on white with enough content in many colours; return its width over its height."""
    pixels = picture(path)
    height, width, _ = pixels.shape
    assert 300 < height < 3000
    assert 300 < width < 6000
    ink = (pixels < 0.95).any(axis=2)
    assert ink.mean() > 0.01
    rows, columns = np.flatnonzero(ink.any(axis=1)), np.flatnonzero(ink.any(axis=0))
    assert rows[-1] - rows[0] > 0.6 * height
    assert columns[-1] - columns[0] > 0.6 * width
    assert count_colours(pixels, 16) > colours
    return width / height


def has_colour(path, colour):
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    return (np.abs(picture(path) - wanted).max(axis=2) < 0.01).any()
