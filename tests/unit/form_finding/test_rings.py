"""Rings and rigid bodies: shape, forces, hand-over to masts or supports."""

import re
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from constrained import FABRIC, cone, moved
from fx_membrane import (
    Cable,
    CableLength,
    Mast,
    Membrane,
    PlanLoad,
    PointLoad,
    RigidBody,
    Ring,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    polyline,
    projected_stress,
    rectangle,
)
from fx_membrane.form_finding.constraints.motions import motions_of
from models import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", [None, 3])
@pytest.mark.parametrize("make", [lambda ring: Ring(ring, 1.0), RigidBody, lambda ring: Ring(ring, 1.3)])
def test_ring_stays_round_and_its_masts_take_its_force(make, seed):
    turn = np.eye(3) if seed is None else rotation(seed)
    structure, ring = cone(turn=turn)
    weight = [PointLoad(ring, turn @ (0, 0, 400.0))]
    form = natural_force_density(structure, weight, iterations=3, constraints=[make(ring)])
    place = form.points[ring] @ turn
    radius = getattr(make(ring), "radius", 1.0)
    assert np.hypot(place[:, 0], place[:, 1]) == pytest.approx(np.full(len(ring), radius), rel=1e-12)
    assert np.ptp(place[:, 2]) < 1e-12
    assert form.forces["hoop"] == pytest.approx(np.full(len(ring), form.forces["hoop"][0]), rel=1e-8)
    assert form.forces["hoop"][0] > 0  # the membrane pulls outwards
    assert np.abs(form.reactions[ring]).max() < 1e-9 * np.abs(form.reactions).max()
    assert len(form.structure.supports) == 1
    assert moved(form, weight) < 1e-12


def test_ring_without_masts_is_held_with_what_it_bears():
    structure, ring = cone()
    bare = replace(structure, parts={"film": structure.parts["film"]})
    form = natural_force_density(bare, constraints=[Ring(ring, 1.0)])
    assert form.structure.supported[ring].all()
    pull = form.reactions[ring]
    assert np.abs(pull.sum(axis=0)).max() < 1e-9 * np.abs(pull).max()
    assert np.sum(pull * form.points[ring], axis=1).max() < 0  # inwards: it holds the membrane's pull
    assert moved(form) < 1e-12


def test_ring_of_found_radius_is_round_under_uneven_pull():
    # Base moved sideways: a plain ring cable would be no circle.
    structure, ring = cone(hoop=0.0)
    points = structure.points.copy()
    base = structure.supported.all(axis=1)
    points[base] = points[base] * [1.5, 1, 1] + [1, 0, 0]
    parts = {"film": structure.parts["film"], "ring": Cable(structure.parts["hoop"].cells, 1e8, 3e3)}
    form = natural_force_density(replace(structure, points=points, parts=parts), constraints=[Ring(ring)])
    place = form.points[ring]
    centre = place.mean(axis=0)
    radius = np.linalg.norm(place - centre, axis=1)
    assert radius == pytest.approx(np.full(len(ring), radius[0]), rel=1e-12)
    assert abs(radius[0] - 1) > 0.05
    assert np.linalg.svd(place - centre)[1][2] < 1e-12
    pull = form.reactions[ring]
    assert np.abs(pull).max() > 1
    assert np.abs(pull.sum(axis=0)).max() < 1e-9 * np.abs(form.reactions).max()
    assert np.abs(np.sum(pull * (place - centre))) < 1e-9 * np.abs(form.reactions).max()  # no work on the radius
    assert np.abs(np.cross(place - centre, pull).sum(axis=0)).max() < 1e-9 * np.abs(form.reactions).max()
    assert moved(form) < 1e-12


@pytest.mark.mpi
def test_supports_guide_a_ring():
    structure, ring = cone()
    guided = replace(structure, supports=[*structure.supports, Support(ring, "z")])
    form = projected_stress(guided, [PlanLoad((50.0, 0, -300.0), "film")], constraints=[Ring(ring)])
    place = form.points[ring]
    assert np.array_equal(place[:, 2], structure.points[ring, 2])
    radius = np.linalg.norm(place - place.mean(axis=0), axis=1)
    assert radius == pytest.approx(np.full(len(ring), radius[0]), rel=1e-12)
    assert abs(radius[0] - 1) > 1e-3
    assert moved(form, [PlanLoad((50.0, 0, -300.0), "film")]) < 1e-12


