"""Cables of given geometry under stress wished for, warp unlike weft: forms settle in a few steps, with one force."""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    CableLength,
    CableSag,
    EdgeAngle,
    Membrane,
    RadialDirection,
    Structure,
    Support,
    boundary_edges,
    prescribed_stress,
    rectangle,
)
from hypars import FABRIC
from wished_films import canopy, tent

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


@pytest.mark.study("prestress")
@pytest.mark.parametrize("prestress", [(3e3, 2e3), (2.5e3, 2.5e3)])
@pytest.mark.parametrize("constraint", [CableSag("edge", 0.6), CableLength("edge", 8.7), EdgeAngle("edge", 35.0)])
def test_form_of_cables_of_given_geometry_settles_in_a_few_steps(constraint, prestress):
    form = prescribed_stress(canopy(prestress=prestress), constraints=[constraint])
    assert form.converged
    assert len(form.steps) <= 12


@pytest.mark.parametrize("prestress", [(3e3, 2e3), (4e3, 1e3)])
def test_form_of_deep_edges_is_found_for_unequal_stress(prestress):
    assert prescribed_stress(canopy(prestress=prestress), constraints=[CableSag("edge", 0.8)]).converged


@pytest.mark.study
@pytest.mark.parametrize("length", [12.8, 13.3])
def test_steep_cone_with_edges_of_given_length_settles(length):
    form = prescribed_stress(
        tent(20e3, radius=1.2), warp={"film": RadialDirection()}, constraints=[CableLength("edge", length)]
    )
    assert form.converged
    assert len(form.steps) <= 20
    lines = form.forces["edge"].reshape(4, -1)
    assert lines == pytest.approx(np.repeat(lines[:, :1], 6, axis=1), rel=1e-6)  # one force along each edge


@pytest.mark.mpi_once
def test_one_of_two_cable_parts_has_a_given_length():
    """Parts with unlike numbers of cells; each has the force that its own constraint or prestress gives it."""
    points, triangles = rectangle(8.0, 8.0, 4, 4)
    edges = boundary_edges(triangles)
    west = points[edges].mean(axis=1)[:, 0] < -3.99
    points[:, 2] = points[:, 0] * points[:, 1] / 12
    parts = {
        "film": Membrane(triangles, FABRIC, 2e3),
        "west": Cable(edges[west], 2e7, 20e3),
        "rest": Cable(edges[~west], 2e7, 20e3),
    }
    form = prescribed_stress(
        Structure(points, parts, [Support([0, 4, 20, 24])]), constraints=[CableLength("rest", 8.6)]
    )
    assert form.converged
    assert form.forces["west"] == pytest.approx(20e3, rel=1e-2)
    places, cells = form.structure.points, edges[~west]
    sides = [np.linalg.norm(places[cell[0]] - places[cell[1]]) for cell in cells]
    assert sum(sides) == pytest.approx(3 * 8.6, rel=1e-6)
