"""Long tube under inner pressure that keeps its length.

Reference: closed form. A cylinder of the radius R that stretches by lambda around and not along carries lambda S
around, per length along the axis, with S = N0 + E'h (lambda^2 - 1) / 2 and E' = E / (1 - nu^2). On the current radius
lambda R that holds p = S / R. Along the axis it carries (N0 + nu E'h (lambda^2 - 1) / 2) / lambda per length around.
Discrete: n equal segments around are a regular polygon with 2 T tan(pi/n) = p l for a node; the chord is
l = 2 lambda R sin(pi/n) and T = lambda S, so S = p R cos(pi/n).
Claim: the polygon on every mesh, so second order to the closed form; the ends are held along the axis by the force
above; the nodes that keep the tube in its place have no reactions.
Tolerance: the triangles of a grid cell do not give its nodes equal shares of the pressure. At the ends that comes to
forces along the edge of p b/6 times the angle between segments, with the length b of a cell along the axis; they shear
the tube at hand by 1e-3 at most, and radius and forces change by the square: 1e-6. Reactions: Newton stops below 1e-12
of the forces. Orders: the next term of cos(pi/n) and of the square root is (pi/n)^2 of the first: 0.02.
"""

import numpy as np
import pytest

from fx_membrane import Analysis, Fabric, Membrane, Newton, Pressure, Stage, Structure, Support, rectangle

SOURCE = "closed form, p = S / R"

R, LENGTH, EH, NU, N0 = 1.5, 0.02, 5e4, 0.3, 1e3
PLANE = EH / (1 - NU**2)
STRETCHES = (1.0, 1.05, 1.4)


def hoop(stretch):
    """S around."""
    return N0 + PLANE * (stretch**2 - 1) / 2


def tube(n, rows=2):
    """Grid rolled to a regular polygon with n corners; z is the axis, normals point outwards."""
    flat, triangles = rectangle(2 * np.pi, LENGTH, n, rows, "right")
    angle = flat[:, 0]
    points = np.stack([R * np.cos(angle), R * np.sin(angle), flat[:, 1]], axis=-1)
    row, column = np.divmod(np.arange(len(flat)), n + 1)
    joined = row * n + column % n
    kept = column < n
    return points[kept], joined[triangles]


def inflate(n, stretch, rows=2):
    points, cells = tube(n, rows)
    # The foot of one generator cannot move, that of the opposite one only away from it.
    supports = [Support(np.arange(len(points)), "z"), Support(0, "xy"), Support(n // 2, "y")]
    structure = Structure(points, {"tube": Membrane(cells, Fabric(EH, NU), N0)}, supports)
    first = Pressure(hoop(1.0) / R, "tube")
    more = Pressure((hoop(stretch) - hoop(1.0)) / R, "tube")
    stages = [Stage("fill", loads=[first]), Stage("inflate", loads=[more], increments=2, after="fill")]
    return Analysis(structure, Newton(rtol=1e-12)).run(stages)["inflate"]


@pytest.mark.mpi_once
@pytest.mark.parametrize("stretch", STRETCHES)
def test_radius_and_force_along(stretch, verified):
    error = []
    for n in (12, 24, 48):
        state = inflate(n, stretch)
        x, y, z = (state.position - state.position.mean(axis=0)).T
        E = (hoop(stretch) * np.cos(np.pi / n) - N0) / PLANE
        np.testing.assert_allclose(np.hypot(x, y), R * np.sqrt(1 + 2 * E), rtol=1e-6)
        error.append(np.hypot(x, y).mean() / R - stretch)

        along = (N0 + NU * PLANE * E) * n * 2 * R * np.sin(np.pi / n)
        top = z > z.max() - 1e-9
        assert state.reactions[top, 2].sum() == pytest.approx(along, rel=1e-6)
        assert np.abs(state.reactions[:, :2]).max() < 1e-9 * N0 * R
        sigma, stretch_around = state.membrane("tube").cauchy, np.sqrt(1 + 2 * E)
        np.testing.assert_allclose(sigma[:, 2, 2], (N0 + NU * PLANE * E) / stretch_around, rtol=1e-6)
        around = np.trace(sigma, axis1=1, axis2=2) - sigma[:, 2, 2]
        np.testing.assert_allclose(around, stretch_around * (N0 + PLANE * E), rtol=1e-6)
    np.testing.assert_allclose(np.log2(np.divide(error[:-1], error[1:])), 2, rtol=0, atol=0.02)
    verified("stretch around", stretch, stretch + error[-1], np.log2(error[-2] / error[-1]))
