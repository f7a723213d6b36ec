"""Stress given in projection: a cone of unequal prestress, and a canopy between arcs, against closed forms.

Cone: stress n_r(r) along radius and n_t(r) along rings, both in plan, on rings of radius a at height h and b at height
0. Equilibrium in plan demands (r n_r)' = n_t. With n_r = c / r + d it gives r n_r = c + d r, so n_t = d: positive for
    positive c and d, and unequal by c / r. Vertical equilibrium under a load q per plan area, downwards, is Pucher's
    equation, (r n_r z')' = q r. Once integrated, (c + d r) z' = q r^2 / 2 - C. Division of the polynomials gives

    z = q / 2 (r^2 / (2 d) - c r / d^2 + c^2 / d^3 ln(c + d r)) - C / d ln(c + d r) + D

    and the two heights give C and D. The ring at a is pulled down by the vertical force 2 pi (C - q a^2 / 2) of the
    meridians: (c + d r) z' there, times 2 pi. Without a load z is logarithmic; for c = 0 it is the membrane of equal
    stress in plan, for d = 0 the straight cone, whose rings carry nothing.
Canopy: equal stress N in plan balances a cable of horizontal force H along an arc of radius H / N. So a plan between
    four arcs stays as it is.
Reference: A. Pucher, Über den Spannungszustand in gekrümmten Flächen, Beton und Eisen 33 (1934) 298-304.
Claim: heights, vertical force and plan converge with second order; the hand-over does not move.
Tolerance: orders within 0.15 of 2 over the last refinement.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    PlanLoad,
    Stage,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    projected_stress,
    rectangle,
)

SOURCE = "A. Pucher 1934; arc of an edge cable"

A, B, H = 1.0, 6.0, 5.0
FABRIC = Fabric(Et=6e5, nu=0.3)


def exact(c, d, q):
    """Heights as a function of the radius, and the vertical force on the upper ring."""

    def part(r):
        return q / 2 * (r**2 / (2 * d) - c * r / d**2 + c**2 / d**3 * np.log(c + d * r))

    def log(r):
        return np.log(c + d * r) / d

    C = (H - part(A) + part(B)) / (log(B) - log(A))
    D = H - part(A) + C * log(A)
    return lambda r: part(r) - C * log(r) + D, 2 * np.pi * (C - q * A**2 / 2)


def cone(n, c, d, q):
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([r * ring for r in np.linspace(A, B, n + 1)])
    points[:around, 2] = H
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)])
    film = Membrane(triangles, FABRIC, warp=points[triangles].mean(axis=1) * [1, 1, 0])
    held = Support([*range(around), *range(n * around, (n + 1) * around)])

    def about_axis(x):
        r = np.hypot(x[0], x[1])
        return np.stack([c / r + d, np.full_like(r, d)], axis=1)

    loads = [PlanLoad((0, 0, -q), "film")]
    form = projected_stress(Structure(points, {"film": film}, [held]), loads, stress={"film": about_axis})
    assert form.converged
    return form, loads


@pytest.mark.parametrize(("c", "d", "q"), [(3e3, 1e3, 0.0), (4e3, 2e3, 400.0), (0.0, 2e3, 0.0)])
def test_cone(c, d, q, verified):
    heights, force = exact(c, d, q)
    errors = []
    for n in (8, 16, 32):
        form, loads = cone(n, c, d, q)
        radius = np.hypot(*form.points[:, :2].T)
        pull = form.reactions[: 4 * n, 2].sum()
        errors.append([np.abs(form.points[:, 2] - heights(radius)).max(), abs(pull - force)])
        state = Analysis(form.structure).run([Stage("form", loads)])["form"]
        assert np.abs(state.displacement).max() < 1e-12 * B
        assert state.reactions[: 4 * n, 2].sum() == pytest.approx(pull, rel=1e-9)
    orders = np.log2(np.array(errors)[1] / np.array(errors)[2])
    np.testing.assert_allclose(orders, 2, atol=0.15)
    verified("vertical force on a ring [N]", force, pull, orders[1])


def arcs(n, stress, force):
    flat, triangles = rectangle(2.0, 2.0, n, n)
    radius, half = force / stress, 6.0
    sag = np.sqrt(radius**2 - (half * flat[:, :2]) ** 2) - np.sqrt(radius**2 - half**2)
    points = half * flat
    points[:, :2] -= flat[:, :2] * sag[:, ::-1]
    corners = np.flatnonzero(np.abs(flat[:, 0] * flat[:, 1]) == 1)
    points[corners, 2] = 1.5 * flat[corners, 0] * flat[corners, 1]
    parts = {"film": Membrane(triangles, FABRIC, stress), "edge": Cable(boundary_edges(triangles), 2e7, force)}
    return Structure(points, parts, [Support(corners)])


@pytest.mark.mpi
def test_canopy_between_arcs_keeps_its_plan():
    moved, forces = [], []
    for n in (8, 16, 32):
        structure = arcs(n, 2e3, 30e3)
        form = projected_stress(structure)
        assert form.converged
        moved.append(np.abs(form.points - structure.points)[:, :2].max())
        edge = form.structure.parts["edge"].cells
        span = form.points[edge[:, 1]] - form.points[edge[:, 0]]
        flat = form.forces["edge"] * np.linalg.norm(span[:, :2], axis=1) / np.linalg.norm(span, axis=1)
        forces.append(np.abs(flat / 30e3 - 1).max())
        assert np.abs(Analysis(form.structure).run([Stage("form")])["form"].displacement).max() < 1e-12 * 12
    assert np.log2(moved[1] / moved[2]) == pytest.approx(2, abs=0.15)
    assert forces[-1] < 1e-3


@pytest.mark.mpi
def test_unequal_stress_balances_between_ellipses(verified):
    """Stretched by A = diag(a, 1 / a), arcs of the stress n become ellipses of the stress diag(a^2, 1 / a^2) n."""
    stress, force, a, errors = 2e3, 30e3, 1.25, []
    for n in (16, 32, 64):
        round_plan, stretch = arcs(n, stress, force), np.array([a, 1 / a, 1.0])
        cells = round_plan.parts["edge"].cells
        film = replace(round_plan.parts["film"], prestress=(a**2 * stress, stress / a**2), warp=(1, 0, 0))
        way = np.diff(round_plan.points[cells, :2], axis=1)[:, 0]
        exact = force * np.linalg.norm(way * stretch[:2], axis=1) / np.linalg.norm(way, axis=1)
        lengths = np.linalg.norm(way * stretch[:2], axis=1)
        upright = np.abs(way[:, 1]) > np.abs(way[:, 0])
        mean = np.zeros(len(cells))
        for side in (upright, ~upright):
            mean[side] = exact[side] @ lengths[side] / lengths[side].sum()
        parts = {"film": film, "edge": Cable(cells, 2e7, mean)}
        plan = replace(round_plan, points=round_plan.points * stretch, parts=parts)
        form = projected_stress(plan, cables="balanced force")
        assert form.converged
        way = np.diff(form.points[cells], axis=1)[:, 0]
        flat = form.forces["edge"] * np.linalg.norm(way[:, :2], axis=1) / np.linalg.norm(way, axis=1)
        errors.append([np.abs(form.points - plan.points)[:, :2].max(), np.abs(flat - exact).max()])
        assert np.abs(Analysis(form.structure).run([Stage("form")])["form"].displacement).max() < 1e-12 * 12
    assert np.ptp(exact) > 0.1 * force
    assert errors[-1][0] < 1e-3 * 12, errors
    orders = np.log2(np.array(errors)[1] / np.array(errors)[2])
    assert (orders > 1.8).all(), errors
    verified("least horizontal force of an edge [N]", exact.min(), flat.min(), orders[1])


@pytest.mark.parametrize(("warp", "force"), [((1, 0, 0), 30e3), ((1, 1, 0), 30e3)])
def test_remedy_named_for_unequal_stress_at_curved_edges_helps(warp, force):
    structure = arcs(12, 2e3, force)
    film = replace(structure.parts["film"], prestress=(3e3, 2e3), warp=warp)
    structure = replace(structure, parts=structure.parts | {"film": film})
    with pytest.warns(UnsettledFormWarning, match='no constant force balances .* Take cables="balanced force"'):
        form = projected_stress(structure)
    errors = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnsettledFormWarning)
        for _ in range(5):
            form = projected_stress(replace(structure, points=form.points), cables="balanced force")
            errors.append(form.steps[-1].stress_error)
    assert form.converged
    assert errors[-1] < 1e-2
    assert np.diff(errors).max() < 0


def test_balanced_force_without_tension_is_refused():
    structure = arcs(8, 2e3, 30e3)
    film, edge = replace(structure.parts["film"], prestress=(9e3, 2e3), warp=(1, 1, 0)), structure.parts["edge"]
    weak = replace(structure, parts={"film": film, "edge": replace(edge, prestress=5e3)})
    with pytest.raises(ValueError, match=r"Cable 'edge' has no tension in cell \d+ at .*; give more than"):
        projected_stress(weak, cables="balanced force")
