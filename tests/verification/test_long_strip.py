"""Straight cable, and long strip bent to a cylinder, under a uniform distributed load across them; a hanging cable.

Reference: closed form up to a quadrature. Let X be the reference length, q the load per reference length downwards. The
force in the cable has the constant horizontal part H and the vertical part V = q (L/2 - X), the magnitude
N = sqrt(H^2 + V^2) = (N0 + EA (lambda^2 - 1) / 2) lambda, and is tangent to the cable, so

    span = int lambda H / N dX (fixes H),   sag = int_0^(L/2) lambda V / N dX,   energy = int w - lambda V^2 / N dX

with the energy density w = N0 E + EA E^2 / 2, the work of the load integrated by parts. A strip whose width cannot
change is the same with N0 per width and Et / (1 - nu^2) for EA. Evaluated by brentq and quad to 1e-12.
Discrete: with consistent nodal loads the force in each straight element is the one above at its midpoint, so the
discrete solution is the same with the midpoint rule for the integrals.

Hanging cable: the data of code_aster's validation case SSNL114 (span = unstressed length 325 m, area 2.2783e-4 m2,
E 5.7e10 Pa, 2844.23 kg/m3, g 9.81). The elastic catenary (H. M. Irvine, Cable Structures, ch. 1), whose force is
EA (lambda - 1), has span = H L/EA + 2 H/q asinh(q L / 2 H) and sag = q L^2/(8 EA) + (sqrt(H^2 + (q L/2)^2) - H)/q, here
6.352161 m and 13206.24 N; code_aster computes 6.35356 m. Saint Venant-Kirchhoff is another law: at the strain e it is
stiffer by 3/2 e, H goes with the cube root of the stiffness and the sag with 1/H, so both differ by e/2 = 5.09e-4.

Claim: sag, horizontal force and energy converge with second order to the closed form, and equal the midpoint rule on
every mesh; the hanging cable differs from the catenary by the difference of the laws.
Tolerance: midpoint rule: Newton stops below 1e-10 of the forces, 1e-9. Orders: the next term of the midpoint rule is
h^4, the order on the meshes at hand is within 0.03 of 2. Extrapolation: the h^2 term is at most 1e-2 of the value on
the coarsest mesh, with elements eight times as long as the finest; the h^4 term, of the order of its square, is 1e-4
there and 8^4 times less at the end, 2e-8, four times that after the extrapolation: 1e-7.
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Newton,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)

SOURCE = "funicular curve by quadrature; H. M. Irvine, Cable Structures"

L, SPAN, N0, EA, Q = LOADED = (10.0, 10.0, 100.0, 2000.0, 60.0)
NU = 0.3
MESHES = (8, 16, 32, 64)

LENGTH, AXIAL, WEIGHT = 325.0, 5.7e10 * 2.2783e-4, 2844.23 * 9.81 * 2.2783e-4  # m, N, N/m
HANGING = (LENGTH, LENGTH, 0.0, AXIAL, WEIGHT)


def closed_form(cable, integrate):
    """Sag, horizontal force and energy, by a rule for integrals from 0 to L/2."""
    L, span, N0, EA, q = cable

    def at(H, X):
        V = q * (L / 2 - X)
        N = np.hypot(H, V)
        s = brentq(lambda s: (N0 + EA * (s**2 - 1) / 2) * s - N, 0.5, 10, xtol=1e-15, rtol=1e-14)
        E = (s**2 - 1) / 2
        return s * H / N, s * V / N, N0 * E + EA * E**2 / 2 - s * V**2 / N

    def integral(H, which):
        return integrate(lambda X: at(H, X)[which])

    H = brentq(lambda H: 2 * integral(H, 0) - span, 1e-3 * q * L, 100 * q * L, xtol=1e-13, rtol=1e-14)
    return np.array([integral(H, 1), H, 2 * integral(H, 2)])


def exact(cable):
    return closed_form(cable, lambda f: quad(f, 0, cable[0] / 2, epsabs=1e-13, epsrel=1e-13)[0])


def midpoint_rule(cable, n):
    h = cable[0] / n
    middles = (np.arange(n // 2) + 0.5) * h
    return closed_form(cable, lambda f: h * sum(f(X) for X in middles))


def elastic_catenary(cable):
    """Sag and horizontal force for N = EA (lambda - 1)."""
    L, span, _, EA, q = cable
    H = brentq(lambda H: H * L / EA + 2 * H / q * np.arcsinh(q * L / (2 * H)) - span, q * L, 100 * q * L, xtol=1e-9)
    return np.array([q * L**2 / (8 * EA) + (np.hypot(H, q * L / 2) - H) / q, H])


def orders(values, reference):
    error = np.abs(values - reference)
    return np.log2(error[:-1] / error[1:])


def extrapolate(values):
    return (4 * values[-1] - values[-2]) / 3


def chain(n, length):
    points = np.zeros((n + 1, 3))
    points[:, 0] = np.linspace(0, length, n + 1)
    return points, np.stack([np.arange(n), np.arange(1, n + 1)], axis=-1)


def solve_cable(n):
    points, cells = chain(n, L)
    structure = Structure(points, {"cable": Cable(cells, EA, N0)}, [Support([0, n])])
    state = Analysis(structure).run([Stage("load", loads=[DistributedLoad((0.0, 0.0, -Q), "cable")])])["load"]
    return np.array([-state.displacement[n // 2, 2], state.reactions[n, 0], state.energy])


def solve_strip(n):
    """Solve for a strip of two grid cells and 0.5 m across; return forces and energy per width."""
    width, Et = 0.5, EA * (1 - NU**2)
    points, triangles = rectangle(L, width, n, 2, "right")
    end = np.abs(points[:, 0]) == L / 2
    supports = [Support(np.flatnonzero(end)), Support(np.arange(len(points)), "y")]
    structure = Structure(points, {"strip": Membrane(triangles, Fabric(Et, NU), N0)}, supports)
    state = Analysis(structure).run([Stage("load", loads=[DistributedLoad((0.0, 0.0, -Q), "strip")])])["load"]
    middle = state.displacement[points[:, 0] == 0, 2]
    assert np.ptp(middle) < 1e-9 * np.abs(middle).max()  # a cylinder
    return np.array([-middle[0], state.reactions[points[:, 0] == L / 2, 0].sum() / width, state.energy / width])


@pytest.mark.parametrize("solve", [solve_cable, solve_strip])
def test_second_order_to_the_closed_form(solve, verified):
    values, reference = np.array([solve(n) for n in MESHES]), exact(LOADED)
    assert reference[0] > 0.2 * L  # large displacements
    np.testing.assert_allclose(orders(values, reference), 2, rtol=0, atol=0.03)
    np.testing.assert_allclose(extrapolate(values), reference, rtol=1e-7)
    verified("sag of a cable and of a strip [m]", reference[0], values[-1, 0], orders(values, reference)[-1, 0])


@pytest.mark.mpi_once
@pytest.mark.parametrize("n", [4, 16])
@pytest.mark.parametrize("solve", [solve_cable, solve_strip])
def test_every_mesh_is_the_midpoint_rule(solve, n):
    np.testing.assert_allclose(solve(n), midpoint_rule(LOADED, n), rtol=1e-9)


@cache
def hang_cable(n, s0=1.002):
    """Sag and horizontal force of the hanging cable, whose reference shape is stretched by s0 and then let in.

    A straight cable without force has no stiffness across, so the unstressed shape is no start. The energy EA E0^2 / 2
    per unstressed length, with E0 = e + s0^2 E and e = (s0^2 - 1) / 2, is, per length stretched by s0 and up to a
    constant, N E + EA s0^3 E^2 / 2 with the prestress N = EA s0 e: the same cable, exactly.
    """
    points, cells = chain(n, s0 * LENGTH)
    cable = Cable(cells, AXIAL * s0**3, prestress=AXIAL * s0 * (s0**2 - 1) / 2)
    structure = Structure(points, {"cable": cable}, [Support(0)])
    hold = PrescribedDisplacement(n, (0.0, 0.0, 0.0))
    let_in = PrescribedDisplacement(n, ((1 - s0) * LENGTH, 0.0, 0.0))
    stages = [
        Stage("weight", loads=[DistributedLoad((0.0, 0.0, -WEIGHT / s0), "cable")], displacements=[hold]),
        Stage("span", displacements=[let_in], increments=4, after="weight"),
    ]
    state = Analysis(structure, Newton(rtol=1e-11)).run(stages)["span"]
    return np.array([-state.displacement[n // 2, 2], state.reactions[n, 0]])


def test_hanging_cable_converges_with_second_order():
    values, reference = np.array([hang_cable(n) for n in MESHES]), exact(HANGING)[:2]
    np.testing.assert_allclose(orders(values, reference), 2, rtol=0, atol=0.03)
    np.testing.assert_allclose(extrapolate(values), reference, rtol=1e-7)


def test_hanging_cable_against_the_elastic_catenary_and_code_aster():
    sag, H = catenary = elastic_catenary(HANGING)
    assert sag == pytest.approx(6.352161, abs=0.5e-6)
    assert pytest.approx(13206.24, abs=0.5e-2) == H
    difference = H / AXIAL / 2 * np.array([-1, 1])
    values = extrapolate(np.array([hang_cable(n) for n in MESHES[-2:]]))
    # Left out are terms of the order of the strain times the squared slope of the cable, 1e-3 times 6e-3.
    np.testing.assert_allclose(values / catenary - 1, difference, rtol=0, atol=5e-6)
    # The difference of the laws, 5e-4, and the mesh of code_aster, 2e-4.
    assert values[0] == pytest.approx(6.35356, rel=1e-3)


@pytest.mark.parametrize("s0", [1.001, 1.004])
def test_hanging_cable_does_not_depend_on_the_reference_shape(s0):
    np.testing.assert_allclose(hang_cable(10, s0), midpoint_rule(HANGING, 10)[:2], rtol=1e-9)
