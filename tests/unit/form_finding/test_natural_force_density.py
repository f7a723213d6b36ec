"""Natural force densities of surfaces: one linear solve, and iterations towards the Cauchy stress."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PlanLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    natural_force_density,
    rectangle,
    updated_reference,
)
from fx_membrane.geometry.sizes import measures, normals
from models import rotation
from own_terms import ElasticBed

WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)
pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def canopy(n=8, prestress=(3e3, 2e3), force=30e3, height=1.5):
    """Plan between four corners, two of them high, with edge cables."""
    points, triangles = rectangle(8.0, 8.0, n, n)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 16)
    points[corners, 2] = height * np.sign(points[corners, 0] * points[corners, 1])
    parts = {
        "film": Membrane(triangles, WOVEN, prestress, warp=(1, 0.3, 0)),
        "edge": Cable(boundary_edges(triangles), 2e7, force),
    }
    return Structure(points, parts, [Support(corners)])


def loads():
    return [Pressure(40.0, "film"), PlanLoad((0, 0, -60.0), "film")]


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("iterations", [1, 3])
def test_form_is_in_equilibrium_as_it_is(iterations, loaded):
    structure = canopy()
    form = natural_force_density(structure, loads() if loaded else (), iterations)
    state = Analysis(form.structure).run([Stage("form", loads() if loaded else ())])["form"]
    assert np.abs(form.points - structure.points).max() > 0.5
    assert np.abs(state.displacement).max() < 1e-12 * 8
    assert len(state.history) == 1  # no iteration
    assert state.reactions == pytest.approx(form.reactions, abs=1e-10 * np.abs(form.reactions).max())


@pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")
@pytest.mark.parametrize("iterations", [1, 4])
def test_steps_of_the_updated_reference_strategy_are_the_iterations(iterations):
    structure = canopy(prestress=2e3)
    form = natural_force_density(structure, iterations=iterations)
    other = updated_reference(structure, max_iterations=iterations, tolerance=1e-12)
    assert form.points == pytest.approx(other.points, abs=1e-12)
    assert form.forces["edge"] == pytest.approx(other.forces["edge"], rel=1e-10)
    assert [step.area for step in form.steps] == pytest.approx([step.area for step in other.steps], rel=1e-12)


def test_natural_force_densities_are_those_of_the_first_mesh():
    structure = canopy()
    form = natural_force_density(structure)
    edge = structure.parts["edge"].cells
    density = form.forces["edge"] / measures(form.points, edge)
    assert density == pytest.approx(30e3 / measures(structure.points, edge), rel=1e-12)
    # Triangle by triangle, the stress pulled back to the first mesh, in space, is the prestress.
    cells = structure.parts["film"].cells
    sides = [points[cells[:, 1:]] - points[cells[:, :1]] for points in (structure.points, form.points)]
    triads = [
        np.concatenate([side, normals(points, cells)[:, None]], axis=1).swapaxes(1, 2)
        for side, points in zip(sides, (structure.points, form.points), strict=True)
    ]
    back = triads[0] @ np.linalg.inv(triads[1])

    def in_space(structure):
        warp, normal = structure.warp("film"), normals(structure.points, cells)
        frame = np.stack([warp, np.cross(normal, warp)], axis=2)
        return frame @ structure.parts["film"].prestress_tensors() @ frame.swapaxes(1, 2)

    ratio = measures(form.points, cells) / measures(structure.points, cells)
    pulled = ratio[:, None, None] * (back @ in_space(form.structure) @ back.swapaxes(1, 2))
    assert pulled == pytest.approx(in_space(structure), abs=1e-9 * 3e3)


def test_iterations_come_nearer_to_the_cauchy_stress_and_end_at_the_tolerance():
    structure = canopy(prestress=2e3)
    form = natural_force_density(structure, iterations=200, tolerance=0.02)
    errors = [step.stress_error for step in form.steps]
    assert form.converged
    assert errors[-1] <= 0.02 < errors[-2]
    assert len(errors) < 200
    found, wanted = form.forces["film"], 2e3 * np.eye(2)
    assert np.abs(np.linalg.eigvalsh(found - wanted)).max() <= 0.02 * 2e3
    assert form.forces["edge"] == pytest.approx(np.full(32, 30e3), rel=0.02)


@pytest.mark.parametrize("seed", [1, 2])
def test_form_turns_with_the_structure(seed):
    structure, turn = canopy(), rotation(seed)
    film = replace(structure.parts["film"], warp=turn @ [1, 0.3, 0])
    turned = replace(structure, points=structure.points @ turn.T, parts={**structure.parts, "film": film})
    one, other = natural_force_density(structure), natural_force_density(turned)
    assert other.points == pytest.approx(one.points @ turn.T, abs=1e-11)


@pytest.mark.mpi
def test_every_process_has_the_same_form():
    form = natural_force_density(canopy(), loads(), 2)
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)


def test_collapse_keeps_the_last_good_form():
    structure = canopy(prestress=2e3, force=4e3)
    with pytest.warns(UnsettledFormWarning, match="edge cables are too weak"):
        form = natural_force_density(structure, iterations=200)
    assert not form.converged
    expected = natural_force_density(structure, iterations=len(form.steps))
    assert np.array_equal(form.points, expected.points)
    state = Analysis(form.structure).run([Stage("form")])["form"]
    assert np.abs(state.displacement).max() < 1e-12 * 8


def with_film(**changes):
    structure = canopy()
    film = replace(structure.parts["film"], **changes)
    return replace(structure, parts={**structure.parts, "film": film})


@pytest.mark.parametrize(
    ("structure", "loads", "words"),
    [
        (with_film(prestress=(3e3, 0.0)), (), r"'film', cell 0 at \(.*\): its stress is not positive"),
        (with_film(prestress=(3e3, -1.0)), (), "principal value of -1; give a tension"),
        (replace(canopy(), terms=[ElasticBed("film", 1e3)]), (), "energy terms"),
        (canopy(force=-1.0), (), "'edge', cell 0 at .* is in compression"),
        (replace(canopy(), supports=[]), (), "tied by no stress to a held node"),
        (canopy(), [Pressure(1.0, "roof")], "roof"),
        (3, (), "structure"),
    ],
)
def test_bad_input_is_refused(structure, loads, words):
    with pytest.raises(ValueError, match=words):
        natural_force_density(structure, loads)


def test_load_that_outgrows_the_stress_is_refused():
    points, triangles = rectangle(2.0, 2.0, 8, 8)
    film = Membrane(triangles, Fabric(1e5, 0.3), 100.0)
    structure = Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))])
    with pytest.raises(RuntimeError, match="grow with the form faster than the stress can hold"):
        natural_force_density(structure, [Pressure(1e4, "film")])
