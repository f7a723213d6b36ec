"""Long strip between fixed edges, bent to a cylinder by a pressure that follows it.

Reference: closed form. The section is a circular arc; with half the opening angle alpha and half the width a,

    lambda = alpha / sin(alpha),  n = lambda (N0 + E'h (lambda^2 - 1) / 2),  E' = E / (1 - nu^2),
    p = n sin(alpha) / a,         rise = a (1 - cos(alpha)) / sin(alpha).

Values to ten digits for a = 1 m, Eh = 1e6 N/m, nu = 0.3, N0 = 1e4 and 0 N/m. A flat strip without prestress has no
stiffness across and is no start; the same strip, exactly, is one stretched by s0 whose edges are let in: with
e = (s0^2 - 1) / 2 its prestress is E'h s0 e and its stiffness E'h s0^3, see test_long_strip.py.
Discrete: the consistent loads of a pressure hold a polygon of n equal segments in a circle, with the angle 2 beta
between neighbours: lambda = n sin(beta) / sin(n beta) from the chord and 2 T tan(beta) = p l from a node.
Claim: rise, force and reaction converge with second order to the closed form and equal the polygon on every mesh; the
load is the pressure on the projected area; a suction gives the mirror image.
Tolerance: orders: the next term of the error is of the relative size alpha^2 / n^2, 1e-3 on the coarsest mesh, times a
constant: 0.02. Extrapolation removes the h^2 term, 1e-2 on 8 segments and 1.6e-4 on 64; the next is of the order of its
square, 3e-8: 1e-7. Polygon: the triangles of a grid cell do not give its nodes equal shares of the pressure, which
shears the strip by less than 1e-9 where it is this narrow; Newton stops below 1e-12 of the forces, divided by the ratio
of prestress and stiffness, 1e-2, and of width and length: 1e-8.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Newton,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    rectangle,
)

SOURCE = "closed form of an arc"

A, EH, NU = 1.0, 1e6, 0.3
PLANE = EH / (1 - NU**2)
MESHES = np.array([8, 16, 32, 64])
# N0, p, rise, n
CASES = [(1e4, 1e3, 0.0438524405, 11423.8002), (1e4, 100.0, 0.00499093370, None), (0.0, 1e3, 0.0880896311, 5720.0818)]


def force(stretch, N0):
    return stretch * (N0 + PLANE * (stretch**2 - 1) / 2)


def arc(N0, p):
    """Rise, force per width, half the opening angle."""

    def unbalanced(alpha):
        return force(alpha / np.sin(alpha), N0) * np.sin(alpha) / A - p

    alpha = brentq(unbalanced, 1e-6, 1.5, xtol=1e-16, rtol=1e-15)
    return A * (1 - np.cos(alpha)) / np.sin(alpha), force(alpha / np.sin(alpha), N0), alpha


def polygon(N0, p, n):
    """Rise and force of n straight segments."""

    def stretch(beta):
        return n * np.sin(beta) / np.sin(n * beta)

    def unbalanced(beta):
        return force(stretch(beta), N0) * 2 * np.tan(beta) - p * stretch(beta) * 2 * A / n

    beta = brentq(unbalanced, 1e-7, 1.5 / n, xtol=1e-17, rtol=1e-15)
    return A * (1 - np.cos(n * beta)) / np.sin(n * beta), force(stretch(beta), N0)


def solve(N0, p, n, width=0.1):
    """End state of a strip of n grid cells, two across; without prestress, moved in from a stretched shape."""
    s0 = 1.0 if N0 else 1.002
    e = (s0**2 - 1) / 2
    points, triangles = rectangle(2 * A * s0, width, n, 2, "right")
    ends = np.flatnonzero(np.abs(points[:, 0]) > A * s0 * (1 - 1e-12))
    strip = Membrane(triangles, Fabric(EH * s0**3, NU), N0 or PLANE * s0 * e)
    structure = Structure(points, {"strip": strip}, [Support(np.arange(len(points)), "y")])
    let_in = (1 / s0 - 1) * points[ends] * [1, 0, 0]
    stages = [
        Stage(
            "pressure", loads=[Pressure(p, "strip")], displacements=[PrescribedDisplacement(ends, np.zeros(3), "xz")]
        ),
        Stage("let in", displacements=[PrescribedDisplacement(ends, let_in, "xz")], after="pressure"),
    ]
    return Analysis(structure, Newton(rtol=1e-12)).run(stages)["let in"]


def numbers(state):
    """Rise, force in the middle, and the horizontal reaction, the last two per width."""
    points = state.structure.points
    middle, end = np.abs(points[:, 0]) < 1e-12, points[:, 0] == points[:, 0].max()
    cells = state.structure.parts["strip"].cells
    beside = middle[cells].any(axis=1)
    sigma = state.membrane("strip").cauchy[beside]
    n = np.trace(sigma, axis1=1, axis2=2) - sigma[:, 1, 1]
    return np.array(
        [state.displacement[middle, 2].mean(), n.mean(), state.reactions[end, 0].sum() / np.ptp(points[:, 1])]
    )


def exact(N0, p):
    rise, n, alpha = arc(N0, p)
    return np.array([rise, n, n * np.cos(alpha)])


@pytest.mark.mpi_once
@pytest.mark.parametrize(("N0", "p", "rise", "n"), CASES)
def test_closed_form(N0, p, rise, n):
    assert arc(N0, p)[0] == pytest.approx(rise, rel=2e-9)
    assert n is None or arc(N0, p)[1] == pytest.approx(n, abs=0.5e-4)


@pytest.mark.parametrize(("N0", "p"), [case[:2] for case in CASES])
def test_second_order_to_the_closed_form(N0, p, verified):
    values = np.array([numbers(solve(N0, p, n)) for n in MESHES])
    error = np.abs(values - exact(N0, p))
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.02)
    np.testing.assert_allclose((4 * values[-1] - values[-2]) / 3, exact(N0, p), rtol=1e-7)
    verified("rise [m]", exact(N0, p)[0], values[-1, 0], np.log2(error[-2, 0] / error[-1, 0]))


@pytest.mark.parametrize(("N0", "p"), [case[:2] for case in CASES])
@pytest.mark.parametrize("n", [4, 16])
def test_every_mesh_is_the_polygon(n, N0, p):
    narrow = numbers(solve(N0, p, n))
    np.testing.assert_allclose(narrow[:2], polygon(N0, p, n), rtol=1e-8)


def test_load_is_pressure_times_projected_area():
    """The vector area depends on the boundary alone, for any mesh."""
    state = solve(1e4, 1e3, 8)
    np.testing.assert_allclose(state.equilibrium.loads[[0, 2]], [0, 1e3 * 2 * A * 0.1], rtol=0, atol=1e-10)
    np.testing.assert_allclose(state.equilibrium.reactions, -state.equilibrium.loads, rtol=0, atol=1e-8)
    np.testing.assert_allclose(state.equilibrium.reaction_moment, -state.equilibrium.load_moment, rtol=0, atol=1e-8)


@pytest.mark.mpi
def test_suction_gives_the_mirror_image():
    mirrored = solve(1e4, -1e3, 8).displacement * [1, 1, -1]
    np.testing.assert_allclose(mirrored, solve(1e4, 1e3, 8).displacement, rtol=0, atol=1e-12)
