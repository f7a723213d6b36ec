"""Soap films: form finding with isotropic stress gives minimal surfaces, whose areas are known.

References:
    Catenoid between rings of radius 10: r = a cosh(z / a), neck a, area pi (a H + a^2 sinh(H / a)); axial force in
    the film 2 pi a N. Scherk's first surface z = ln(cos x / cos y) and the helicoid (r cos t, r sin t, t): areas
    by integration of sqrt(1 + z,x^2 + z,y^2) and of sqrt(1 + r^2). Sail over a square with four straight edges between
    corners at +-1: Schwarz's surface D, area 5.11704628468404 (H. A. Schwarz, Gesammelte Mathematische Abhandlungen I).
Claim: the area converges with second order, as that of any interpolating triangulation; the shape is in equilibrium
    with the stress found, so that the analysis of it does not move (hand-over).
Tolerance: orders within 0.1 of 2 over the last two refinements; extrapolated areas to 2e-4, where the fourth-order term
    left over on these meshes is.
"""

from functools import cache

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    force_density,
    rectangle,
    updated_reference,
)

SOURCE = "catenoid, Scherk, helicoid; H. A. Schwarz"

STRESS = 2.0


def grid(n, shape):
    """Square grid on which a map (s, t) in [-1, 1]^2 -> space gives the boundary; inside, an even net."""
    flat, triangles = rectangle(2.0, 2.0, n, n, "right")
    edge = np.unique(boundary_edges(triangles))
    points = shape(flat[:, 0], flat[:, 1])
    branches = np.unique(
        np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])), axis=0
    )
    return force_density(points, branches, 1.0, [Support(edge)]).points, triangles, edge


def scherk(n):
    return grid(n, lambda x, y: np.stack([x, y, np.log(np.cos(x) / np.cos(y))], axis=1))


def sail(n):
    return grid(n, lambda x, y: np.stack([x, y, x * y], axis=1))


def helicoid(n):
    def shape(s, t):
        r, angle = (s + 1) / 2, (t + 1) * np.pi / 4
        return np.stack([r * np.cos(angle), r * np.sin(angle), angle], axis=1)

    return grid(n, shape)


def catenoid(n, height=8.0):
    """Catenoid form: the start is a cylinder between the rings."""
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    z = np.linspace(-height / 2, height / 2, n + 1)
    ring = np.stack([10 * np.cos(angle), 10 * np.sin(angle)], axis=1)
    points = np.concatenate([np.column_stack([ring, np.full(around, level)]) for level in z])
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)])
    return points, triangles, np.r_[np.arange(around), n * around + np.arange(around)]


EXACT = {
    scherk: 5.6975122116,
    sail: 5.11704628468404,
    helicoid: np.pi / 4 * (np.sqrt(2) + np.arcsinh(1)),
    catenoid: 488.379320,
}


@cache
def found(surface, n, tolerance=1e-3):
    points, triangles, edge = surface(n)
    film = Membrane(triangles, Fabric(1e3, 0.3), prestress=STRESS)
    form = updated_reference(
        Structure(points, {"film": film}, [Support(edge)]), tolerance=tolerance, max_iterations=400
    )
    assert form.converged
    return form


@pytest.mark.parametrize("surface", [scherk, sail, helicoid, catenoid])
def test_area_converges_with_second_order(surface, verified):
    areas = np.array([found(surface, n).steps[-1].area for n in (8, 16, 32)])
    errors = areas - EXACT[surface]
    orders = np.log2(errors[:-1] / errors[1:])
    np.testing.assert_allclose(orders, 2, atol=0.1)
    assert (4 * areas[2] - areas[1]) / 3 == pytest.approx(EXACT[surface], rel=2e-4)
    verified(f"area: {surface.__name__} [m2]", EXACT[surface], areas[2], orders[-1])


@pytest.mark.mpi_once
@pytest.mark.parametrize("surface", EXACT)
def test_hand_over(surface):
    form = found(surface, 16)
    state = Analysis(form.structure).run([Stage("hand-over")])["hand-over"]
    assert np.abs(state.displacement).max() < 1e-12 * np.ptp(form.structure.points)


@pytest.mark.study
@pytest.mark.parametrize(("height", "neck"), [(8.0, 9.10737994), (12.0, 7.45071090)])
def test_neck_and_force_of_the_catenoid(height, neck):
    # The area is stationary, the neck is not: it asks for a tighter tolerance. Close to the critical height coarser
    # meshes are not yet in the asymptotic range.
    necks, forces = [], []
    for n in (16, 32):
        form = found(lambda size: catenoid(size, height), n, tolerance=1e-6)
        state = Analysis(form.structure).run([Stage("hand-over")])["hand-over"]
        middle = form.structure.points[n // 2 * 4 * n : (n // 2 + 1) * 4 * n]
        necks.append(np.linalg.norm(middle[:, :2], axis=1).mean())
        forces.append(state.reactions[-4 * n :, 2].sum())
    for values, exact in ((necks, neck), (forces, 2 * np.pi * neck * STRESS)):
        errors = np.array(values) - exact
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


def test_no_catenoid_between_rings_too_far_apart():
    # None exists for height / radius above 1.3254868 (Goldschmidt): the film collapses to two discs.
    points, triangles, edge = catenoid(8, 14.0)
    film = Membrane(triangles, Fabric(1e3, 0.3), prestress=STRESS)
    structure = Structure(points, {"film": film}, [Support(edge)])
    try:
        form = updated_reference(structure)
    except (RuntimeError, ValueError):
        return
    middle = form.structure.points[4 * 32 : 5 * 32]
    assert not form.converged or np.linalg.norm(middle[:, :2], axis=1).mean() < 1.0
