"""Shapes with a cell so slender that its stress has no digits: collapsed, whatever its area."""

import pytest

from fx_membrane import Fabric, Membrane, Structure, Support, rectangle
from fx_membrane.form_finding.balance.membrane_balance import collapse_of
from fx_membrane.form_finding.shape_change import check_collapse


def sheet(stretch):
    """Make a sheet and a shape of it with longer and flatter triangles of a fifth of the area."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    film = Membrane(triangles, Fabric(4e5, 0.3), 2e3)
    structure = Structure(points, {"film": film}, [Support([0, 4, 20, 24])])
    return structure, points * [stretch, 0.2 / stretch, 1]


def test_slender_cell_of_fair_area_is_a_collapse():
    structure, shape = sheet(2e3)
    with pytest.raises(RuntimeError, match="step 3: the shape collapses around cell 0 of part 'film'"):
        check_collapse(structure, shape, 3)
    assert "part 'film', cell 0 shrinks to nothing" in collapse_of(structure, shape)


def test_flat_cell_with_its_digits_is_none():
    structure, shape = sheet(100.0)
    check_collapse(structure, shape, 3)
    assert collapse_of(structure, shape) == ""
