"""Axes, length scale and windows: true lengths, units, ticks."""

import matplotlib.figure
import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, Structure, rectangle
from fx_membrane.plot import scene, windows
from fx_membrane.plot.dimensions import box_of, draw_axes, draw_scale, round_length
from fx_membrane.plot.shown import shown

POINTS = np.array([(0, 0, 0), (4, 0, 0), (4, 3, 0), (0, 3, 2.0)])


def drawn(view, points=POINTS, unit="m"):
    """Texts and lines of axes and scale."""
    axes = matplotlib.figure.Figure().subplots()
    box = box_of([points])
    window = windows.window_of([box], view)
    axes.set_xlim(window.low[0], window.high[0])
    axes.set_ylim(window.low[1], window.high[1])
    draw_axes(axes, window, box, unit)
    draw_scale(axes, window, unit)
    return {text.get_text(): text.get_position() for text in axes.texts}, axes, window


@pytest.mark.parametrize(
    ("view", "names"),
    [((0, 0, 1), "xy"), ((0, -1, 0), "xz"), ((1, 0, 0), "yz"), ((1, -1.6, 1.1), "xyz"), ((-1, 1, -1), "xyz")],
)
def test_axes_that_are_seen_have_names_with_units(view, names):
    texts, _, _ = drawn(view, unit="mm")
    assert {f"{name} [mm]" for name in names} == {text for text in texts if "[" in text}


def test_ticks_are_where_their_values_are():
    texts, _, window = drawn((0, 0, 1))
    assert texts["4"][0] == pytest.approx(4)
    assert texts["2"][0] == pytest.approx(2) or texts["2"][1] == pytest.approx(2)
    assert window.extent == pytest.approx((-0.08, 4.08, -0.08, 3.08))


@pytest.mark.parametrize("size", [1e-3, 1.0, 37.0, 4e4])
@pytest.mark.parametrize("view", [(0, 0, 1), (1, -1.6, 1.1)])
def test_length_scale_is_true(size, view):
    texts, axes, _ = drawn(view, POINTS * size)
    (label,) = (text for text in texts if text.endswith(" m"))
    bar = next(line for line in axes.lines if line.get_linewidth() > 2)
    assert np.ptp(bar.get_xdata()) == pytest.approx(float(label[:-2]))


@pytest.mark.parametrize(
    ("most", "length"), [(1, 1), (1.99, 1), (2, 2), (4.9, 2), (50, 50), (0.07, 0.05), (99, 50), (3e4, 2e4)]
)
def test_round_lengths(most, length):
    assert round_length(most) == pytest.approx(length)


@pytest.mark.parametrize("unit", [1.0, 1e3])
def test_pixels_have_a_known_length(unit, monkeypatch):
    """A square of 2 by 1 in plan fills the pixels that the window says."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 400)
    points, triangles = rectangle(2.0 * unit, 1.0 * unit, 4, 2)
    subject = shown("a test", Structure(points, {"sheet": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}))
    image = scene.picture(subject, None, None, scale=1.0, view=(0, 0, 1), mirror=None, antisymmetric=False)
    window = windows.window_of([points], (0, 0, 1))
    assert image.shape[1::-1] == window.pixels
    ink = np.argwhere((image < 250).any(axis=2))
    height, width = np.ptp(ink, axis=0) + 1
    metres = (window.high[0] - window.low[0]) / image.shape[1]
    assert width * metres == pytest.approx(2 * unit, rel=0.01)
    assert height * metres == pytest.approx(1 * unit, rel=0.02)


def test_windows_have_their_mirror_images():
    shapes = windows.mirrored(POINTS, "x")
    assert windows.window_of(shapes, (0, 0, 1)).extent == pytest.approx((-4.16, 4.16, -0.16, 3.16))
    assert windows.mirrored(POINTS, None) == [POINTS]
