"""Stress prescribed as a wish, warp unlike weft, about an axis and on a soap film, against exact and independent forms.

About an axis with the slope angle p of the meridian, equilibrium is (r n_r)_s = n_t cos p along the meridian and r n_r
sin p = C. So C and p(s) make n_r = C / (r sin p) and n_t = C p_s / sin^2 p, and the nearest stress is a problem of
    least squares in p and C alone, solved here on a line, with no membrane and no mesh.
Round robin, Ex. 1: ring of diameter 4 at height 5 over a base of 14 x 14, radial 4 and circumferential 2 kN/m.
Reference: P. D. Gosling et al., Analysis and design of membrane structures: results of a round robin exercise,
    Engineering Structures 48 (2013) 313-328. Catenoid: r = a cosh(z / a), area pi (a H + a^2 sinh(H / a)).
Claim: the nearest stress is found, and area, norm and shape converge with second order. A wish that is exact, n_r = n_t
    + c / r, is met with second order. The hand-over does not move.
Tolerance: orders within 0.2 of 2 for the soap film, 0.3 and 0.5 where the coarsest mesh counts; against the line
    problem 3e-4 of the area after extrapolation, 1e-2 of the mean difference.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    OrthotropicFabric,
    RadialDirection,
    Stage,
    Structure,
    Support,
    prescribed_stress,
)
from fx_membrane.geometry.sizes import measures

SOURCE = "problem on a meridian; P. D. Gosling et al. 2013"

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")
WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)


def rings(n, inner, outer, height, material=WOVEN, prestress=1.0, levels=None):
    """Mesh between two held rings of nodes, given by functions of the angle; the inner one is lifted."""
    around = 4 * n
    angle = (np.arange(around) + 0.5) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    share = np.linspace(0, 1, n + 1)
    plan = [(1 - s) * inner(circle) + s * outer(circle) for s in share]
    heights = np.where(share == 0, height, 0.0) if levels is None else levels(share)
    points = np.concatenate([np.column_stack([p, np.full(around, z)]) for p, z in zip(plan, heights, strict=True)])
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    warp = None if material is not WOVEN else (1, 0, 0)
    film = Membrane(triangles, material, prestress, warp)
    return Structure(points, {"film": film}, [Support([*range(around), *range(n * around, (n + 1) * around)])])


def circle(radius):
    return lambda c: radius * c


def square(half):
    return lambda c: half * c / np.abs(c).max(axis=1, keepdims=True)


def mean_difference(form):
    areas = measures(form.points, form.structure.parts["film"].cells)
    wish, found = form.wish["film"], form.forces["film"]
    root = np.linalg.inv(np.sqrt(wish))  # diagonal
    return np.sqrt(areas @ np.sum((root @ found @ root - np.eye(2)) ** 2, axis=(1, 2)) / areas.sum())


def on_a_line(inner, outer, height, radial, tangential, cells=100):
    """Area and mean relative difference of the nearest stress about an axis, by least squares in the slope angle."""

    def line(x):
        angle, length, force = x[:-2], np.exp(x[-2]), np.exp(x[-1])
        step, middle = length / cells, (angle[1:] + angle[:-1]) / 2
        r = np.concatenate([[inner], inner + np.cumsum(np.cos(middle)) * step])
        r_mid = (r[1:] + r[:-1]) / 2
        n_r = force / (r_mid * np.sin(middle))
        n_t = -force * np.diff(angle) / step / np.sin(middle) ** 2
        return r, np.sum(np.sin(middle)) * step, r_mid * step, n_r, n_t

    def residual(x, weight):
        r, fall, area, n_r, n_t = line(x)
        size = np.sqrt(np.abs(area))
        ends = weight * np.array([r[-1] - outer, fall - height])
        return np.concatenate([size * (n_r / radial - 1), size * (n_t / tangential - 1), ends])

    slope = np.arctan2(height, outer - inner) + 0.3 * (0.5 - np.linspace(0, 1, cells + 1))
    x = np.concatenate([slope, [np.log(np.hypot(height, outer - inner)), np.log(radial * inner * np.sin(slope[0]))]])
    for weight in (1.0, 1e2, 1e4):
        x = least_squares(residual, x, args=(weight,), x_scale="jac", max_nfev=200).x
    _, _, area, n_r, n_t = line(x)
    squares = (n_r / radial - 1) ** 2 + (n_t / tangential - 1) ** 2
    return 2 * np.pi * area.sum(), np.sqrt(area @ squares / area.sum())


@pytest.mark.study
@pytest.mark.parametrize(("radial", "tangential", "coarsest"), [(4e3, 2e3, 4), (3e3, 3e3, 5)])
def test_nearest_stress_about_an_axis(radial, tangential, coarsest, verified):
    # The second, an isotropic wish, has no soap film between these rings: it is not exact either.
    area, mean = on_a_line(2.0, 7.0, 5.0, radial / 1e3, tangential / 1e3)
    areas, means = [], []
    for n in (coarsest, 2 * coarsest, 4 * coarsest):
        structure = rings(n, circle(2.0), circle(7.0), 5.0, prestress=(radial, tangential))
        form = prescribed_stress(structure, warp={"film": RadialDirection()}, tolerance=1e-5)
        assert form.converged
        areas.append(form.steps[-1].area)
        means.append(mean_difference(form))
    assert (4 * areas[2] - areas[1]) / 3 == pytest.approx(area, rel=3e-4)
    order = np.log2((areas[1] - areas[0]) / (areas[2] - areas[1]))
    verified("area about an axis, extrapolated [m2]", area, (4 * areas[2] - areas[1]) / 3, order)
    assert np.log2((areas[1] - areas[0]) / (areas[2] - areas[1])) == pytest.approx(2, abs=0.3)
    assert means[2] == pytest.approx(mean, rel=1e-2)


def test_wish_that_is_exact_is_met_with_second_order():
    def about_axis(x):
        r = np.hypot(x[0], x[1])
        return np.stack([2e3 / r + 2e3, np.full_like(r, 2e3)], axis=1)

    errors = []
    for n in (8, 16):
        structure = rings(n, circle(2.0), circle(7.0), 3.0, prestress=(2e3, 1e3))
        form = prescribed_stress(
            structure, stress={"film": about_axis}, warp={"film": RadialDirection()}, tolerance=1e-6
        )
        assert form.converged
        errors.append(mean_difference(form))
    assert errors[1] < 2e-3
    assert np.log2(errors[0] / errors[1]) > 1.7


def test_catenoid():
    neck, errors, areas = 9.10737994, [], []
    for n in (8, 16):
        structure = rings(n, circle(10.0), circle(10.0), 0.0, Fabric(1e3, 0.3), 2.0, levels=lambda share: 8 * share - 4)
        form = prescribed_stress(structure, tolerance=1e-6)
        middle = form.points[n // 2 * 4 * n : (n // 2 + 1) * 4 * n]
        errors.append(np.linalg.norm(middle[:, :2], axis=1).mean() - neck)
        areas.append(form.steps[-1].area - 488.379320)
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)
    assert np.log2(areas[0] / areas[1]) == pytest.approx(2, abs=0.2)


def test_round_robin_example_1():
    areas = []
    for n in (4, 8, 16):
        structure = rings(n, circle(2.0), square(7.0), 5.0, prestress=(4e3, 2e3))
        form = prescribed_stress(structure, warp={"film": RadialDirection()}, tolerance=1e-5)
        assert form.converged
        assert mean_difference(form) < 0.25
        areas.append(form.steps[-1].area)
        state = Analysis(form.structure).run([Stage("form")])["form"]
        assert np.abs(state.displacement).max() < 1e-12 * 14
    # The same from a mesh lifted as a cone.
    lifted = rings(8, circle(2.0), square(7.0), 5.0, prestress=(4e3, 2e3), levels=lambda share: 5 * (1 - share))
    again = prescribed_stress(lifted, warp={"film": RadialDirection()}, tolerance=1e-5)
    assert again.steps[-1].area == pytest.approx(areas[1], rel=abs(areas[2] - areas[1]) / areas[1])
    assert np.log2((areas[1] - areas[0]) / (areas[2] - areas[1])) == pytest.approx(2, abs=0.5)


@pytest.mark.mpi
def test_form_of_a_form_is_that_form():
    structure = rings(8, circle(2.0), square(7.0), 5.0, prestress=(4e3, 2e3))
    one = prescribed_stress(structure, warp={"film": RadialDirection()}, tolerance=1e-6)
    other = prescribed_stress(replace(structure, points=one.points), warp={"film": RadialDirection()}, tolerance=1e-6)
    assert other.steps[-1].area == pytest.approx(one.steps[-1].area, rel=1e-9)
    assert other.points == pytest.approx(one.points, abs=1e-8 * 14)
