"""Long cushion of two films, inflated, sealed, and loaded on one film: the gas carries load from film to film.

Reference: closed form. Each film is an arc; with half the opening angle alpha and half the width a,

    lambda = alpha / sin(alpha),  n = lambda E'h (lambda^2 - 1) / 2,  E' = E / (1 - nu^2),  p = n sin(alpha) / a,
    sag = a (1 - cos(alpha)) / sin(alpha),  area below it = a^2 (alpha - sin(alpha) cos(alpha)) / sin(alpha)^2,

for its difference of pressure p. Boyle's law, (p + p_air) V constant, with the area of both as V, closes the equations.
Values to ten digits for a = 1.5 m, E = 8e8 Pa, h = 0.2 mm, nu = 0.43, 300 Pa and air of 101 325 Pa. The gauge pressure
in the place of the absolute one would give 258.79 instead of 116.85 Pa.
Claim: pressures, sags, forces and volume converge with second order; the strip's ends are rigid walls.
Tolerance: orders: the next term is of the relative size alpha^2 / n^2, 4e-3 on the coarsest mesh, times a constant:
0.05. Extrapolation leaves its square, 1e-5, over the ratio of meshes to the fourth power, 1/16: 1e-6.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from fx_membrane import (
    Ambient,
    Analysis,
    Chamber,
    Fabric,
    GasPressure,
    Membrane,
    Newton,
    Pressure,
    Seal,
    Stage,
    Structure,
    Support,
    rectangle,
)

SOURCE = "closed form of two arcs, and Boyle's law"

A, EH, NU, FAN, AIR = 1.5, 8e8 * 2e-4, 0.43, 300.0, 101_325.0
PLANE = EH / (1 - NU**2)
MESHES = (16, 32, 64)
# Pressure outwards on the top film; pressure inside, sag of the top and of the bottom, and their forces
CASES = {
    "suction": (500.0, 116.8544936, 0.2288585618, 0.1313032018, 3102.85776, 1008.87579),
    "snow": (-200.0, 409.9708853, 0.1596682370, 0.1996483403, 1496.18824, 2351.07316),
}


def film(p):
    """Sag, area below, and force of a film for its difference of pressure."""

    def unbalanced(alpha):
        stretch = alpha / np.sin(alpha)
        return stretch * PLANE * (stretch**2 - 1) / 2 * np.sin(alpha) / A - p

    alpha = brentq(unbalanced, 1e-6, 1.5, xtol=1e-16, rtol=1e-15)
    sine = np.sin(alpha)
    return A * (1 - np.cos(alpha)) / sine, A**2 * (alpha - sine * np.cos(alpha)) / sine**2, p * A / sine


def sealed(outwards):
    """Pressure, sags, area and forces of the sealed cushion, top first."""
    amount = (FAN + AIR) * 2 * film(FAN)[1]

    def surplus(p):
        return (p + AIR) * (film(p + outwards)[1] + film(p)[1]) - amount

    p = brentq(surplus, 1.0 + max(-outwards, 0), 1e3, xtol=1e-12)
    top, bottom = film(p + outwards), film(p)
    return np.array([p, top[0], bottom[0], amount / (p + AIR), top[2], bottom[2]])


def cushion(n, width=0.1):
    """Two flat films of n cells, two across, that share the nodes of their edges."""
    flat, cells = rectangle(2 * A, width, n, 2, "right")
    edge = np.abs(flat[:, 0]) > A * (1 - 1e-12)
    twin = np.where(edge, np.arange(len(flat)), len(flat) + np.cumsum(~edge) - 1)
    points = np.vstack([flat, flat[~edge]])
    parts = {"top": Membrane(twin[cells], Fabric(EH, NU)), "bottom": Membrane(cells, Fabric(EH, NU))}
    supports = [Support(np.flatnonzero(edge)), Support(np.arange(len(points)), "y")]
    chambers = {"gas": Chamber({"top": 1, "bottom": -1}, rigid_walls=True)}
    return Structure(points, parts, supports, separate=[("top", "bottom")], chambers=chambers)


def solve(n):
    inflate = Stage("inflate", changes=[GasPressure(FAN, "gas")])
    seal = Stage("seal", changes=[Ambient(AIR), Seal("gas")], after="inflate")
    loads = [Stage(name, [Pressure(case[0], "top")], after="seal") for name, case in CASES.items()]
    fan = Stage("fan", [Pressure(500.0, "top")], after="inflate")
    return Analysis(cushion(n), Newton(rtol=1e-12)).run([inflate, seal, *loads, fan])


def numbers(state, width=0.1):
    points, z = state.structure.points, state.displacement[:, 2]
    middle = np.abs(points[:, 0]) < 1e-12
    gas = state.chambers["gas"]
    forces = [state.membrane(name).principal[:, 0].mean() for name in ("top", "bottom")]
    sags = z[middle & (z > 0)].mean(), -z[middle & (z < 0)].mean()
    return np.array([gas.pressure, *sags, gas.volume / width, *forces])


def test_reference():
    assert film(FAN)[:2] == pytest.approx((0.1798704705, 0.3607733893), rel=1e-9)
    assert film(FAN)[2] == pytest.approx(1903.33081, rel=1e-8)
    assert film(FAN + 500.0)[::2] == pytest.approx((0.2496480208, 3704.93485), rel=2e-9)
    for outwards, *values in CASES.values():
        assert np.delete(sealed(outwards), 3) == pytest.approx(values, rel=5e-9)  # half of the last digit


def test_second_order(verified):
    runs = [solve(n) for n in MESHES]
    for name, (outwards, *_) in CASES.items():
        exact = sealed(outwards)
        values = np.array([numbers(states[name]) for states in runs])
        error = np.abs(values - exact)
        order = np.log2(error[:-1] / error[1:])
        np.testing.assert_allclose(order, 2, rtol=0, atol=0.05)
        np.testing.assert_allclose((4 * values[-1] - values[-2]) / 3, exact, rtol=1e-6)
        for i, quantity in enumerate(("pressure [Pa]", "sag of the top [m]", "sag of the bottom [m]")):
            verified(f"{quantity}, {name}", exact[i], values[-1, i], order[-1, i])
    for states in runs:
        assert states["seal"].chambers["gas"].pressure == pytest.approx(FAN, rel=1e-9)
    top = np.array([numbers(states["fan"])[1] for states in runs])
    np.testing.assert_allclose((4 * top[-1] - top[-2]) / 3, film(FAN + 500.0)[0], rtol=1e-6)


@pytest.mark.mpi
def test_one_newton_loop_converges_quadratically():
    """No outer loop: the last steps of the sealed cushion are those of Newton's method."""
    for state in solve(16).values():
        if state.name in CASES:
            residuals = [entry.residual for entry in state.increments[-1].iterations]
            assert len(residuals) <= 5
            assert min(np.divide(residuals[1:], residuals[:-1])) < 1e-4  # a full step squares the error
