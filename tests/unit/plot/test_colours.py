"""Colours: scales of forces, and numbers beside them that can be told apart."""

from itertools import combinations, pairwise

import numpy as np
import pytest

from fx_membrane import Cable, Structure, Support, polyline
from fx_membrane.plot.colour_scale import STATES, _texts, colour_bar
from fx_membrane.plot.field_panels import Options, panels_of
from fx_membrane.plot.figures import empty
from fx_membrane.plot.marks import COLOURED, PLAIN, border
from fx_membrane.plot.panels import Look, setting
from fx_membrane.plot.scene import FABRIC, Colours
from fx_membrane.plot.subjects import shown


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (0, 1, ["0", "0.25", "0.5", "0.75", "1"]),
        (-27400, 27400, ["-27400", "-13700", "0", "13700", "27400"]),
        (20000, 20001, ["20000", "20000.2", "20000.5", "20000.8", "20001"]),
        (2e9, 4e9, ["2e+09", "2.5e+09", "3e+09", "3.5e+09", "4e+09"]),
        (-0.0009, 3.4, ["0", "0.849", "1.7", "2.55", "3.4"]),
        (0, 0.0004, ["0", "0.0001", "0.0002", "0.0003", "0.0004"]),
    ],
)
def test_numbers_can_be_told_apart(low, high, texts):
    assert _texts(np.linspace(low, high, 5)) == texts


@pytest.mark.parametrize(
    ("values", "antisymmetric", "ends"),
    [
        ((0, 1), (), ("0", "1")),
        ((0, 2), (), ("0", "≥ 1")),
        ((-1, 1), (), ("≤ 0", "1")),
        ((-1, 2), (), ("≤ 0", "≥ 1")),
        ((0, 1), ("x",), ("≤ 0", "1")),
        ((-1e-12, 1 + 1e-12), (), ("0", "1")),
    ],
)
def test_ends_of_a_colour_bar_tell_if_values_lie_beyond_them(values, antisymmetric, ends):
    pytest.importorskip("matplotlib")
    options = Options(antisymmetric, {"x": (0.0, 1.0)}, ())
    panel = panels_of([{"x": np.array(values, dtype=float)}], options)[0][0]
    figure = empty(6.4, 4.8)
    colour_bar(figure, figure.subplots(), panel.colours, panel.outside)
    texts = [label.get_text() for label in figure.axes[1].get_xticklabels()]
    assert (texts[0], texts[-1]) == ends


def forces(*values):
    points = np.column_stack([np.arange(len(values) + 1.0), np.zeros((len(values) + 1, 2))])
    rope = Cable(polyline(range(len(points))), 1e6, prestress=values)
    subject = shown("a test", Structure(points, {"rope": rope}, [Support([0])]))
    return setting([subject], [[]], Look(1.0, (0, 0, 1), forces=True)).bars


def test_forces_that_are_even_have_one_colour():
    bars = forces(20000, 20000.5)
    assert bars.low < 19900
    assert bars.high > 20100
    assert bars.map == "plasma"


def test_forces_of_both_signs_have_all_colours_of_theirs():
    """One mast does not make all cables pale: either side of zero has a scale of its own, with true numbers."""
    bars = forces(1e3, -4e3)
    assert bars.map == "PuOr_r"
    places, values = bars.ticks(5)
    assert values.tolist() == [-4e3, -2e3, 0, 500, 1e3]
    assert bars.placed(values) == pytest.approx(places)
    assert (bars.placed(values[0]), bars.placed(values[-1])) == bars.ends


# Colour-blind eyes (Machado, Oliveira, Fernandes 2009, severity 1): matrices of linear RGB.
EYES = {
    "usual": np.eye(3),
    "deuteranopia": np.array(
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]]
    ),
    "protanopia": np.array(
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]]
    ),
    "tritanopia": np.array(
        [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.3039]]
    ),
}
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])


def lab(colour, eye):
    """CIELAB of a colour as an eye sees it."""
    red = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)]) / 255
    linear = np.where(red <= 0.04045, red / 12.92, ((red + 0.055) / 1.055) ** 2.4)
    x = XYZ @ np.clip(EYES[eye] @ linear, 0, 1) / [0.9505, 1.0, 1.089]
    f = np.where(x > 0.008856, np.cbrt(x), 7.787 * x + 16 / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize("inks", [PLAIN, COLOURED, STATES], ids=["plain", "coloured", "states"])
def test_colours_are_told_apart(inks, eye):
    shades = sorted(set(inks.values()) | ({FABRIC} if inks is PLAIN else set()))
    apart = {(a, b): np.linalg.norm(lab(a, eye) - lab(b, eye)) for a, b in combinations(shades, 2)}
    assert min(apart.values()) > 15, apart


@pytest.mark.parametrize("kind", COLOURED)
def test_lines_on_colours_have_a_border_that_contrasts(kind):
    assert abs(lab(COLOURED[kind], "usual")[0] - lab(border(kind, plain=False), "usual")[0]) > 50


@pytest.mark.parametrize(
    ("size", "high", "wide"), [(10, 1e-4, 6.4), (15, 1.63e-4, 2.0), (15, 2e4, 2.5), (15, 1.63, 6.0)]
)
def test_numbers_of_a_colour_bar_are_apart(size, high, wide):
    """In reports, whose numbers are large, those of small displacements ran into each other below flat pictures."""
    matplotlib = pytest.importorskip("matplotlib")
    backend = pytest.importorskip("matplotlib.backends.backend_agg")
    with matplotlib.rc_context({"font.size": size}):
        figure = empty(6.4, wide)
        axes = figure.subplots()
        axes.imshow(np.zeros((10, int(64 / wide))))
        axes.axis("off")
        colour_bar(figure, axes, Colours("viridis", 0.0, high, 16), outside=(False, False))
        backend.FigureCanvasAgg(figure).draw()
        boxes = [label.get_window_extent() for label in figure.axes[1].get_xticklabels()]
    assert len(boxes) in (3, 5)
    for left, right in pairwise(boxes):
        assert left.x1 + 2 < right.x0
