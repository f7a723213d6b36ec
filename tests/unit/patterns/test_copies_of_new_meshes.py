"""Strips of one shape among those meshed anew, whose cells differ."""

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, Structure, Support, cut_strips, planar_cut, rectangle, with_copies

pytest.importorskip("gmsh")


def dome(bulge=0.0):
    """Part of a sphere over a square, its mesh without a plane of symmetry; a bulge within one outer strip."""
    points, triangles = rectangle(6.0, 6.0, 13, 13, diagonals="right")
    x, y = points[:, 0], points[:, 1]
    points[:, 2] = np.sqrt(64 - x**2 - y**2) + bulge * np.exp(-((x - 2.25) ** 2 + y**2) / 0.1)
    roof = Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3)}, [Support([0])])
    return roof, [planar_cut(roof, (x, 0, 0), (1, 0, 0))[0] for x in (-1.5, 0.0, 1.5)]


@pytest.mark.parametrize("size", [0.9, 0.5])
def test_symmetric_strips_of_new_cells_are_copies(size):
    strips = with_copies(cut_strips(*dome(), size=size))
    assert len(strips.copies) == 2, strips.copies


def test_a_strip_with_a_bulge_is_no_copy():
    strips = with_copies(cut_strips(*dome(bulge=0.06), size=0.5))
    assert len(strips.copies) == 1, strips.copies


def test_a_given_tolerance_holds_within_strips():
    strips = cut_strips(*dome(), size=0.9)
    assert len(with_copies(strips, 0.1).copies) == 2
    assert not with_copies(strips, 1e-9).copies
