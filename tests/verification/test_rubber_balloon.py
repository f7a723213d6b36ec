"""Balloon of a foil: a sphere under inner pressure, past its largest pressure, and with Mooney-Rivlin past its least.

Reference: closed form (R. W. Ogden, Non-Linear Elastic Deformations (1984), 5.3.2; thin wall). A sphere of the radius R
that stretches by l carries the nominal force T = 2 (l - l^-5) (C10 + C01 l^2) per length in all directions, and

    p = 2 T / (l^2 R) = 4 / R (1 / l - l^-7) (C10 + C01 l^2).

Neo-Hooke: largest at l = 7^(1/6). Mooney-Rivlin with C01 = C10 / 10: largest and least where the derivative is zero.
A sphere without stress is filled to l = 1.1 first, or begins the path itself.
Claim: limit pressures, and the pressure at the mean stretch of the last point beyond them, converge with second order;
negative pivots tell the branches apart.
Tolerance: orders: the next term has the relative size of the error, 2e-2 on the coarsest mesh: 0.05. The extrapolated
values leave the square of the error of the coarser mesh, 2e-5 and with the other mesh half of that: 1e-4.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from balloons import eighth_of_a_balloon
from fx_membrane import (
    Analysis,
    MooneyRivlin,
    NeoHooke,
    Pressure,
    Stage,
    equilibrium_path,
)

SOURCE = "R. W. Ogden, Non-Linear Elastic Deformations, 1984, 5.3.2"

R, C10 = 2.0, 1500.0
LAWS = {"neo-Hooke": (NeoHooke(2 * C10), 0.0), "Mooney-Rivlin": (MooneyRivlin(C10, C10 / 10), C10 / 10)}
MESHES = (6, 12, 24)


def pressure(stretch, c01):
    return 4 / R * (1 / stretch - stretch**-7) * (C10 + c01 * stretch**2)


def slope(stretch, c01, h=1e-6):
    return (pressure(stretch + h, c01) - pressure(stretch - h, c01)) / (2 * h)


def limits(c01):
    """Stretches at the largest and, if there is one, the least pressure."""
    largest = brentq(slope, 1.1, 2.0, args=(c01,), xtol=1e-12)
    return [largest, brentq(slope, 2.0, 6.0, args=(c01,), xtol=1e-12)] if c01 else [largest]


def sphere(law, n):
    """Octant of a sphere without stress, and its pole."""
    structure = eighth_of_a_balloon(n, law, radius=R)
    return structure, int(np.argmax(structure.points[:, 2]))


def inflated(law, c01, n, stretch):
    """Path from the sphere filled to l = 1.1 to a pole moved outwards to a stretch, and the pressures on it."""
    structure, pole = sphere(law, n)
    full = Pressure(pressure(1.1, c01), "balloon")
    start = Analysis(structure).run([Stage("fill", [full])])["fill"]
    assert set(start.membrane("balloon").state) == {"taut"}
    stage = Stage("blow", [Pressure(C10 / R, "balloon")], increments=10, after="fill")
    path = equilibrium_path(start, stage, None, (pole, "z", (stretch - 1) * R))
    assert path.complete
    return path, full.pressure + path.load_factors * C10 / R


def mean_stretch(path, point):
    """Stretch of the sphere of the same volume, over that of the mesh at rest."""

    def volume(x):
        a, b, c = x[path.structure.parts["balloon"].cells].swapaxes(0, 1)
        return np.sum(np.cross(b - a, c - a) * a)

    return np.cbrt(abs(volume(path.structure.points + path.displacements[point]) / volume(path.structure.points)))


@pytest.fixture(scope="module", params=LAWS)
def paths(request):
    """Constant of the second invariant, paths and their pressures."""
    law, c01 = LAWS[request.param]
    return c01, [inflated(law, c01, n, 4.5 if c01 else 3.0) for n in MESHES]


def second_order(values, reference):
    error = np.abs(np.array(values) - reference)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.05)
    np.testing.assert_allclose((4 * values[-1] - values[-2]) / 3, reference, rtol=1e-4)


def test_pressure_beyond_the_limit_points(paths):
    c01, found = paths
    second_order([values[-1] / pressure(mean_stretch(path, -1), c01) for path, values in found], 1.0)


def test_limit_points(paths, verified):
    c01, found = paths
    expected = limits(c01)
    assert c01 or expected[0] == pytest.approx(7 ** (1 / 6), rel=1e-9)
    assert all(len(path.limit_points) == len(expected) for path, _ in found)
    limit = [values[path.limit_points] for path, values in found]
    exact = [pressure(stretch, c01) for stretch in expected]
    second_order(limit, exact)
    error = np.array(limit)[:, 0] - exact[0]
    verified("largest pressure [Pa]", exact[0], limit[-1][0], np.log2(error[-2] / error[-1]))


def test_balloon_is_unstable_where_the_pressure_falls(paths):
    for path, values in paths[1]:
        falls = np.gradient(values) < -0.01 * C10 / R
        rises = np.gradient(values) > 0.01 * C10 / R
        assert (path.negative_pivots[falls] > 0).all()
        assert (path.negative_pivots[rises] == 0).all()


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", LAWS)
def test_path_from_the_sphere_without_stress(name):
    """The same largest pressure as from the filled sphere, where the pressure is flat: 1e-8."""
    law, c01 = LAWS[name]
    structure, pole = sphere(law, 6)
    stage = Stage("blow", [Pressure(C10 / R, "balloon")], increments=10)
    path = equilibrium_path(structure, stage, None, (pole, "z", R))
    filled, values = inflated(law, c01, 6, 2.0)
    assert path.complete
    assert len(path.limit_points) == 1
    np.testing.assert_allclose(path.load_factors[path.limit_points] * C10 / R, values[filled.limit_points], rtol=1e-8)
