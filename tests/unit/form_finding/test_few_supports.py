"""Supports that leave no form, in every method: none, at one place, on one line; and nodes that are all held."""

import warnings

import numpy as np
import pytest
from scipy import sparse

from constrained import FABRIC
from fx_membrane import (
    Cable,
    CableForce,
    Membrane,
    PointLoad,
    Slide,
    Structure,
    Support,
    boundary_edges,
    force_density,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.balance.component_solve import factorized

POINTS, TRIANGLES = rectangle(4.0, 4.0, 4, 4)
POINTS[:, 2] = 0.3 * POINTS[:, 0] * POINTS[:, 1]
X, Y, _ = POINTS.T
CORNERS = np.flatnonzero(np.abs(X * Y) == 4)


def sheet(nodes, components="xyz"):
    parts = {"film": Membrane(TRIANGLES, FABRIC, 2e3), "edge": Cable(boundary_edges(TRIANGLES), 1e7, 2e4)}
    return Structure(POINTS, parts, [Support(nodes, components)] if len(nodes) else [])


def by_net(structure, loads=()):
    sides = np.sort(TRIANGLES[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    force = np.zeros_like(POINTS)
    for load in loads:
        force[load.nodes] += load.force
    return force_density(POINTS, np.unique(sides, axis=0), 1e3, structure.supports, force)


METHODS = {
    "force density": by_net,
    "projected stress": projected_stress,
    "natural force density": lambda structure, loads=(): natural_force_density(structure, loads, iterations=3),
    "updated reference": updated_reference,
    "updated reference of constraints": lambda structure, loads=(): updated_reference(
        structure, loads, constraints=[CableForce("edge", 2e4)]
    ),
    "prescribed stress": prescribed_stress,
}
ALL = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())
PLACE, LINE = (
    r"^The piece (of the branches )?with node 0 at .* at one place only, {}, .*without loads; hold",
    r"^The piece .* one line",
)


@ALL
@pytest.mark.parametrize(
    ("nodes", "message"),
    [
        ([], r"(tied by no stress to a held|tied to no fixed|supported enough).*(support|fix|Add)"),
        (CORNERS[:1], PLACE.format(r"\(-2, -2, 1\.2\)")),
        ([12], PLACE.format(r"\(0, 0, 0\)")),
        (CORNERS[[0, 3]], LINE + r".* from \(-2, -2, 1\.2\) to \(2, 2, 1\.2\), .*beside that line"),
        (CORNERS[[0, 1]], LINE),
        (np.flatnonzero(X == -2), LINE),
        (np.flatnonzero(X == 0), LINE + r".* from \(0, -2, -?0\) to \(0, 2, 0\)"),
    ],
    ids=["none", "corner", "middle", "two", "two of an edge", "edge", "midline"],
)
def test_supports_that_leave_no_form_are_refused(method, nodes, message):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ValueError, match=message) as refused:
            method(sheet(nodes))
    assert str(refused.value).count(". ") <= 1


@ALL
def test_all_nodes_held_are_told(method):
    form = method(sheet(np.arange(len(POINTS))))
    assert np.array_equal(form.points, POINTS)
    assert form.converged
    assert form.remarks == (
        "All nodes are held, so the form is the first shape; take supports from the nodes to be found.",
    )


@pytest.mark.parametrize("method", [projected_stress, natural_force_density, by_net])
def test_a_line_of_supports_is_enough_where_loads_spread_the_form(method):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        form = method(sheet(np.flatnonzero(Y == 2)), [PointLoad(np.flatnonzero(Y == -2), (0, -8e4, 0))])
    assert np.ptp(form.points[:, 1]) > 1


def test_guided_nodes_spread_a_form_as_held_ones():
    slide = Slide(CORNERS[[1, 2]], direction=(0, 0, 1))
    form = natural_force_density(sheet(CORNERS[[0, 3]]), iterations=20, constraints=[slide])
    assert np.ptp(form.points[:, 0]) == np.ptp(form.points[:, 1]) == 4


def test_half_a_sheet_between_two_points_of_its_plane_of_symmetry_is_no_line():
    symmetric = sheet(CORNERS[[1, 3]])
    held = Structure(POINTS, symmetric.parts, [Support(CORNERS[[1, 3]]), Support(np.flatnonzero(X == -2), "x")])
    assert np.ptp(natural_force_density(held, iterations=10).points[:, 0]) == 4


def test_matrix_without_numbers_is_refused():
    with pytest.raises(ValueError, match="no size"):
        factorized(sparse.csr_matrix(np.array([[np.nan]])))