def test_ring_turns_about_two_held_nodes():
    structure, ring = cone()
    hinged = replace(structure, supports=[*structure.supports, Support(ring[[0, 8]])])
    loads = [PointLoad(ring[4], (0, 0, 3e3))]
    form = natural_force_density(hinged, loads, constraints=[Ring(ring, 1.0)])
    place = form.points[ring]
    assert np.array_equal(place[[0, 8]], structure.points[ring[[0, 8]]])
    assert np.linalg.norm(place - place.mean(axis=0), axis=1) == pytest.approx(np.ones(len(ring)), rel=1e-10)
    assert place[4, 2] - place[12, 2] > 0.1
    assert moved(form, loads) < 1e-12


def strut():
    points = np.array([[-3.0, 0, 0], [3, 0, 0], [0, 0.1, 1], [0.2, 0, -1], [0, -3, 0], [0, 3, 0]])
    cables = Cable([[0, 2], [1, 2], [0, 3], [1, 3], [4, 2], [5, 2], [4, 3], [5, 3]], 1e6, 1e3)
    parts = {"net": cables, "strut": Mast([[2, 3]], 1e7)}
    return Structure(points, parts, [Support([0, 1, 4, 5])])


def test_rigid_pair_is_a_strut_of_its_length_whose_force_is_found():
    structure = strut()
    form = projected_stress(structure, cables="force density", constraints=[RigidBody([2, 3])])
    length = np.linalg.norm(structure.points[2] - structure.points[3])
    assert np.linalg.norm(form.points[2] - form.points[3]) == pytest.approx(length, rel=1e-13)
    assert form.forces["strut"] == pytest.approx([-2 * 1e3 * length])  # four force densities against half the length
    assert len(form.structure.supports) == 1
    assert moved(form) < 1e-12


def test_square_frame_is_rigid():
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    frame = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 0.5)
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = 0.5 * (points[rim, 0] > 0)
    structure = Structure(points, {"film": Membrane(triangles, FABRIC, 2e3)}, [Support(rim)])
    form = natural_force_density(structure, iterations=3, constraints=[RigidBody(frame)])
    first, now = points[frame] - points[frame].mean(axis=0), form.points[frame] - form.points[frame].mean(axis=0)
    assert now @ now.T == pytest.approx(first @ first.T, abs=1e-12)
    assert np.ptp(now[:, 2]) > 0.05  # it has turned with the membrane
    assert moved(form) < 1e-12


def test_cables_and_nodes_are_constrained_together():
    structure, ring = cone()
    stays = Cable([[int(ring[0]), len(structure.points)], [int(ring[8]), len(structure.points)]], 1e7)
    points = np.vstack([structure.points, [0, 0, 5.0]])
    parts = {**structure.parts, "stays": stays}
    hung = Structure(points, parts, [*structure.supports, Support(len(points) - 1)])
    given = [Ring(ring, 1.0), CableLength("stays", 2.5)]
    form = projected_stress(hung, cables="force", constraints=given)
    ends = form.points[stays.cells]
    assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) == pytest.approx([2.5, 2.5], rel=1e-7)
    assert form.points[ring, 2] == pytest.approx(np.full(len(ring), 5 - np.sqrt(2.5**2 - 1)), abs=1e-6)
    assert form.forces["stays"].min() > 100
    assert moved(form) < 1e-12


@pytest.mark.mpi
def test_every_process_has_the_same_form():
    structure, ring = cone()
    form = natural_force_density(structure, iterations=2, constraints=[Ring(ring, 1.2)])
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)


def test_ring_with_a_cable_in_tension_is_not_told_to_have_none():
    structure, ring = cone()
    (body,) = motions_of(structure, [Ring(ring)]).bodies
    wide = structure.points * [2, 2, 1]
    assert re.search("nothing within it holds it.* or a cable with a force along it", body.grown(wide, has_cable=False))
    words = body.grown(wide, has_cable=True)
    assert "has grown to 2 times" in words
    assert "nothing within" not in words
    parts = {**structure.parts, "hoop": Cable(polyline([*ring, ring[0]]), 1e7, prestress=1.8e3)}
    form = natural_force_density(replace(structure, parts=parts), iterations=2, constraints=[Ring(ring)])
    assert not any("nothing within" in words for words in form.remarks)
