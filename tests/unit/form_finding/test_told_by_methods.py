"""Words and maps of errors that methods of form finding give beside the form."""

import re
import warnings

import numpy as np
import pytest

from constrained import canopy, cone, moved, with_a_hole
from fx_membrane import (
    Cable,
    CableLength,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PlanLoad,
    PointLoad,
    RigidBody,
    Ring,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    force_density,
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.constraints import bodies
from fx_membrane.form_finding.constraints.motions import motions_of
from fx_membrane.form_finding.masts import standing_masts
from masted_sails import head, sail_on_masts

METHODS = [projected_stress, natural_force_density, updated_reference, prescribed_stress]


@pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")
@pytest.mark.parametrize("method", METHODS)
def test_differences_are_of_all_parts(method):
    form = method(canopy(force=25e3))
    assert set(form.differences) == {"film", "edge"}
    for name, difference in form.differences.items():
        assert difference.shape == (len(form.structure.parts[name].cells),)
        assert difference.any() == (method is not projected_stress)  # which has no wish in space


def test_differences_of_a_net_are_zero():
    form = force_density(np.eye(3), [[0, 2], [1, 2]], 1.0, [Support([0, 1])])
    assert form.differences["net"].tolist() == [0.0, 0.0]


def test_masts_and_stays_keep_the_wish():
    form = prescribed_stress(canopy(force=25e3))
    corner, n = int(form.points.sum(axis=1).argmax()), len(form.points)
    foot = form.points[corner] * [1, 1, 0]
    bars = {"mast": Mast([[n, corner]], 1e8), "stay": Cable([[n + 1, corner], [n + 2, corner]], 1e7)}
    guyed = masts_and_stays(form, bars, foot + np.array([[0.3, 0.3, 0], [5, 1, 0], [1, 5, 0]]), heads=[corner])
    assert guyed.wish["film"] is form.wish["film"]
    assert guyed.differences["film"] == pytest.approx(form.differences["film"])
    assert not guyed.differences["mast"].any()


def test_stress_far_from_the_prescribed_one_is_told():
    with pytest.warns(UnsettledFormWarning, match=r"after 1 iteration that is off by \d.* in part 'film', cell \d+ at"):
        form = natural_force_density(canopy(force=25e3))
    assert not form.converged
    assert form.steps[-1].stress_error > 0.1
    assert natural_force_density(canopy(force=25e3), iterations=30).steps[-1].stress_error < 0.1


@pytest.mark.mpi
def test_plan_load_is_balanced_by_updated_reference():
    structure, load = canopy(force=25e3), (0.0, 0.0, -30.0)
    form = updated_reference(structure, [PlanLoad(load, "film")])
    flat = form.points * [1, 1, 0]
    a, b, c = (flat[corner] for corner in structure.parts["film"].cells.T)
    area = np.abs(np.cross(b - a, c - a)[:, 2]).sum() / 2
    assert form.reactions[:, 2].sum() == pytest.approx(30.0 * area, rel=1e-9)
    assert moved(form, [PlanLoad(load, "film")]) < 1e-12


@pytest.mark.parametrize("method", METHODS)
def test_load_that_does_not_fit_is_told_in_the_users_words(method):
    with pytest.raises(ValueError, match=r"^Form finding has a load on part 'roof'"):
        method(canopy(force=25e3), [DistributedLoad((0, 0, -1.0), "roof")])
    with pytest.raises(ValueError, match=r"^Form finding: a point load names node 999"):
        method(canopy(force=25e3), [PointLoad(999, (0, 0, -1.0))])


@pytest.mark.filterwarnings("ignore::fx_membrane.SliverWarning")
@pytest.mark.parametrize("structure", [with_a_hole(), cone()[0]], ids=["hole", "cone"])
@pytest.mark.parametrize("method", [natural_force_density, updated_reference])
def test_ring_of_free_radius_that_grows_is_told(method, structure):
    settings = {"iterations": 40} if method is natural_force_density else {}
    with pytest.warns(UnsettledFormWarning, match=r"The Ring with node 0 at .* has grown to [34] times .* Give its"):
        method(structure, constraints=[Ring(range(16))], **settings)


@pytest.mark.parametrize("count", [2, 3])
def test_body_that_turns_over_is_told(count):
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    structure = Structure(points, {"film": Membrane(triangles, Fabric(4e5, 0.3), 2e3)}, [Support([0])])
    nodes = [12, 13, 17][:count]
    (body,) = motions_of(structure, [RigidBody(nodes)]).bodies
    turned = points.copy()
    turned[nodes] = points[12] + (points[nodes] - points[12]) * ([1, -1, 1] if count == 3 else [-1, -1, 1])
    assert "has turned by 180 degrees from its start" in body.turned(turned)
    assert body.turned(points) == ""


def net_with_a_body():
    points = np.array([[-4.0, 0, 0], [4, 0, 0], [0, 1, 0], [0, 3, 0]])
    parts = {"net": Cable([[0, 2], [1, 2], [0, 3], [1, 3]], 1e7, 1e3)}
    return Structure(points, parts, [Support([0, 1])]), [RigidBody([2, 3])]


def test_rigid_body_keeps_its_length():
    structure, constraints = net_with_a_body()
    form = projected_stress(structure, cables="force", constraints=constraints)
    assert np.linalg.norm(form.points[3] - form.points[2]) == pytest.approx(2.0)


def test_no_balance_of_a_rigid_body_is_told_without_a_radius(monkeypatch):
    structure, constraints = net_with_a_body()
    monkeypatch.setattr(bodies, "_newton", lambda *_: None)  # no small case is known in which no start leads to one
    with pytest.raises(RuntimeError, match=r"^The RigidBody with node 2 at .* finds no balance") as told:
        projected_stress(structure, cables="force", constraints=constraints)
    assert "supports: take supports from its nodes" in str(told.value)
    assert "radius" not in str(told.value)


def test_length_out_of_reach_is_told_with_the_length_found():
    structure = canopy(force=25e3)
    with pytest.raises(RuntimeError, match=r"no force gives the line of cable 'edge' .* the length 40: it is \d"):
        natural_force_density(structure, constraints=[CableLength("edge", 40.0)])


def test_mast_of_given_length_that_falls_is_told(monkeypatch):
    """Stays of 60 kN balance the sail nowhere near; with 25 kN the masts stand."""
    monkeypatch.setattr(standing_masts, "MAX_MOVES", 4)  # of places for the heads: 20 find none, either
    structure, masts = sail_on_masts(0.0, pull=60e3)
    with pytest.warns(UnsettledFormWarning, match=r"the RigidBody .* has turned by \d+ degrees .* masts_and_stays"):
        form = updated_reference(structure, constraints=[RigidBody(mast) for mast in masts])
    assert not form.converged
    assert np.ptp(form.points[:, 2]) < 0.1


@pytest.mark.parametrize("tilt", [1.0, 3.0])
def test_mast_of_given_length_stands_where_its_stays_balance(tilt):
    """The first steps lay both down, in a balance that turns about the vertical without a force."""
    structure, masts = sail_on_masts(tilt)
    form = updated_reference(structure, constraints=[RigidBody(mast) for mast in masts])
    assert form.converged
    assert form.points[:, 2].max() > 3
    assert form.forces["stays"] == pytest.approx(25e3 * np.ones(4), rel=1e-3)
    assert moved(form) < 1e-12


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("tilt", [0.0, 1.0, 3.0])
def test_mast_without_force_that_falls_is_told(method, tilt):
    structure, _ = sail_on_masts(tilt)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UnsettledFormWarning)
        words = outcome(method, structure) or str(told[0].message)
    assert re.search(
        r"mast in cell 0 of part 'masts'(,? has no force, |, with the force 0, shrinks).*as prestress,", words
    )


