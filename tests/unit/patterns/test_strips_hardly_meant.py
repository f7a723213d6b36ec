"""Strips a millimetre wide are doubted; the warp of strips about as wide as long, and one that the user chooses."""

import warnings

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, NarrowStripWarning, Structure, cut_strips, planar_cut, rectangle


def roof(warp=None, width=6.0):
    points, triangles = rectangle(width, 4.0, 12, 8)
    return Structure(points, {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3, warp=warp)})


def cuts(structure, *places):
    return [line for y in places for line in planar_cut(structure, (0, y, 0), (0, 1, 0))]


def test_strip_between_seams_that_nearly_coincide_is_told():
    structure = roof()
    with pytest.warns(
        NarrowStripWarning, match=r"Strip 'strip 2' around .* is 0.03 wide .*'strip 1' 2; move the"
    ) as told:
        cut_strips(structure, cuts(structure, 0.0, 0.03))
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cut_strips(structure, cuts(structure, 0.0, 0.1))


def triangle(warp):
    """Equilateral triangle of four cells with sides of 2."""
    corners = 2 * np.array([(0, 0, 0), (1, 0, 0), (0.5, np.sqrt(0.75), 0)])
    points = np.concatenate([corners, (corners + np.roll(corners, -1, axis=0)) / 2])
    cells = [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)]
    return Structure(points, {"corner": Membrane(cells, Fabric(5e5, 0.3), 2e3, warp=warp)})


@pytest.mark.parametrize(("degrees", "wanted"), [(10, 0), (50, 60), (70, 60), (-50, -60), (170, 180)])
def test_equilateral_corner_takes_its_narrow_axis_near_to_the_present_warp(degrees, wanted):
    """Each side is an axis of least width."""
    a, b = np.radians([degrees, wanted])
    strips = cut_strips(triangle((np.cos(a), np.sin(a), 0)), [])
    np.testing.assert_allclose(strips.structure.warp("corner"), [(np.cos(b), np.sin(b), 0)] * 4, atol=1e-9)


def test_warp_is_chosen_by_name():
    structure = roof()
    strips = cut_strips(structure, cuts(structure, 0.0), warp={"strip 2": (1, 1, 5)})
    np.testing.assert_allclose(strips.structure.warp("strip 1"), [(1, 0, 0)] * 96, atol=1e-9)
    np.testing.assert_allclose(strips.structure.warp("strip 2"), [(np.sqrt(0.5), np.sqrt(0.5), 0)] * 96, atol=1e-9)


@pytest.mark.parametrize(
    ("warp", "words"),
    [
        ({"strip 9": (1, 0, 0)}, r"'strip 9' is no strip; the strips are \['strip 1', 'strip 2'\]"),
        ({"strip 1": (0, 0, 1)}, "normal to a cell of strip 'strip 1'; give a direction"),
        ({"strip 1": (0, 0, 0)}, "warp of strip 'strip 1' is .*; give a direction"),
        ([(1, 0, 0)], "cut_strips warp"),
    ],
)
def test_other_warps_are_refused(warp, words):
    structure = roof()
    with pytest.raises(ValueError, match=words):
        cut_strips(structure, cuts(structure, 0.0), warp=warp)
