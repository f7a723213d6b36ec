"""Reasons that form finding gives: loads, single held points, stress about an axis, input unlike between processes."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Fabric,
    Membrane,
    PlanLoad,
    Pressure,
    RadialDirection,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from wished_films import WOVEN, canopy, cone, state_of


def rings(stress, n=6, inner=2.0, outer=7.0, height=3.0, oval=1.0):
    """Plan between two held rings about the z axis, the inner one lifted, with radial warp."""
    round_one = cone(n, inner, outer, height)
    points, triangles = round_one.points * [oval, 1, 1], round_one.parts["film"].cells
    warp = points[triangles].mean(axis=1) * [1, 1, 0]
    return replace(round_one, points=points, parts={"film": Membrane(triangles, WOVEN, stress, warp)})


def spike(n=8):
    """Sheet held around, and at one point within it."""
    points, triangles = rectangle(4.0, 4.0, n, n)
    middle = len(points) // 2
    points[middle, 2] = 1.0
    film = Membrane(triangles, Fabric(6e5, 0.3), 2e3)
    return Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles))), Support(middle)])


@pytest.mark.parametrize("method", [projected_stress, prescribed_stress, natural_force_density])
def test_single_held_point_is_told_by_every_method(method):
    words = r"depends on the mesh\. Part 'film' is held at a single point within it, node 40 at \(0, 0, 1\)"
    with pytest.warns(UnsettledFormWarning, match=words):
        assert not method(spike()).converged
    with pytest.warns(UnsettledFormWarning, match="held at a single point within it, node 40"):
        assert not updated_reference(spike(), max_iterations=100).converged


def test_load_is_the_reason_where_a_form_exists_without_it():
    structure = rings((3e3, 2e3))
    with pytest.warns(UnsettledFormWarning, match="loads are too large for the stress wished for: without") as told:
        prescribed_stress(structure, [PlanLoad((0, 0, -6e3), "film")], warp={"film": RadialDirection()})
    assert "neck" not in str(told[0].message)
    assert prescribed_stress(structure, warp={"film": RadialDirection()}).converged


@pytest.mark.parametrize("edges", ["held", "cables"])
def test_loads_that_no_stress_of_the_size_wished_for_holds_are_told_with_a_form(edges):
    structure = canopy() if edges == "cables" else rings((3e3, 2e3), n=3)
    loads = [Pressure(20e3, "film")]
    with pytest.warns(UnsettledFormWarning, match="loads are too large .* an even shape with [0-9]+ times as much"):
        form = prescribed_stress(structure, loads)
    assert not form.converged
    assert np.abs(state_of(form, loads).displacement).max() < 1e-12 * np.ptp(form.points)


@pytest.mark.parametrize(("stress", "sign"), [((3e3, 2e3), 1), ((2e3, 3e3), -1)])
def test_stress_about_an_axis_that_does_not_balance_in_plan_is_told_with_the_exact_choice(stress, sign):
    structure, (radial, tangential) = rings(stress), stress
    words = (
        rf"about the axis at \(0, 0, 0\) .*\(r n_radial\)' = n_tangential, but these are {radial:g} and {tangential:g} "
        rf".*n_radial = {tangential:g} \+ c / r"
    )
    with pytest.warns(UnsettledFormWarning, match=words) as told:
        projected_stress(structure)
    assert "edges with cables" not in str(told[0].message)
    c = float(str(told[0].message).partition("; c = ")[2].split()[0])
    assert c * sign > 0

    def exact(x):
        return np.stack([c / np.hypot(x[0], x[1]) + tangential, np.full(x.shape[1], tangential)], axis=1)

    assert projected_stress(structure, stress={"film": exact}).converged


@pytest.mark.parametrize(("oval", "told"), [(1.0, True), (1.3, False)])
def test_remark_on_an_axis_is_told_for_surfaces_of_revolution_alone(oval, told):
    form = prescribed_stress(rings((3e3, 2e3), oval=oval), warp={"film": RadialDirection()})
    assert any("about an axis" in remark for remark in form.remarks) == told


@pytest.mark.mpi
@pytest.mark.parametrize(("method", "what"), [(projected_stress, "stress"), (prescribed_stress, "warp")])
def test_functions_of_place_that_differ_between_processes_are_refused(method, what):
    if MPI.COMM_WORLD.size == 1:
        pytest.skip("one process has nobody to differ from")
    skew = MPI.COMM_WORLD.rank

    def field(x):
        return np.stack([2e3 + skew * x[0] ** 2, np.full(x.shape[1], 2e3), 0 * x[0]], axis=1)[:, : 3 - (what != "warp")]

    with pytest.raises(ValueError, match=f"differs .*{what} of part 'film', as a function of place"):
        method(rings((3e3, 2e3)), **{what: {"film": field}})


@pytest.mark.mpi
@pytest.mark.parametrize("method", [projected_stress, prescribed_stress, natural_force_density])
def test_structures_that_differ_between_processes_are_refused(method):
    if MPI.COMM_WORLD.size == 1:
        pytest.skip("one process has nobody to differ from")
    structure = rings((3e3, 2e3))
    with pytest.raises(ValueError, match=r"differs .* points"):
        method(replace(structure, points=structure.points + 0.01 * MPI.COMM_WORLD.rank))
