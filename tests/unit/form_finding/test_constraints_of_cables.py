"""Cables by force, force density, length, sag and edge angle, in both methods, and their hand-over."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from constrained import canopy, edges, moved, rope, with_a_hole
from fx_membrane import (
    Cable,
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    DistributedLoad,
    EdgeAngle,
    PointLoad,
    Structure,
    Support,
    natural_force_density,
    projected_stress,
)
from fx_membrane.form_finding.constraints.cable_lines import lines_of
from fx_membrane.geometry.sizes import measures
from models import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


METHODS = [
    lambda structure, constraints: projected_stress(structure, cables="force", constraints=constraints, tolerance=1e-8),
    lambda structure, constraints: natural_force_density(structure, iterations=3, constraints=constraints),
]


@pytest.mark.mpi_once
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(("kind", "value"), [(CableLength, 12.9), (CableSag, 0.9), (EdgeAngle, 15.0)])
def test_edges_have_the_geometry_given_and_the_form_is_in_equilibrium(method, kind, value):
    structure = canopy()
    form = method(structure, [kind("edge", value)])
    length, sag, lines = edges(structure, form.points)
    found = {CableLength: length, CableSag: sag, EdgeAngle: [np.degrees(line.angle(form.points)) for line in lines]}
    if method is METHODS[0] or kind is not EdgeAngle:
        assert found[kind] == pytest.approx([value] * 4, rel=2e-8)
    assert max(found[kind]) <= value * (1 + 2e-8)
    assert form.forces["edge"].min() > 1e3
    assert moved(form) < 1e-12


def test_force_of_an_edge_of_given_sag_gives_that_sag():
    structure = canopy()
    one = projected_stress(structure, cables="force", constraints=[CableSag("edge", 0.9)], tolerance=1e-8)
    cable = replace(structure.parts["edge"], prestress=one.forces["edge"])
    given = replace(structure, parts={**structure.parts, "edge": cable})
    other = projected_stress(given, cables="force", tolerance=1e-8)
    assert other.points == pytest.approx(one.points, abs=1e-6)


def test_horizontal_force_of_a_line_is_one():
    form = projected_stress(rope(), [PointLoad(range(1, 8), (0, 0, -1e3))], constraints=[CableLength("rope", 110.0)])
    flat = measures(form.points * [1, 1, 0], form.structure.parts["rope"].cells)
    horizontal = form.forces["rope"] * flat / measures(form.points, form.structure.parts["rope"].cells)
    assert horizontal == pytest.approx(np.full(8, horizontal[0]), rel=1e-6)
    assert measures(form.points, form.structure.parts["rope"].cells).sum() == pytest.approx(110, rel=1e-8)


@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
def test_cable_under_its_weight_is_found_by_length(method):
    weight = [DistributedLoad((0, 0, -50.0), "rope")]
    form = method(rope(), weight, constraints=[CableLength("rope", 110.0)])
    assert form.converged
    assert form.reactions[:, 2].sum() == pytest.approx(50.0 * 110, rel=1e-7)
    assert moved(form, weight) < 1e-12


@pytest.mark.parametrize("prestress", [0.0, 1.0, 1e7])
def test_first_guess_does_not_matter(prestress):
    loads = [PointLoad(range(1, 8), (0, 0, -1e3))]
    form = projected_stress(rope(prestress=prestress), loads, constraints=[CableSag("rope", 10.0)])
    assert form.points[4, 2] == pytest.approx(-10, rel=1e-7)


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_units_do_not_matter(scale):
    loads = [PointLoad(range(1, 8), (0, 0, -1e3 * scale))]
    form = projected_stress(rope(), loads, constraints=[CableSag("rope", 10.0)])
    assert -form.reactions[0, 0] == pytest.approx(1e3 * scale * 100 / 10, rel=1e-7)  # moment of the half span over sag


def test_sag_along_a_direction_is_measured_there():
    loads = [PointLoad(range(1, 8), (0, 0, -1e3))]
    form = projected_stress(rope(rise=50.0), loads, constraints=[CableSag("rope", 10.0, along=(0, 0, 3))])
    assert form.points[4, 2] == pytest.approx(25 - 10, rel=1e-7)
    normal = projected_stress(rope(rise=50.0), loads, constraints=[CableSag("rope", 10.0)])
    assert 25 - normal.points[4, 2] == pytest.approx(10 * np.hypot(100, 50) / 100, rel=1e-7)


def test_cells_of_a_cable_have_constraints_of_their_own():
    structure = canopy()
    cells = structure.parts["edge"].cells
    lines = edges(structure, structure.points)[2]
    given = [
        CableForce("edge", 30e3, lines[0].cells),
        CableDensity("edge", 2e4, lines[1].cells),
        CableLength("edge", 12.9, lines[2].cells),
        CableForce("edge", 25e3, lines[3].cells, horizontal=True),
    ]
    form = projected_stress(structure, cables="force", constraints=given, tolerance=1e-8)
    length = measures(form.points, cells)
    assert form.forces["edge"][lines[0].cells] == pytest.approx(np.full(8, 30e3), rel=1e-7)
    assert form.forces["edge"][lines[1].cells] / length[lines[1].cells] == pytest.approx(np.full(8, 2e4), rel=1e-10)
    assert length[lines[2].cells].sum() == pytest.approx(12.9, rel=1e-8)
    flat = measures(form.points * [1, 1, 0], cells)[lines[3].cells]
    assert form.forces["edge"][lines[3].cells] * flat / length[lines[3].cells] == pytest.approx(
        np.full(8, 25e3), rel=1e-7
    )
    assert moved(form) < 1e-12


def test_force_constraint_is_the_prestress():
    one = projected_stress(canopy(force=30e3), cables="force")
    other = projected_stress(canopy(), constraints=[CableForce("edge", 30e3)])
    assert np.array_equal(one.points, other.points)


def test_force_constraint_is_met_in_each_step_and_the_prestress_in_the_end():
    other = natural_force_density(canopy(), iterations=3, constraints=[CableForce("edge", 30e3)])
    assert other.forces["edge"] == pytest.approx(30e3, rel=1e-6)
    one, other = (
        natural_force_density(canopy(force=force), iterations=60, constraints=constraints)
        for force, constraints in ((30e3, []), (15e3, [CableForce("edge", 30e3)]))
    )
    assert one.forces["edge"] == pytest.approx(30e3, rel=1e-3)
    assert one.steps[-1].area == pytest.approx(other.steps[-1].area, rel=1e-3)  # nodes slide within the surface


@pytest.mark.parametrize("method", METHODS)
def test_idle_limit_of_the_angle_leaves_the_prestress(method):
    structure = canopy(force=60e3)
    free, limited = method(structure, ()), method(structure, [EdgeAngle("edge", 30.0)])
    assert limited.points == pytest.approx(free.points, abs=1e-4)
    assert limited.forces["edge"] == pytest.approx(free.forces["edge"], rel=1e-4)


def test_closed_line_has_its_length():
    structure = with_a_hole()
    form = projected_stress(structure, cables="force", constraints=[CableLength("ring", 6.0)])
    assert measures(form.points, structure.parts["ring"].cells).sum() == pytest.approx(6.0, rel=1e-8)
    assert np.linalg.norm(form.points[:16], axis=1) == pytest.approx(np.full(16, 6 / 32 / np.sin(np.pi / 16)))


@pytest.mark.parametrize("seed", [1, 2])
def test_form_turns_with_the_structure(seed):
    structure, turn = canopy(), rotation(seed)
    turned = replace(
        structure,
        points=structure.points @ turn.T,
        parts={**structure.parts, "film": replace(structure.parts["film"], warp=turn @ [1, 0.3, 0])},
    )
    sag = [CableSag("edge", 0.9)]
    one, other = (natural_force_density(s, iterations=2, constraints=sag) for s in (structure, turned))
    assert other.points == pytest.approx(one.points @ turn.T, abs=1e-7)


@pytest.mark.mpi
def test_every_process_has_the_same_form():
    form = projected_stress(canopy(), cables="force", constraints=[CableSag("edge", 0.9)])
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)


def guyed(n=8):
    """Canopy whose corners are held by guys, and in z."""
    structure = canopy(n, depth=0.0)
    corners = np.flatnonzero(structure.supported.all(axis=1))
    feet = structure.points[corners] * [1.4, 1.4, 0] - [0, 0, 2]
    foot = len(structure.points) + np.arange(4)
    guys = Cable(np.stack([corners, foot], axis=1), 2e7, 30e3)
    return Structure(
        np.vstack([structure.points, feet]), {**structure.parts, "guy": guys}, [Support(foot), Support(corners, "z")]
    )


def test_edge_all_around_is_divided_at_corners_with_guys():
    structure = guyed()
    form = natural_force_density(structure, iterations=5, constraints=[CableSag("edge", 1.0)])
    corners = np.isin(np.arange(len(form.points)), structure.parts["guy"].cells)
    lines = lines_of(structure.parts["edge"].cells, np.arange(32), corners)
    assert [line.sag(form.points, None) for line in lines] == pytest.approx([1.0] * 4, rel=2e-8)
    assert moved(form) < 1e-12
