"""Form finding with stress given in projection: balance, hand-over, measures of cables, projections and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PlanLoad,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    projected_stress,
)
from fx_membrane.geometry.sizes import measures, normals
from models import rotation
from sails import canopy, loads_of, sail, state_of

pytestmark = pytest.mark.filterwarnings(
    "ignore::fx_membrane.UnsettledFormWarning", "ignore::fx_membrane.LargeStrainWarning"
)


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("cables", ["horizontal force", "force", "force density"])
@pytest.mark.parametrize("max_iterations", [1, 100])
def test_form_is_in_equilibrium_as_it_is(cables, loaded, max_iterations):
    structure = canopy(force=6e3 if cables == "force density" else 40e3)
    loads = loads_of(structure) if loaded else []
    form = projected_stress(structure, loads, cables=cables, max_iterations=max_iterations)
    state = state_of(form, loads)
    assert np.abs(form.points - structure.points).max() > 0.5
    assert np.abs(state.displacement).max() < 1e-12 * np.ptp(form.points)
    assert len(state.history) == 1  # no iteration
    assert state.reactions == pytest.approx(form.reactions, abs=1e-10 * np.abs(form.reactions).max())
    assert not form.reactions[~structure.supported].any()


@pytest.mark.parametrize("seed", [1, 2])
def test_projection_along_any_direction(seed):
    structure = canopy()
    expected = projected_stress(structure)
    turn = rotation(seed)
    film = replace(structure.parts["film"], warp=turn @ [1, 0, 0])
    turned = replace(structure, points=structure.points @ turn.T, parts={**structure.parts, "film": film})
    form = projected_stress(turned, direction=3 * turn[:, 2])
    assert form.points == pytest.approx(expected.points @ turn.T, abs=1e-11)
    assert form.forces["film"] == pytest.approx(expected.forces["film"], rel=1e-9, abs=1e-6)
    back = projected_stress(turned, direction=-turn[:, 2])
    assert back.points == pytest.approx(form.points, abs=1e-11)
    assert back.forces["film"] == pytest.approx(form.forces["film"], rel=1e-9, abs=1e-6)


def test_flat_plan_stays_flat():
    structure = sail()
    flat = structure.points * [1, 1, 0]
    form = projected_stress(replace(structure, points=flat))
    assert form.points == pytest.approx(flat, abs=1e-13)
    assert form.forces["film"] == pytest.approx(structure.parts["film"].prestress_tensors(), rel=1e-12, abs=1e-9)


@pytest.mark.parametrize("prestress", [2e3, (3e3, 1e3), [[3e3, 0.0], [0.0, 1e3]]])
def test_constant_stress_over_a_saddle_has_harmonic_heights(prestress):
    # z = x y satisfies N11 z,xx + N22 z,yy = 0, at the nodes of an even grid too.
    structure = sail(prestress=prestress)
    form = projected_stress(structure)
    x, y = structure.points[:, :2].T
    assert form.points == pytest.approx(np.stack([x, y, x * y / 4], axis=1), abs=1e-12)
    assert form.converged
    assert form.steps[-1].stress_error < 1e-12


def test_shear_in_plan_balances_a_load():
    # N12 = t with z = x y / 4 needs the load -2 t / 4 upwards, per plan area.
    structure = sail(prestress=[[3e3, 5e2], [5e2, 2e3]])
    form = projected_stress(structure, [PlanLoad((0, 0, -250.0), "film")])
    x, y = structure.points[:, :2].T
    assert form.points[:, 2] == pytest.approx(x * y / 4, abs=1e-12)


def test_shear_has_its_sign_on_either_side():
    tensor = [[3e3, 5e2], [5e2, 2e3]]
    up = sail(prestress=tensor)
    down = sail(prestress=[[3e3, -5e2], [-5e2, 2e3]], cells=up.parts["film"].cells[:, ::-1])
    assert down.normals("film")[0, 2] < 0
    one, other = projected_stress(up), projected_stress(down)
    assert one.points == pytest.approx(other.points, abs=1e-12)


def test_stress_in_plan_of_the_form_is_the_prescribed_one():
    # Traction across a cut normal to an axis of the plan: force per plan length, in both components of the plan.
    structure = sail(prestress=(3e3, 2e3), warp=(1.0, 0.5, 7.0))
    form = projected_stress(structure)
    part = form.structure.parts["film"]
    warp, normal = form.structure.warp("film"), normals(form.points, part.cells)
    frame = np.stack([warp, np.cross(normal, warp)], axis=2)
    cauchy = frame @ form.forces["film"] @ frame.swapaxes(1, 2)
    plan = cauchy[:, :2, :2] / np.abs(normal[:, 2])[:, None, None]
    first = np.array([1.0, 0.5]) / np.hypot(1, 0.5)
    second = np.array([-first[1], first[0]])
    wanted = 3e3 * np.outer(first, first) + 2e3 * np.outer(second, second)
    assert np.abs(plan - wanted).max() <= 1e-9 * 3e3
    assert warp[:, :2] / np.linalg.norm(warp[:, :2], axis=1)[:, None] == pytest.approx(np.tile(first, (128, 1)))


def test_cables_have_the_forces_given_in_their_measure():
    structure = canopy()
    length = {}
    forces = {}
    for cables in ("horizontal force", "force"):
        form = projected_stress(structure, cables=cables, tolerance=1e-8, max_iterations=2000)
        edge = structure.parts["edge"].cells
        length[cables] = measures(form.points * [1, 1, 0], edge), measures(form.points, edge)
        forces[cables] = form.forces["edge"]
    flat, true = length["horizontal force"]
    assert forces["horizontal force"] * flat / true == pytest.approx(np.full(len(true), 40e3), rel=1e-6)
    assert forces["force"] == pytest.approx(np.full(len(true), 40e3), rel=1e-6)
    form = projected_stress(structure, cables="force density")
    assert form.forces["edge"] == pytest.approx(40e3 * measures(form.points, edge), rel=1e-12)
    assert len(form.steps) == 1


def test_stress_as_a_function_of_place_is_that_of_its_values():
    structure = sail()
    centres = structure.points[structure.parts["film"].cells].mean(axis=1)

    def field(x):
        assert x.shape == (3, len(centres))
        return np.stack([2e3 + 300 * x[0], 2e3 - 200 * x[1]], axis=1)

    film = replace(structure.parts["film"], prestress=field(centres.T))
    one = projected_stress(structure, stress={"film": field})
    other = projected_stress(replace(structure, parts={"film": film}))
    assert np.array_equal(one.points, other.points)
    assert not np.array_equal(one.points, projected_stress(structure).points)
    assert state_of(one).displacement == pytest.approx(0, abs=1e-12)


def test_plan_held_by_supports_is_kept_and_the_imbalance_reported():
    structure = sail()
    inner = np.flatnonzero(~structure.supported.any(axis=1))
    held = replace(structure, supports=[*structure.supports, Support(inner, "xy")])
    form = projected_stress(held, stress={"film": lambda x: 2e3 + 300 * x[0]})
    assert np.array_equal(form.points[:, :2], structure.points[:, :2])
    assert form.steps[-1].stress_error < 1e-12
    area = 16 / 64  # of the plan that a node in the middle stands for; div N = 300 N/m2 along x
    assert form.reactions[inner, 0] == pytest.approx(-300 * area, rel=1e-9)
    assert np.abs(form.reactions[inner, 1]).max() < 1e-9
    assert np.abs(state_of(form).displacement).max() < 1e-12


def test_pressure_on_a_drum_is_that_of_a_paraboloid():
    # Flat enough, pressure acts on plan areas: z = p (R^2 - r^2) / 4 N; the sum of reactions is p times the plan.
    structure = sail(prestress=1e5)
    structure = replace(structure, points=structure.points * [1, 1, 0])
    form = projected_stress(structure, [Pressure(100.0, "film")])
    assert form.reactions[:, 2].sum() == pytest.approx(-100.0 * 16, rel=1e-10)
    assert form.reactions.sum(axis=0)[:2] == pytest.approx([0, 0], abs=1e-8)
    assert np.abs(state_of(form, [Pressure(100.0, "film")]).displacement).max() < 1e-12


def test_bars_alone_are_a_net():
    points = np.array([[-2.0, 0, 0], [2, 0, 1], [0, -2, 3], [0, 2, 0], [0.3, 0.4, 9]])
    net = Cable([[0, 4], [1, 4], [2, 4], [3, 4]], 1e6, 100.0)
    form = projected_stress(Structure(points, {"net": net}, [Support(range(4))]), cables="force density")
    assert form.points[4] == pytest.approx(points[:4].mean(axis=0), abs=1e-14)


def test_masts_between_held_nodes_and_without_force_are_taken():
    structure = canopy()
    corners = np.flatnonzero(structure.supported.all(axis=1))
    centre = int(np.argmin(np.linalg.norm(structure.points, axis=1)))
    masts = {"held": Mast([corners[:2]], 1e7, -5e3), "loose": Mast([[corners[0], centre]], 1e7)}
    form = projected_stress(replace(structure, parts={**structure.parts, **masts}))
    assert form.forces["held"] == pytest.approx([-5e3], rel=1e-12)
    assert form.forces["loose"] == pytest.approx([0])
    assert form.points == pytest.approx(projected_stress(structure).points, abs=1e-12)


@pytest.mark.parametrize("cables", ["horizontal force", "force"])
def test_steps_towards_forces_of_cables_hardly_depend_on_the_mesh(cables):
    assert (
        len(projected_stress(canopy(n=48), cables=cables).steps)
        <= 2 * len(projected_stress(canopy(), cables=cables).steps) + 5
    )


@pytest.mark.mpi
def test_every_process_has_the_same_form():
    form = projected_stress(canopy(), loads_of(canopy()))
    alone = Analysis(form.structure, comm=MPI.COMM_SELF).run([Stage("form", loads_of(form.structure))])["form"]
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)
    assert np.abs(alone.displacement).max() < 1e-12 * 12


def test_hanger_that_becomes_upright_is_refused_a_horizontal_force():
    points = np.array([[-2.0, 0, 0], [2, 0, 0], [0, 0, 0], [0.5, 0, -1]])
    parts = {"rope": Cable([[0, 2], [2, 1]], 1e6, 1e3), "hanger": Cable([[2, 3]], 1e6, 500.0)}
    structure, weight = Structure(points, parts, [Support([0, 1])]), [PointLoad(3, (0, 0, -500.0))]
    with pytest.raises(RuntimeError, match=r"'hanger', cell 0 at .*cables=\"force\""):
        projected_stress(structure, weight)
    form = projected_stress(structure, weight, cables="force")
    assert form.converged
    assert form.points[3] == pytest.approx([0, 0, form.points[3, 2]], abs=1e-12)
    assert form.forces["hanger"] == pytest.approx([500])


def test_input_is_not_changed():
    structure = canopy()
    before = structure.points.copy()
    projected_stress(structure, loads_of(structure))
    assert np.array_equal(structure.points, before)
    assert structure.parts["film"].prestress == pytest.approx([3e3, 2.5e3])


@pytest.mark.mpi
def test_thousands_of_nodes_under_loads_of_the_form():
    structure = canopy(n=64)
    form = projected_stress(structure, loads_of(structure), tolerance=0.1)
    force = np.abs(form.reactions).max()
    assert np.abs(state_of(form, loads_of(structure)).reactions - form.reactions).max() < 1e-9 * force