def outcome(method, structure):
    """Words of a refusal, or none of a form that has not converged."""
    try:
        assert not method(structure).converged
    except RuntimeError as refused:
        return str(refused)
    return ""


@pytest.mark.parametrize("method", METHODS)
def test_mast_without_force_that_a_sheet_presses_down_is_told(method):
    points, triangles = rectangle(2.0, 2.0, 8, 8)
    points[40, 2] = 0.5
    parts = {"sheet": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "mast": Mast([[81, 40]], 1e6)}
    rim = np.unique(boundary_edges(triangles))
    structure = Structure(np.vstack([points, [[0, 0, -1.0]]]), parts, [Support([*rim, 81])])
    with pytest.warns(
        UnsettledFormWarning, match=r"'mast' has no force, .* its length from 1\.5 to 1, its end to \(0, "
    ):
        form = method(structure)
    assert not form.converged


def test_mast_of_given_force_that_falls_is_told():
    structure, _ = sail_on_masts(1.0, 60e3, push=-40e3)
    with pytest.warns(UnsettledFormWarning, match=r"mast in cell \d of part 'masts' has turned by \d+ degrees"):
        form = updated_reference(structure)
    assert not form.converged
    assert np.ptp(form.points[:, 2]) < 0.1


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("foot", [-1.0, 3.0])
def test_mast_of_given_length_that_ends_in_tension_is_told(method, foot):
    points = np.array([[-4.0, 0, 0], [4, 0, 0], [0, -4, 0], [0, 4, 0], [0, 0, 1], [0, 0, foot]])
    parts = {"net": Cable([[k, 4] for k in range(4)], 1e7, 1e3), "mast": Mast([[5, 4]], 1e8)}
    structure = Structure(points, parts, [Support([0, 1, 2, 3, 5])])
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", UnsettledFormWarning)
        form = method(structure, constraints=[RigidBody([5, 4])])
    pushed = foot < 0
    assert form.converged == pushed == (not told) == (form.forces["mast"][0] < 0)
    if not pushed:
        assert re.search(
            r"mast in cell 0 of part 'mast', at \(0, 0, 2\), is in tension, with the force (1000|970\.1): .* Make it",
            str(told[0].message),
        )


