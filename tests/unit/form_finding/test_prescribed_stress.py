"""Prescribed stress as a wish: exact balance, wishes in space, settling."""

from collections import namedtuple
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Fabric,
    Mast,
    Membrane,
    RadialDirection,
    UnsettledFormWarning,
    prescribed_stress,
)
from fx_membrane.form_finding import wished_stress
from fx_membrane.geometry.sizes import measures, normals
from models import rotation
from wished_films import canopy, cone, loads, state_of

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


@pytest.mark.mpi_once
@pytest.mark.parametrize("loaded", [False, True])
def test_form_is_in_equilibrium_as_it_is(loaded):
    structure, acting = canopy(), loads() if loaded else []
    form = prescribed_stress(structure, acting)
    state = state_of(form, acting)
    assert form.converged
    assert np.abs(state.displacement).max() < 1e-12 * 8
    assert state.reactions == pytest.approx(form.reactions, abs=1e-9 * np.abs(form.reactions).max())


def test_form_settles_and_stays_settled():
    form = prescribed_stress(canopy(), tolerance=1e-4)
    again = prescribed_stress(canopy(), tolerance=1e-8, max_iterations=300)
    assert form.steps[-1].area == pytest.approx(again.steps[-1].area, rel=1e-4)
    assert form.forces["film"] == pytest.approx(again.forces["film"], abs=1e-3 * 3e3)
    assert form.points == pytest.approx(again.points, abs=1e-3)


def test_wish_and_differences_belong_to_the_cells_of_the_form():
    structure = cone()
    form = prescribed_stress(structure, warp={"film": RadialDirection()})
    cells = structure.parts["film"].cells
    assert form.wish["film"] == pytest.approx(np.broadcast_to(np.diag([4e3, 2e3]), (len(cells), 2, 2)))
    centre = form.points[cells].mean(axis=1) * [1, 1, 0]
    normal = normals(form.points, cells)
    radial = centre - np.sum(centre * normal, axis=1, keepdims=True) * normal
    radial /= np.linalg.norm(radial, axis=1, keepdims=True)
    assert form.structure.warp("film") == pytest.approx(radial, abs=1e-12)
    stress = form.structure.parts["film"].prestress_tensors()
    root = np.diag([4e3**-0.5, 2e3**-0.5])
    expected = np.abs(np.linalg.eigvalsh(root @ stress @ root - np.eye(2))).max(axis=1)
    assert form.differences["film"] == pytest.approx(expected, rel=1e-9)
    assert form.differences["film"].max() == pytest.approx(form.steps[-1].stress_error, rel=1e-9)
    assert "n_radial = 2000 + c / r" in form.remarks[0]


@pytest.mark.mpi
def test_functions_of_place_are_taken_where_the_cells_are():
    seen = []

    def stress(x):
        seen.append(x)
        return np.stack([3e3 + 100 * x[2], np.full(x.shape[1], 2e3)], axis=1)

    structure = canopy()
    form = prescribed_stress(structure, stress={"film": stress}, warp={"film": lambda x: np.array([1.0, 0.3, 0])})
    centre = form.points[structure.parts["film"].cells].mean(axis=1)
    assert form.wish["film"][:, 0, 0] == pytest.approx(3e3 + 100 * centre[:, 2], rel=1e-12)
    assert all(x.shape == (3, len(centre)) for x in seen)


def test_isotropic_stress_needs_no_warp_and_gives_a_soap_film_between_arcs():
    structure = canopy(prestress=2e3)
    film = Membrane(structure.parts["film"].cells, Fabric(5e5, 0.3), 2e3)
    form = prescribed_stress(replace(structure, parts={**structure.parts, "film": film}))
    assert form.converged
    assert form.differences["film"].max() < 0.1
    assert form.differences["edge"].max() < 0.02


@pytest.mark.parametrize("seed", [1, 2])
def test_form_turns_with_the_structure(seed):
    structure, turn = canopy(n=6), rotation(seed)
    film = replace(structure.parts["film"], warp=turn @ [1, 0.3, 0])
    turned = replace(structure, points=structure.points @ turn.T, parts={**structure.parts, "film": film})
    one, other = prescribed_stress(structure, tolerance=1e-6), prescribed_stress(turned, tolerance=1e-6)
    assert other.points == pytest.approx(one.points @ turn.T, abs=1e-7 * 8)


def test_mesh_stays_even():
    structure = cone()
    form = prescribed_stress(structure, warp={"film": RadialDirection()})
    areas = measures(form.points, structure.parts["film"].cells)
    assert areas.max() < 40 * areas.min()


@pytest.mark.mpi
def test_every_process_has_the_same_form():
    form = prescribed_stress(canopy(n=4))
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)


@pytest.mark.mpi
def test_masts_between_held_nodes_are_taken():
    structure = canopy(n=4)
    corners = np.flatnonzero(structure.supported.all(axis=1))
    parts = {**structure.parts, "mast": Mast([corners[:2]], 1e7, -5e3)}
    form = prescribed_stress(replace(structure, parts=parts))
    assert form.forces["mast"] == pytest.approx([-5e3])
    assert np.abs(state_of(form).displacement).max() < 1e-12 * 8


@pytest.mark.mpi
def test_too_few_steps_are_reported():
    with pytest.warns(UnsettledFormWarning, match="has not settled: step 1"):
        form = prescribed_stress(canopy(), max_iterations=1, tolerance=1e-12)
    assert not form.converged


def test_no_share_of_the_way_to_the_wish_is_tried_twice_from_one_state(monkeypatch):
    """Shares above 95 % have no form, and the last step is tried shorter from each state."""
    tried, state = [], namedtuple("State", "mean")

    def reached(problem, start, begun, share, *_):
        tried.append((begun, share))
        return None if share > 0.95 else (state(share), [], "")

    monkeypatch.setattr(wished_stress, "_reached", reached)
    start, problem = state(0.0), SimpleNamespace(measured=lambda *_: start)
    words = wished_stress._by_way(problem, start, "an even stress", lambda _: None, 1e-6, 100, wished_stress.WAYS)[2]
    assert "beyond 93 % of the way" in words
    assert len(set(tried)) == len(tried) > 4


@pytest.mark.parametrize(("masted", "most"), [(True, wished_stress.FEWEST), (False, wished_stress.WAYS)])
def test_search_with_masts_of_given_length_is_short(masted, most, monkeypatch):
    """Their heads are held next."""
    ways = []

    def none(*_):
        raise RuntimeError

    def by_way(*given):
        ways.append(given[-1])
        return None, [], "no form"

    no = dict.fromkeys(("even_state", "has_weak_edges", "has_far_too_weak_edges"), lambda _: None)
    for name, found in {"near_state": none, "_by_way": by_way, **no}.items():
        monkeypatch.setattr(wished_stress, name, found)
    wished_stress._nearest(SimpleNamespace(membranes={}, cables=None), lambda _: None, 1e-6, 100, masted)
    assert ways == [most]
