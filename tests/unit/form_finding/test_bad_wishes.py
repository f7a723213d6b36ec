"""Stress, edges, rings, plans and warps of which no form can come: told by each method with the place."""

import re
import warnings

import numpy as np
import pytest

from constrained import canopy
from films import FABRIC
from fx_membrane import (
    Cable,
    CableForce,
    CableSag,
    Membrane,
    RadialDirection,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.balance.constrained_balance import ConstrainedBalance
from fx_membrane.form_finding.constraints.cable_lines import lines_of
from fx_membrane.form_finding.reasons.asked_structure import as_asked
from fx_membrane.form_finding.reasons.no_form import cause

METHODS = {
    "projected": projected_stress,
    "natural": natural_force_density,
    "updated": updated_reference,
    "prescribed": prescribed_stress,
}
ALL = list(METHODS)
IN_SPACE = ["natural", "updated"]  # prescribed_stress tells the same of a form that it has searched for
AT = r"\(-?[\d.]+, -?[\d.]+, -?[\d.]+\)"


def plan(stress=2e3, force=10e3, warp=(1, 0, 0), n=4, fold=False, edge=True):
    """Four corners held, two of them high, and edge cables between them."""
    points, triangles = rectangle(4.0, 4.0, n, n)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 4)
    points[corners, 2] = points[corners, 0] * points[corners, 1] / 4
    parts: dict[str, Membrane | Cable] = {"film": Membrane(triangles, FABRIC, stress, warp=warp)}
    if edge:
        parts["edge"] = Cable(boundary_edges(triangles), 1e7, force)
    if fold:
        points[:, 0] *= np.where(points[:, 0] > 0, -0.9, 1.0)
        points[:, 2] = 0.0
        return Structure(points, {"film": parts["film"]}, [Support(np.unique(boundary_edges(triangles)))])
    return Structure(points, parts, [Support(corners)])


def rings(height=6.0, n=3):
    angle = np.arange(12) * np.pi / 6
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([(2 - 0.5 * k) * circle + [0, 0, height * k / n] for k in range(n + 1)])
    i, j = (index.ravel() for index in np.mgrid[:n, :12])
    a, b = 12 * i + j, 12 * i + (j + 1) % 12
    triangles = np.concatenate([np.stack([a, b, b + 12], axis=1), np.stack([a, b + 12, a + 12], axis=1)])
    film = Membrane(triangles, FABRIC, 2e3)
    return Structure(points, {"film": film}, [Support([*range(12), *range(12 * n, 12 * n + 12)])])


def of_a_cell(value, usual, cell=3):
    return np.where(np.arange(32)[:, None] == cell, value, usual)


FAULTS = {
    "slack": (ALL, lambda: plan((2e3, 0.0)), r"'film', cell 0 at AT: its stress.*not positive|zero in one direction"),
    "compression": (ALL, lambda: plan(of_a_cell([-5.0, 2e3], [2e3, 2e3])), r"'film', cell 3.*-5.*AT|cell 3 at AT.*-5"),
    "pushed edge": (ALL, lambda: plan(force=[-1.0] * 16), "'edge', cell 0.*(-1.*AT|AT.*-1)"),
    "weak edge": (
        ["projected", *IN_SPACE],
        lambda: plan(force=1e3),
        r"'edge' that meet at node 0, AT, have 1000 .* more than (5657|7071)",
    ),
    "no edge": (ALL, lambda: plan(edge=False), r"'film'.* (around|at) AT.* neither"),
    "gap in an edge": (
        ALL,
        lambda: plan(force=np.where(np.arange(16) == 3, 0.0, 1e4)),
        r"edge .*(around|at) AT.* neither",
    ),
    "far ring": (
        IN_SPACE,
        rings,
        r"'film' around \(0, 0, 6\), of radius 0.5, is 6 away.* equal stress .* about 1\.\d",
    ),
    "fold in plan": (["projected"], lambda: plan(fold=True), r"'film' folds over itself in plan at cell \d+, AT"),
    "fold": (IN_SPACE, lambda: plan(fold=True), r"'film' folds over itself between cells \d+ and \d+, at AT: unfold"),
    "zero warp": (ALL, lambda: plan(warp=of_a_cell(0.0, [1.0, 0, 0])), r"'film', cell 3.*warp.* AT"),
    "upright warp": (ALL, lambda: plan(warp=(0, 0, 1), edge=False), r"'film', cell \d+.*warp.* AT"),
}
CASES = [(method, fault) for fault, (methods, *_) in FAULTS.items() for method in methods]


