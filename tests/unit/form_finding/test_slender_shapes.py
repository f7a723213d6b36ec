"""Shapes with a cell so slender that its stress has no digits: collapsed, whatever its area."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from constrained import cone, moved
from fx_membrane import (
    Fabric,
    Membrane,
    Slide,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    rectangle,
)
from fx_membrane.form_finding.after_collapse import last_good
from fx_membrane.form_finding.balance.membrane_balance import collapse_of
from fx_membrane.form_finding.shape_change import check_collapse

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


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


def moving(structure, share):
    """Give a cell in the middle a larger stress."""
    stress = structure.parts["film"].prestress_tensors().copy()
    stress[len(stress) // 2] *= 1 + share
    return replace(structure, parts={"film": replace(structure.parts["film"], prestress=stress)})


@pytest.mark.mpi
def test_nearest_shape_at_rest_is_the_last_good_one():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = points[rim, 0] * points[rim, 1]
    film = Membrane(triangles, Fabric(4e5, 0.3), 2e3)
    still = natural_force_density(Structure(points, {"film": film}, [Support(rim)])).structure
    shapes = [moving(still, share) for share in (1e-2, 1e-4, 1e-3)]
    assert last_good([*shapes, still], [], MPI.COMM_WORLD) == 3
    assert last_good([still, *shapes], [], MPI.COMM_WORLD) == 0
    assert last_good(shapes, [], MPI.COMM_WORLD) == 1  # that which moves least


@pytest.mark.mpi_once
def test_form_whose_cells_slide_to_nothing_is_that_of_a_step_before():
    """Half of the rim slides inwards until cells are slender, none below the limits of a collapse."""
    structure, ring = cone(6, radius=0.7)
    rim = np.flatnonzero(structure.supported.all(axis=1))
    slides = [Slide(rim[1::2], direction=structure.points[rim[1::2]] * [1, 1, 0] + [0, 0, 1])]
    parts = {"film": structure.parts["film"]}
    free = Structure(structure.points, parts, [Support(ring), Support(rim[::2])])
    for iterations in range(1, 8):
        assert moved(natural_force_density(free, iterations=iterations, constraints=slides)) < 1e-12
