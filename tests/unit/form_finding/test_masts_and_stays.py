"""Masts and stays in the place of held nodes: hand-over at rest, choice of forces, and supports."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Mast,
    NeoHooke,
    PlanLoad,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    force_density,
    masts_and_stays,
    natural_force_density,
    projected_stress,
    stability,
    updated_reference,
)
from masted_sails import guys, head, sail
from models import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


def moved(form, loads=()):
    """Displacement of a form in its analysis, over its size, and the iterations of that."""
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    assert state.reactions == pytest.approx(form.reactions, abs=1e-9 * np.abs(form.reactions).max())
    return state.largest_displacement / form.structure.size, len(state.history) - 1


@pytest.mark.parametrize("find", [projected_stress, updated_reference, natural_force_density])
@pytest.mark.parametrize(("seed", "unit"), [(None, 1.0), (None, 1e-3), (3, 1.0)])
@pytest.mark.mpi_once
def test_sail_on_tilted_masts_is_at_rest(find, seed, unit):
    turn = None if seed is None else rotation(seed)
    structure, corners = sail(turn=turn, unit=unit)
    given = {"direction": turn[:, 2]} if seed is not None and find is projected_stress else {}
    bars, feet = guys(structure, corners, turn)
    before = find(structure, **given)
    form = masts_and_stays(before, bars, feet, heads=corners[:2])
    assert (form.forces["masts"] < 0).all()
    assert (form.forces["stays"] > 0).all()
    assert moved(form) == (0.0, 0)
    assert form.converged == before.converged


@pytest.mark.mpi
def test_loads_of_the_form_are_balanced_too():
    structure, corners = sail()
    loads = [
        DistributedLoad((0, 0, -20.0), "fabric"),
        Pressure(30.0, "fabric"),
        PlanLoad((0, 0, -50.0), "fabric"),
        DistributedLoad((0, 0, -10.0), "edges"),
        PointLoad([corners[0], corners[1]], (0, 0, -800.0)),
    ]
    bars, feet = guys(structure, corners)
    form = masts_and_stays(projected_stress(structure, loads), bars, feet)
    assert moved(form, loads)[0] < 1e-12
    without = masts_and_stays(projected_stress(structure, loads[:-1]), bars, feet)
    assert form.forces["masts"][0] < without.forces["masts"][0] - 400


def test_state_is_stable_and_feet_carry_all():
    structure, corners = sail()
    bars, feet = guys(structure, corners)
    form = masts_and_stays(projected_stress(structure), bars, feet)
    state = Analysis(form.structure).run([Stage("form")])["form"]
    assert stability(state).stable
    assert np.abs(form.reactions.sum(axis=0)).max() < 1e-9 * np.abs(form.reactions).max()
    assert not form.reactions[list(corners[:2])].any()
    held = form.structure.supported.any(axis=1)
    assert set(np.flatnonzero(held)) == {corners[2], corners[3], *range(len(structure.points), len(form.points))}


def test_bars_keep_their_data_and_the_form_its_shape():
    structure, corners = sail(material=NeoHooke(3e5))
    before = projected_stress(structure)
    bars, feet = guys(structure, corners)
    bars["masts"] = replace(bars["masts"], mass=4.0)
    form = masts_and_stays(before, bars, feet)
    assert form.structure.parts["masts"].mass == 4.0
    assert form.structure.parts["stays"].axial_stiffness == 2e7
    assert np.array_equal(form.points[: len(before.points)], before.points)
    assert form.steps == before.steps
    assert np.array_equal(form.forces["fabric"], before.forces["fabric"])
    assert form.structure.parts["stays"].prestress == pytest.approx(form.forces["stays"])


# Choice of forces


def test_smallest_forces_without_a_wanted_one():
    form, bars, ends, loads = head((0.3, 0, 0), (-3, 2, 0), (-3, -2, 0), (-5, 0, 0))
    found = masts_and_stays(form, bars, ends)
    forces = np.concatenate([found.forces["mast"], found.forces["stay"]])
    rng = np.random.default_rng(0)
    ways = np.array(ends) - [0, 0, 4.0]
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    free = np.linalg.svd(ways.T)[2][-1]
    assert forces @ ways == pytest.approx([-3e3, 0, 0], abs=1e-9)
    for step in rng.uniform(-1e3, 1e3, 20):
        other = forces + step * free
        if (other * [-1, 1, 1, 1] >= 0).all():
            assert np.linalg.norm(other) >= np.linalg.norm(forces)
    assert moved(found, loads)[0] < 1e-12


@pytest.mark.parametrize("wanted", [-9e3, -4e3])
def test_wanted_mast_force_is_met_where_it_can_be(wanted):
    form, bars, ends, loads = head((0.3, 0, 0), (-3, 2, 0), (-3, -2, 0), (6, 0, 0), wanted=[wanted, 0, 0, 0])
    found = masts_and_stays(form, bars, ends)
    assert found.forces["mast"] == pytest.approx([wanted], rel=1e-12)
    assert (found.forces["stay"] >= 0).all()
    assert found.converged
    assert moved(found, loads)[0] < 1e-12


def test_nearest_force_where_it_cannot_be_met():
    form, bars, ends, loads = head((0.3, 0, 0), (-3, 2, 0), (-3, -2, 0), (6, 0, 0), wanted=[-1e3, 0, 0, 0])
    found = masts_and_stays(form, bars, ends)
    alone = masts_and_stays(*head((0.3, 0, 0), (-3, 2, 0), (-3, -2, 0))[:3])
    assert found.forces["mast"] == pytest.approx(alone.forces["mast"], rel=1e-9)  # the last stay carries nothing
    assert found.forces["stay"][2] == pytest.approx(0, abs=1e-9)
    assert not found.converged
    assert moved(found, loads)[0] < 1e-12


def test_unique_forces_are_kept_whatever_is_wanted():
    arms = (0.3, 0, 0), (-3, 2, 0), (-3, -2, 0)
    free, wanted = (masts_and_stays(*head(*arms, wanted=w)[:3]) for w in (0.0, [-500.0, 300, 0]))
    assert wanted.forces["mast"] == pytest.approx(free.forces["mast"], rel=1e-12)
    assert free.converged
    assert not wanted.converged


def test_prestress_of_a_sail_by_a_third_stay():
    structure, corners = sail()
    bars, feet = guys(structure, corners, third=True)
    bars["masts"] = replace(bars["masts"], prestress=-80e3)
    form = masts_and_stays(projected_stress(structure), bars, feet)
    assert form.forces["masts"] == pytest.approx(-80e3, rel=1e-12)
    assert (form.forces["stays"] > 0).all()
    assert moved(form) == (0.0, 0)


# Nodes


def test_joint_below_a_mast_hung_in_cables():
    form, _, _, loads = head(pull=(3e3, 0.0, -500.0))
    points = [(-4.0, 0, 4), (0, 0, 2), (-4, 2, 4), (-4, -2, 4), (4, 0, 4.0)]
    bars = {
        "mast": Mast([[3, 0]], 1e8),
        "cables": Cable([[2, 0], [4, 3], [5, 3], [6, 3]], 1e7),
    }
    found = masts_and_stays(form, bars, points, heads=[0, 3])
    assert moved(found, loads)[0] < 1e-12
    assert found.forces["mast"] == pytest.approx([-500.0])
    assert not found.reactions[[0, 3]].any()
    assert found.reactions[[2, 4, 5, 6]].any(axis=1).all()


def test_half_of_a_symmetric_structure():
    form, bars, ends, loads = head((0.3, 0, 0), (-3, 2, 0), (-3, -2, 0), pull=(3e3, 0.0, -500.0))
    whole = masts_and_stays(form, bars, ends)
    half = {"mast": bars["mast"], "stay": Cable([[3, 0]], 1e8)}
    sides = [Support([0, 1]), Support([0], "y")]
    structure = replace(form.structure, supports=sides)
    cut = masts_and_stays(replace(form, made=structure), half, [ends[0], ends[1]], heads=0, components="xz")
    assert cut.forces["stay"] == pytest.approx([2 * whole.forces["stay"][0]])
    assert cut.structure.supported[0].tolist() == [False, True, False]
    assert moved(cut, loads)[0] < 1e-12


def test_in_two_calls_as_in_one():
    structure, corners = sail()
    form, (bars, feet) = projected_stress(structure), guys(structure, corners)
    n, (west, east, *_) = len(form.points), corners
    first = {"west mast": Mast([[n, west]], 3e8), "west": Cable([[n + 1, west], [n + 2, west]], 2e7)}
    second = {"east mast": Mast([[n + 3, east]], 3e8), "east": Cable([[n + 4, east], [n + 5, east]], 2e7)}
    once = masts_and_stays(form, bars, feet, heads=[west, east])
    twice = masts_and_stays(masts_and_stays(form, first, feet[[0, 2, 3]]), second, feet[[1, 4, 5]])
    assert twice.forces["east mast"] == pytest.approx(once.forces["masts"][1:])
    assert moved(twice)[0] < 1e-12


def test_held_node_as_a_foot():
    structure, corners = sail()
    form, n, (west, _, south, north) = projected_stress(structure), len(structure.points), corners
    bars = {"mast": Mast([[n, west]], 3e8), "stays": Cable([[n + 1, west], [n + 2, west], [south, west]], 2e7)}
    found = masts_and_stays(form, bars, [(-5.2, 0, 0), (-9, 2.5, 0), (-9, -2.5, 0)], heads=[west])
    assert found.structure.supported[[south, north]].all()
    assert moved(found)[0] < 1e-12


def test_net_of_force_densities_with_a_structure():
    points = [(0.0, 0, 4), (8, 0, 0), (0, 8, 0), (0, 0, 0), (2, 2, 2)]
    branches = [[4, 0], [4, 1], [4, 2]]
    fixed = [Support([0, 1, 2])]
    net = force_density(points, branches, 100.0, fixed)
    bars, feet = {"mast": Mast([[3, 0]], 1e8), "stays": Cable([[5, 0], [6, 0]], 1e7)}, [(-4, 0, 0), (0, -4, 0)]
    with pytest.raises(ValueError, match=r"net.*made=structure"):
        masts_and_stays(net, bars, feet, heads=[0])
    structure = Structure(net.points, {"net": Cable(branches, 1e7, prestress=net.forces["net"])}, fixed)
    form = masts_and_stays(replace(net, made=structure), {**bars, "mast": Mast([[7, 0]], 1e8)}, [*feet, (0, 0, 0)])
    assert moved(form)[0] < 1e-12
    shifted = replace(structure, points=structure.points + 1.0)
    with pytest.raises(ValueError, match=r"other points.*form\.points"):
        masts_and_stays(replace(net, made=shifted), bars, feet)
