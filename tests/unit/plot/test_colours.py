"""Colours: scales of forces, and numbers beside them that can be told apart."""

import numpy as np
import pytest

from fx_membrane import Cable, Structure, Support, polyline
from fx_membrane.plot.colours import _texts
from fx_membrane.plot.panels import Look, setting
from fx_membrane.plot.shown import shown


@pytest.mark.parametrize(
    ("low", "high", "texts"),
    [
        (0, 1, ["0", "0.25", "0.5", "0.75", "1"]),
        (-27400, 27400, ["-27400", "-13700", "0", "13700", "27400"]),
        (20000, 20001, ["20000", "20000.2", "20000.5", "20000.8", "20001"]),
        (2e9, 4e9, ["2e+09", "2.5e+09", "3e+09", "3.5e+09", "4e+09"]),
        (0, 0.0004, ["0", "0.0001", "0.0002", "0.0003", "0.0004"]),
    ],
)
def test_numbers_can_be_told_apart(low, high, texts):
    assert _texts(np.linspace(low, high, 5)) == texts


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


def test_forces_of_both_signs_are_balanced():
    bars = forces(1e3, -4e3)
    assert (bars.low, bars.high) == (-4e3, 4e3)
    assert bars.map == "PuOr_r"
