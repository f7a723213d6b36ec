"""Masts of given length in stays of given force stand in balance in every method, or the lack is told."""

import re
import warnings
from functools import partial

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    RigidBody,
    Stage,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.masts import standing_masts

METHODS = {
    "projection": partial(projected_stress, cables="force"),
    "natural": partial(natural_force_density, iterations=5),
    "updated": updated_reference,
    "prescribed": prescribed_stress,
}
FEET = np.array([(-5, 0, 0), (5, 0, 0), (-9, -3, 0), (-9, 3, 0), (9, -3, 0), (9, 3, 0.0)])
COLLECTIVE = "updated"  # processes share its work; the others are run by each
STAYS = [(2, 0), (3, 0), (4, 1), (5, 1)]  # foot and head of each


def sail(unit, force):
    """Make a hypar between two low points and two heads, held; with its heads."""
    points, triangles = rectangle(8.0, 8.0, 6, 6)
    points = points @ [[0.7, 0.7, 0], [-0.7, 0.7, 0], [0, 0, 1]]
    low, high = np.argsort(points[:, 1])[[0, -1]], np.argsort(points[:, 0])[[0, -1]]
    points[high, 2] = 4.0
    parts = {
        "sail": Membrane(triangles, Fabric(4e5 * force / unit, 0.3), 2e3 * force / unit),
        "edge": Cable(boundary_edges(triangles), 1e7 * force, 2e4 * force),
    }
    return Structure(points * unit, parts, [Support(low), Support(high)]), high


def on_masts(pull, unit=1.0, force=1.0):
    """Make the same on masts of given length, in stays of given force; with the rigid bodies."""
    held, high = sail(unit, force)
    n = len(held.points)
    parts = {
        **held.parts,
        "stays": Cable([[n + foot, high[head]] for foot, head in STAYS], 1e7 * force, np.multiply(pull, force)),
        "masts": Mast([[n, high[0]], [n + 1, high[1]]], 1e8 * force),
    }
    points = np.concatenate([held.points, FEET * unit])
    structure = Structure(points, parts, [held.supports[0], Support(np.arange(n, n + 6))])
    return structure, [RigidBody([n, high[0]]), RigidBody([n + 1, high[1]])], high


def found(find, *args, **settings):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        form = find(*args, **settings)
    return form, " ".join(str(each.message) for each in told if each.category is UnsettledFormWarning)


def moved(form, loads=()):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    return state.largest_displacement / np.ptp(form.points, axis=0).max()


@pytest.mark.parametrize(
    "method", [pytest.param(method, marks=pytest.mark.mpi if method == COLLECTIVE else ()) for method in METHODS]
)
def test_forces_that_balance_at_the_first_places_keep_them(method):
    held, high = sail(1.0, 1.0)
    form, _ = found(METHODS[method], held)
    n = len(held.points)
    masts, stays = Mast([[n, high[0]], [n + 1, high[1]]], 1e8), Cable([[n + a, high[b]] for a, b in STAYS], 1e7)
    guyed = masts_and_stays(form, {"masts": masts, "stays": stays}, FEET)
    structure, bodies, _ = on_masts(guyed.forces["stays"])
    standing, words = found(METHODS[method], structure, constraints=bodies)
    assert "turned" not in words
    assert standing.points == pytest.approx(guyed.points, abs=1e-5)
    for name in ("masts", "stays"):
        assert standing.forces[name] == pytest.approx(guyed.forces[name], rel=1e-4)
    assert standing.reactions == pytest.approx(guyed.reactions, abs=1e-4 * np.abs(guyed.reactions).max())
    assert moved(standing) <= 1e-12


@pytest.mark.parametrize(
    ("method", "unit", "force", "load"),
    [
        ("projection", 1.0, 1.0, 0.0),
        ("natural", 1e3, 1e-3, 0.0),  # mm and kN
        ("updated", 1.0, 1.0, 100.0),
        ("prescribed", 1.0, 1.0, 0.0),
    ],
)
def test_heads_move_to_where_other_forces_balance(method, unit, force, load):
    structure, bodies, high = on_masts([22e3, 27e3, 24e3, 24e3], unit, force)
    loads = [DistributedLoad((0, 0, -load), "sail")] if load else []
    form, words = found(METHODS[method], structure, loads, constraints=bodies)
    assert "turned" not in words
    length = np.linalg.norm(form.points[high] - FEET[:2] * unit, axis=1)
    assert length == pytest.approx(np.linalg.norm(structure.points[high] - FEET[:2] * unit, axis=1), rel=1e-12)
    assert form.points[high, 2].min() > 3.5 * unit
    assert form.forces["stays"] == pytest.approx(structure.parts["stays"].prestress_tensors().ravel(), rel=1e-3)
    assert form.forces["masts"].max() < -4e4 * force
    assert moved(form, loads) <= 1e-12


@pytest.mark.parametrize("method", ["projection", "natural", "prescribed"])
def test_forces_that_balance_nowhere_near_are_told_with_the_missing_one(method, monkeypatch):
    monkeypatch.setattr(standing_masts, "MAX_MOVES", 4)  # of places for the heads: 20 find none, either
    structure, bodies, _ = on_masts(100e3)
    form, words = found(METHODS[method], structure, constraints=bodies)
    assert not form.converged
    assert re.search(
        r"With all mast heads in their first places, the force \(.*\) is missing across the mast at", words
    )
    assert moved(form) <= 1e-12
