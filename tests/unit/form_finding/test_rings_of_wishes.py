"""Rings and rigid bodies under stress wished for, warp unlike weft: they settle, from any start, at second order."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from constrained import cone, moved
from fx_membrane import (
    Cable,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    Pressure,
    RadialDirection,
    RigidBody,
    Ring,
    Structure,
    Support,
    UnsettledFormWarning,
    polyline,
    prescribed_stress,
)

WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)
RADIAL = {"film": RadialDirection()}
KINDS = {"radius": lambda ring: Ring(ring, 1.0), "rigid": RigidBody}


def woven(structure, prestress=(3e3, 2e3)):
    film = Membrane(structure.parts["film"].cells, WOVEN, prestress, warp=(1, 0, 0))
    return replace(structure, parts={**structure.parts, "film": film})


def lifted(n=4, load=6400.0):
    """Cone whose ring is free, and the load that lifts it."""
    structure, ring = cone(n)
    return woven(structure), ring, [PointLoad(ring, (0, 0, load / len(ring)))]


def stayed(n=4, feet=((0, 0, 5.0),), force=4e3):
    """Cone whose ring four stays lift, to a place on the axis or to four beside it."""
    structure, ring = cone(n)
    count, points = len(structure.points), np.vstack([structure.points, feet])
    tops = count + np.arange(4) % len(feet)
    stays = Cable(np.stack([ring[:: len(ring) // 4], tops], axis=1), 1e7, force)
    parts = {"film": structure.parts["film"], "stays": stays}
    return woven(Structure(points, parts, [*structure.supports, Support(np.unique(tops))])), ring, []


BESIDE = ((2.5, 1.0, 5.0), (-1.0, 2.5, 5.0), (-2.5, -1.0, 5.0), (1.0, -2.5, 5.0))
CASES = {"lifted": lifted, "stays": stayed, "stays beside the axis": lambda: stayed(feet=BESIDE)}


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("case", CASES)
def test_ring_settles_in_a_few_steps(case, kind):
    structure, ring, loads = CASES[case]()
    form = prescribed_stress(structure, loads, warp=RADIAL, constraints=[KINDS[kind](ring)])
    assert form.converged
    assert len(form.steps) <= 10
    assert moved(form, loads) < 1e-12


def test_stays_beside_the_axis_turn_the_ring():
    structure, ring, _ = stayed(feet=BESIDE)
    form = prescribed_stress(structure, warp=RADIAL, constraints=[RigidBody(ring)])
    place = form.points[ring] - form.points[ring].mean(axis=0)
    feet = np.degrees(np.arctan2(1.0, 2.5))  # where stays lead away from the axis
    assert np.degrees(np.arctan2(place[0, 1], place[0, 0])) == pytest.approx(feet, abs=1.0)


def test_ring_of_found_radius_settles_with_a_cable_along_it():
    structure, ring, loads = lifted()
    hoop = Cable(polyline([*ring, 0]), 1e7, 2.6e3)
    held = replace(structure, parts={"film": structure.parts["film"], "hoop": hoop})
    form = prescribed_stress(held, loads, warp=RADIAL, constraints=[Ring(ring)])
    radius = np.linalg.norm(form.points[ring] - form.points[ring].mean(axis=0), axis=1)
    assert form.converged
    assert radius == pytest.approx(np.full(len(ring), radius[0]), rel=1e-12)
    assert moved(form, loads) < 1e-12


def test_ring_that_nothing_holds_is_told():
    structure, ring, loads = lifted(2, 640.0)
    bare = replace(structure, parts={"film": structure.parts["film"]})
    with pytest.warns(UnsettledFormWarning, match="The Ring with node 0 .* [Nn]othing within it holds it against"):
        form = prescribed_stress(bare, loads, warp=RADIAL, constraints=[Ring(ring)])
    assert not form.converged
    assert moved(form, loads) < 1e-12


def test_loads_too_large_for_a_ring_are_told_in_sentences():
    structure, ring, loads = lifted(2)
    loads = [*loads, Pressure(20e3, "film")]
    with pytest.warns(UnsettledFormWarning, match="loads are too large for the stress wished for") as told:
        form = prescribed_stress(structure, loads, warp=RADIAL, constraints=[Ring(ring, 1.0)])
    assert ".." not in str(told[0].message)
    assert moved(form, loads) < 1e-12


@cache
def found(n, kind):
    """Find the form of a lifted ring, which tests only read; with the ring."""
    structure, ring, loads = lifted(n)
    return prescribed_stress(structure, loads, warp=RADIAL, constraints=[KINDS[kind](ring)]), ring


def started(structure, ring, start):
    """Put the ring elsewhere in the first mesh, turned about its axis or across it."""
    cosine, sine = np.cos(np.radians(15.0)), np.sin(np.radians(15.0))
    turn = {
        "turned": [[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]],
        "tilted": [[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]],
    }.get(start, np.eye(3))
    shift = {"higher": (0, 0, 0.8), "aside": (0.3, -0.2, 0)}.get(start, (0, 0, 0))
    points, centre = structure.points.copy(), structure.points[ring].mean(axis=0)
    points[ring] = (points[ring] - centre) @ np.transpose(turn) + centre + shift
    return replace(structure, points=points)


@pytest.mark.parametrize(
    ("kind", "n", "start"),
    [
        *((kind, 4, start) for kind in ("radius", "rigid") for start in ("higher", "aside", "turned", "tilted")),
        ("radius", 16, "tilted"),  # long first cells
    ],
)
def test_starts_of_a_ring_give_one_form(n, kind, start):
    structure, ring, loads = lifted(n)
    one, _ = found(n, kind)
    other = prescribed_stress(started(structure, ring, start), loads, warp=RADIAL, constraints=[KINDS[kind](ring)])
    assert other.converged
    assert other.steps[-1].area == pytest.approx(one.steps[-1].area, rel=1e-6)
    assert other.points[ring].mean(axis=0) == pytest.approx(one.points[ring].mean(axis=0), abs=1e-5)
    if kind == "radius":  # the same along the ring too; turned about its axis, a rigid one keeps its nodes
        assert other.points == pytest.approx(one.points, abs=1e-5)
        assert other.forces["film"] == pytest.approx(one.forces["film"], abs=1e-5 * 3e3)


@pytest.mark.parametrize("kind", KINDS)
def test_place_of_a_ring_is_of_second_order(kind):
    heights, areas = [], []
    for n in (4, 8, 16):
        form, ring = found(n, kind)
        assert form.converged
        heights.append(form.points[ring, 2].mean())
        areas.append(form.steps[-1].area)
    for values in (heights, areas):
        assert np.log2((values[0] - values[1]) / (values[1] - values[2])) == pytest.approx(2, abs=0.4)