def told_by(method, make, **given):
    """Sentences of the error, or of the warning of a form that has not converged."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            assert not METHODS[method](make(), **given).converged
        except (ValueError, RuntimeError) as refused:
            return str(refused)
    assert not [each for each in told if issubclass(each.category, RuntimeWarning)]
    return str(told[-1].message)


@pytest.mark.filterwarnings("ignore::fx_membrane.CoincidentNodesWarning", "ignore::fx_membrane.SliverWarning")
@pytest.mark.parametrize(("method", "fault"), CASES)
def test_fault_is_told_with_its_place(method, fault):
    _, structure, words = FAULTS[fault]
    assert re.search(words.replace("AT", AT), told_by(method, structure))


@pytest.mark.parametrize("method", IN_SPACE)
def test_force_of_a_constraint_counts_for_its_edge(method):
    words = told_by(method, lambda: canopy(n=4), constraints=[CableForce("edge", 3e3)])
    assert re.search(rf"'edge' that meet at node 0, {AT}, have 3000 .* more than 1\.8\d\de\+04", words)
    assert "neither" not in words


def test_cable_of_given_geometry_is_no_weak_edge():
    structure = canopy(n=4)
    balance = ConstrainedBalance(structure, [], [CableSag("edge", 0.6)], np.eye(3), "force", lambda points, number: "")
    assert cause(structure, structure.points, as_asked(structure, balance)) == ""
    assert "neither" in cause(structure, structure.points)


def test_axis_through_a_cell_is_told():
    words = told_by("prescribed", lambda: plan((3e3, 2e3)), warp={"film": RadialDirection()})
    assert re.search(rf"'film', cell \d+ at {AT}: the axis of its warp goes through the cell", words)


def beside_an_edge(x):
    """Tell of places where no cell of the first mesh is, and one of the curved form."""
    return (np.abs(x[0]) < 0.2) & (np.abs(x[1]) > 1.5)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"warp": {"film": lambda x: np.outer(~beside_an_edge(x), [1.0, 0, 0])}}, "its warp .* vanishes there"),
        (
            {"stress": {"film": lambda x: 2e3 - 2.2e3 * beside_an_edge(x)}},
            "not positive, with a principal value of -200",
        ),
    ],
)
def test_function_of_place_that_is_unfit_on_the_way_is_told(given, words):
    told = told_by("prescribed", lambda: plan((3e3, 2e3) if "warp" in given else 2e3, 20e3, n=6), **given)
    assert re.search(rf"'film', cell \d+ at {AT}: .*{words}", told)


def test_force_that_is_found_is_told_without_a_number():
    """Two edges of four have a given sag; the weak ones beside them are told with their own force."""
    structure = canopy(force=9e3)
    cells = structure.parts["edge"].cells
    lines = lines_of(cells, np.arange(len(cells)), structure.supported.all(axis=1))
    sagging = [CableSag("edge", 0.5, line.cells) for line in lines if np.ptp(structure.points[line.nodes, 1]) > 6]
    balance = ConstrainedBalance(structure, (), sagging, np.eye(3), "force", lambda *_: "")
    words = cause(structure, structure.points, as_asked(structure, balance))
    assert re.search(r"have (9000 and a force to be found|a force to be found and 9000) over spans", words), words
