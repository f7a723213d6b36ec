"""Neo-Hookean disc with a clamped edge, flat and without stress before it is inflated by a pressure that follows it.

Reference: the membrane of revolution with the meridian r(R), z(R), the stretches l1 = |(r, z)'| and l2 = r / R, and
the nominal forces T1 = Gt (l1 - 1 / (l1^3 l2^2)), T2 alike (W = Gt / 2 (l1^2 + l2^2 + (l1 l2)^-2 - 3), J. E. Adkins,
R. S. Rivlin, Phil. Trans. R. Soc. A 244 (1952) 505-531), at the angle phi to the plane:

    R T1 sin(phi) = p r^2 / 2,   (R T1 cos(phi))' = T2 - p r l1 sin(phi)

integrated from the centre, whose stretch makes r(a) = a (shooting). At p a / Gt = 1 the pole rises by 0.5312142682 a
and is stretched by 1.2001953924. The largest pressure is 1.8791734688 Gt / a, at the rise 1.1738966 a and the stretch
2.196.
A flat disc without stress has no stiffness across: the program finds a start by stabilization.
Claim: rise, stretch at the pole and largest pressure converge with second order; the path goes past the limit point.
Tolerance: orders: with 16 rings the next term, of the order h^4 in the
place of the edge, is 5 % of the error: 0.1; the extrapolation leaves that share of 1e-5 on 64 rings: 1e-6. On 32
rings, where the path ends, it leaves 16 times that.
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from fx_membrane import Analysis, Membrane, NeoHooke, Pressure, Stage, Structure, Support, equilibrium_path
from surfaces import half_disc

SOURCE = "J. E. Adkins, R. S. Rivlin 1952, by shooting"

A, GT = 0.2, 3000.0
MESHES = (16, 32, 64)
RISE, STRETCH = 0.5312142682, 1.2001953924
LARGEST, RISE_THERE, STRETCH_THERE = 1.8791734688, 1.1738966, 2.196


def meridian_stretch(T1, l2):
    """Root of l1 - 1 / (l1^3 l2^2) = T1, all in units of Gt."""
    return brentq(lambda l1: l1 - 1 / (l1**3 * l2**2) - T1, 1e-3, T1 + 5.0, xtol=1e-15)


def exact(p):
    """Rise and stretch at the pole, for the pressure p a / Gt below the limit point."""

    def slopes(R, y):
        r, H, _ = y
        V, l2 = p * r**2 / 2, r / R
        RT1 = np.hypot(H, V)
        l1 = meridian_stretch(RT1 / R, l2)
        T2 = l2 - 1 / (l2**3 * l1**2)
        return [l1 * H / RT1, T2 - p * r * l1 * V / RT1, l1 * V / RT1]

    def shoot(stretch):
        start = [stretch * 1e-5, 1e-5 * (stretch - stretch**-5), 0.0]
        return solve_ivp(slopes, (1e-5, 1.0), start, method="DOP853", rtol=1e-11, atol=1e-14).y[:, -1]

    stretch = brentq(lambda s: shoot(s)[0] - 1, 1.1, 1.3, xtol=1e-13)
    return shoot(stretch)[2], stretch


def disc(n):
    unit, triangles, rim = half_disc(n)
    symmetry = np.setdiff1d(np.flatnonzero(unit[:, 1] == 0), rim)
    return Structure(A * unit, {"disc": Membrane(triangles, NeoHooke(GT))}, [Support(rim), Support(symmetry, "y")])


def pole_stretch(structure, displacement):
    """Root of the ratio of areas around the pole."""
    around = structure.parts["disc"].cells[(structure.parts["disc"].cells == 0).any(axis=1)]

    def area(points):
        a, b, c = points[around].swapaxes(0, 1)
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()

    return np.sqrt(area(structure.points + displacement) / area(structure.points))


@cache
def blown(n):
    """State at p a / Gt = 1."""
    return Analysis(disc(n)).run([Stage("blow", [Pressure(GT / A, "disc")])])["blow"]


def second_order(values, reference, rel=1e-6):
    error = np.abs(np.array(values) - reference)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.1)
    assert (4 * values[-1] - values[-2]) / 3 == pytest.approx(reference, rel=rel)


def test_published_values():
    assert exact(1.0) == pytest.approx((RISE, STRETCH), abs=2e-9)


def test_inflated(verified):
    found = []
    for n in MESHES:
        state = blown(n)
        assert set(state.membrane("disc").state) == {"taut"}
        assert not state.remarks
        found.append((state.displacement[0, 2] / A, pole_stretch(state.structure, state.displacement)))
    rises, stretches = zip(*found, strict=True)
    second_order(rises, RISE)
    error = np.array(rises) - RISE
    verified("rise over radius", RISE, rises[-1], np.log2(error[-2] / error[-1]))
    second_order(stretches, STRETCH)


def test_largest_pressure(verified):
    factors, rises, stretches = [], [], []
    for n in MESHES[:2]:
        start = blown(n)
        more = Stage("more", [Pressure(GT / A, "disc")], increments=5, after="blow")
        path = equilibrium_path(start, more, None, (0, "z", 1.5 * A))
        assert path.complete
        assert len(path.limit_points) == 1
        limit = path.limit_points[0]
        factors.append(1 + path.load_factors[limit])
        rises.append(path.displacements[limit, 0, 2] / A)
        stretches.append(pole_stretch(start.structure, path.displacements[limit]))
        assert (path.negative_pivots[:limit] == 0).all()
        assert (path.negative_pivots[limit + 1 :] > 0).all()
    second_order(factors, LARGEST, rel=1.6e-5)
    error = np.array(factors) - LARGEST
    verified("largest pressure over Gt / a", LARGEST, factors[-1], np.log2(error[-2] / error[-1]))
    second_order(rises, RISE_THERE, rel=1e-3)
    assert (4 * stretches[-1] - stretches[-2]) / 3 == pytest.approx(STRETCH_THERE, abs=2e-3)
