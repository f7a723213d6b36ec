"""Axes, length scale and windows: true lengths, units, ticks."""

import matplotlib.figure
import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, Structure, rectangle
from fx_membrane.plot import scene, windows
from fx_membrane.plot.dimensions import box_of, draw_axes, draw_scale, edges_of, round_length
from fx_membrane.plot.panels import Look, setting
from fx_membrane.plot.subjects import shown

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


@pytest.mark.parametrize(("rise", "told"), [(0.02, "z [m]\n0 to 0.02"), (0.0, "z [m]\n0")])
def test_shallow_structures_have_their_heights(rise, told):
    """An axis too short for ticks tells its ends: it was left out."""
    texts, axes, window = drawn((1, -1.6, 1.1), POINTS * [1, 1, rise / 2])
    assert told in texts
    assert texts[told][0] < window.seen(POINTS * [1, 1, 0])[:, 0].min()
    left = window.seen(POINTS)[:, 0].min()
    upright = [line for line in axes.lines if np.abs(np.asarray(line.get_xdata()) - left).max() < 1e-9]
    assert len(upright) == 1


def test_window_holds_structure_and_axes_without_empty_corners_of_the_box():
    """A tent with one high point: the top corners of its box are empty, and made half of the picture white."""
    points, triangles = rectangle(8.0, 8.0, 4, 4)
    points[12, 2] = 6.0
    subject = shown("a test", Structure(points, {"sheet": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}))
    same = setting([subject], [[]], Look(1.0, (1, -1.6, 1.1), axes=True))
    seen = same.window.seen(np.concatenate([points, *edges_of(same.box, (1, -1.6, 1.1)).values()]))
    room = windows.WINDOW_MARGIN * same.window.size
    assert same.window.high[1] == pytest.approx(seen[:, 1].max() + room, abs=0.1 * room)
    assert (seen >= same.window.low).all()
    assert (seen <= same.window.high).all()
