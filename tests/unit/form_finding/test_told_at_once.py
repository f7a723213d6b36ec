"""Reasons told at once, with numbers: folds beside far rings, lone mast heads, heavy loads, rings out of reach."""

import re
from functools import partial

import numpy as np
import pytest

from fx_membrane import (
    Fabric,
    GeodesicDirection,
    Mast,
    Membrane,
    Pressure,
    RigidBody,
    RoundHole,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    sail_mesh,
    updated_reference,
)
from told import told
from wished_films import WOVEN

IN_SPACE = [partial(natural_force_density, iterations=5), updated_reference, prescribed_stress]


def ring_above_square(height, size=1.5, stress=2e3):
    pytest.importorskip("gmsh")
    corners = [[-6, -6, 0], [6, -6, 0], [6, 6, 0], [-6, 6, 0]]
    mesh = sail_mesh(corners, size, holes={"ring": RoundHole((0, 0, height), 0.7)})
    equal = np.isscalar(stress)
    film = Membrane(mesh.triangles, Fabric(4e5, 0.3) if equal else WOVEN, stress, None if equal else (1, 0, 0))
    return mesh.points, film, np.unique(boundary_edges(mesh.triangles))


@pytest.mark.parametrize("find", IN_SPACE)
def test_fold_is_told_beside_a_far_ring(find):
    points, film, rim = ring_above_square(9.0)
    inside = np.setdiff1d(np.arange(len(points)), rim)
    points[inside[np.abs(np.linalg.norm(points[inside, :2], axis=1) - 4).argmin()], :2] += [2.6, 0.3]
    form, words = told(find, Structure(points, {"film": film}, [Support(rim)]))
    assert not form.converged
    assert "A ring is too far from its base" in words
    assert re.search(r"Part 'film' folds over itself between cells \d+ and \d+, at \(", words)


def tent(force):
    points, triangles = rectangle(8.0, 8.0, 8, 8)
    head, foot = int(np.linalg.norm(points, axis=1).argmin()), len(points)
    points = np.vstack([points, [0, 0, -3.0]])
    points[head, 2] = 2.0
    parts = {"film": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "mast": Mast([[foot, head]], 1e8, force)}
    rim = np.unique(boundary_edges(triangles))
    return Structure(points, parts, [Support([*rim, foot])]), [foot, head]


@pytest.mark.parametrize("find", [projected_stress, *IN_SPACE])
def test_mast_under_a_film_is_told_the_remedy_at_once(find):
    structure, (_, head) = tent(-4e3)
    _, words = told(find, structure)
    assert f"held at a single point within it, node {head} at (0, 0, 2)" in words.replace("part 'film' is ", "")
    assert "hold a ring there, or lead cables to it; then add the mast there by masts_and_stays" in words
    assert "hold its head" not in words


@pytest.mark.parametrize("find", [natural_force_density, prescribed_stress])
def test_body_with_its_head_at_a_single_point_has_no_form_of_its_own(find):
    structure, ends = tent(0.0)
    form, words = told(find, structure, constraints=[RigidBody(ends)])
    assert not form.converged
    assert "held at a single point within it" in words


@pytest.mark.parametrize("find", [projected_stress, natural_force_density, updated_reference])
def test_heavy_loads_are_told_with_part_and_value(find):
    points, triangles = rectangle(8.0, 8.0, 8, 8)
    film = Membrane(triangles, Fabric(4e5, 0.3), 2e3)
    structure = Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))])
    form, words = told(find, structure, [Pressure(5e3, "film")])
    assert form is None
    assert "a pressure of 5000 on part 'film'" in words
    assert "smaller loads" in words
    if find is not updated_reference:
        assert "most at node 40, (0, 0, 0)" in words


@pytest.mark.parametrize("size", [1.5, 1.2, 1.0])
def test_ring_out_of_reach_is_refused_on_all_meshes(size):
    points, film, rim = ring_above_square(4.0, size, (3e3, 2e3))
    form, words = told(prescribed_stress, Structure(points, {"film": film}, [Support(rim)]))
    assert not form.converged
    assert "A ring is too far from its base: that of part 'film' around (0, 0, 4)" in words
    assert "in the mean" in " ".join([words, *form.remarks])


def test_wrong_ends_of_geodesics_are_told_as_such():
    with pytest.raises(ValueError, match="geodesic 0 has a node twice"):
        GeodesicDirection([[1, 1]])
    with pytest.raises(ValueError, match="geodesics 0 and 1 have the same nodes"):
        GeodesicDirection([[1, 2], [2, 1]])


def test_stress_in_plan_of_a_wrong_shape_is_told_with_shapes_of_functions():
    structure, _ = tent(0.0)
    message = r"it gives shape \(3, 7\).* for each of the 128 cells: \(128,\), \(128, 2\) or \(128, 2, 2\)\."
    with pytest.raises(ValueError, match=message):
        projected_stress(structure, stress={"film": lambda x: np.ones((3, 7))})