def test_mast_of_given_force_is_found():
    form = updated_reference(sail_on_masts(push=-40e3)[0])
    assert form.converged
    assert form.points[:, 2].max() > 3
    assert moved(form) < 1e-12


@pytest.mark.parametrize("method", [projected_stress, natural_force_density, prescribed_stress])
def test_free_mast_is_refused_with_the_ways_to_find_it(method):
    structure, masts = sail_on_masts(push=-40e3)
    with pytest.raises(ValueError, match=r"'masts', cell 0 .*-40000.*masts_and_stays.*RigidBody.*updated_reference"):
        method(structure, constraints=[RigidBody(masts[0])])


def test_stress_somewhat_off_is_told():
    with pytest.warns(UnsettledFormWarning, match=r"after 30 iterations that is off by \d.*iterations=\.\.\."):
        form = natural_force_density(canopy(force=25e3), iterations=30)
    assert not form.converged
    assert form.steps[-1].stress_error < 0.1


def test_unmet_force_of_a_bar_is_told():
    form, bars, ends, _ = head((-3.0, 0, 0), (0.0, 0, 0), wanted=[1e3, 0.0])
    with pytest.warns(UnsettledFormWarning, match=r"with 5000 in cell 0 of part 'stay', not with the wanted 1000: .*"):
        guyed = masts_and_stays(form, bars, ends)
    assert not guyed.converged
    assert "want that force, or none" in guyed.remarks[-1]


def test_ring_that_slides_for_many_steps_is_told_with_a_remedy():
    """It settles after 68 steps."""
    structure, ring = cone()
    k = len(structure.points)
    stays = Cable(np.stack([ring, np.full(len(ring), k)], axis=1), 1e7, 200.0)
    hung = Structure(
        np.vstack([structure.points, [[0, 0, 4.0]]]),
        {"film": structure.parts["film"], "stays": stays},
        [*structure.supports, Support([k])],
    )
    with pytest.warns(UnsettledFormWarning, match=r"neither a radius .* give its radius"):
        assert not prescribed_stress(hung, constraints=[Ring(ring)], max_iterations=20).converged
