"""Square prestressed membrane with fixed edges under a uniform distributed load across it.

Reference: for small loads the linear membrane equation N0 (w,xx + w,yy) = -q. Its solution as a Fourier series in x
with hyperbolic functions in y (Prandtl's stress function of a square bar in torsion: Timoshenko and Goodier, Theory of
Elasticity, chapter on torsion, rectangular bars) gives, with sums over odd n,

    w(centre)     = q a^2 / N0 (1/8 - 4/pi^3 sum (-1)^((n-1)/2) / (n^3 cosh(n pi/2)))   = 0.0736714 q a^2 / N0
    integral of w = q a^4 / N0 (1/12 - 16/pi^5 sum tanh(n pi/2) / n^5)                  = 0.0351443 q a^4 / N0

and the energy -q/2 times the integral; four times the integral is the book's torsion constant of a square, 0.1406. For
large loads the order of convergence is observed by itself.
Claim: centre deflection and energy converge with second order to the series where the load is small, and with second
order to some limit where the deflection is a tenth of the side. Exception: with diagonals to the centre, the node there
belongs to eight triangles and not to six and gets q h^2/3 too much of the load. On both patterns linear triangles make
the five-point difference operator, so this alone makes the difference between them, q h^2/3 times the value of Green's
function at the load, which grows by log(2) / (2 pi N0) when h is halved: the order is h^2 log(1/h) in that node.
Tolerance: the small load is such that the neglected nonlinear part is of relative size Et/N0 (pi w/a)^2, 3e-10, far
below the error of the mesh. Observed orders approach 2 with the next terms of the error, of the relative size h^2
log(1/h), 0.03 on the coarsest mesh: 2 within 0.05. The extrapolation (4 fine - coarse) / 3 removes the h^2 term; the
rest is of the order (h/a)^4 log(a/h), 3e-7 at h/a = 1/64, times a constant: 1e-5.
"""

from functools import cache

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

SOURCE = "Timoshenko, Goodier, Theory of Elasticity, torsion"

N0, ET, A = 1.0, 50.0, 1.0
MESHES = np.array([8, 16, 32, 64])
SMALL, LARGE = 1e-5, 4.0
ODD = np.arange(1, 400, 2)


@cache
def solve(q, n, diagonals):
    """Centre deflection and energy."""
    points, triangles = rectangle(A, A, n, n, diagonals)
    membrane = Membrane(triangles, Fabric(ET, 0.3), N0)
    structure = Structure(points, {"membrane": membrane}, [Support(np.unique(boundary_edges(triangles)))])
    state = Analysis(structure).run([Stage("load", loads=[DistributedLoad((0.0, 0.0, -q), "membrane")])])["load"]
    return -state.displacement[(n + 1) * (n // 2) + n // 2, 2], state.energy


def on_all_meshes(q, diagonals):
    return np.array([solve(q, int(n), diagonals) for n in MESHES])


def linear_solution(q):
    """Centre deflection and energy of the linear membrane."""
    with np.errstate(over="ignore"):
        centre = 1 / 8 - 4 / np.pi**3 * np.sum((-1.0) ** (ODD // 2) / (ODD**3 * np.cosh(ODD * np.pi / 2)))
    integral = 1 / 12 - 16 / np.pi**5 * np.sum(np.tanh(ODD * np.pi / 2) / ODD**5.0)
    return np.array([q * A**2 / N0 * centre, -(q**2) * A**4 / N0 * integral / 2])


def extrapolate(values):
    return (4 * values[-1] - values[-2]) / 3


def test_series():
    centre, energy = linear_solution(1.0)
    assert centre == pytest.approx(0.0736714, abs=0.5e-7)
    assert -2 * energy == pytest.approx(0.0351443, abs=0.5e-7)
    assert -8 * energy == pytest.approx(0.1406, abs=0.5e-4)


def test_small_load_converges_to_the_linear_membrane(verified):
    values, exact = on_all_meshes(SMALL, "right"), linear_solution(SMALL)
    error = np.abs(values - exact)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.05)
    np.testing.assert_allclose(extrapolate(values), exact, rtol=1e-5)
    verified("deflection of the centre [m]", exact[0], values[-1, 0], np.log2(error[-2, 0] / error[-1, 0]))


def test_small_load_with_diagonals_to_the_centre():
    values, exact = on_all_meshes(SMALL, "to centre"), linear_solution(SMALL)
    energy_error = np.abs(values[:, 1] - exact[1])
    assert np.log2(energy_error[-2] / energy_error[-1]) == pytest.approx(2, abs=0.05)
    assert extrapolate(values)[1] == pytest.approx(exact[1], rel=1e-5)

    more = values[:, 0] - on_all_meshes(SMALL, "right")[:, 0]
    green = more / (SMALL * (A / MESHES) ** 2 / 3)
    # The discrete Green's function differs from the logarithm by terms of the order (h/a)^2: 1 % on the coarsest mesh.
    np.testing.assert_allclose(np.diff(green), np.log(2) / (2 * np.pi * N0), rtol=0.01)


def test_large_load_converges_with_second_order():
    values = on_all_meshes(LARGE, "right")
    change = np.diff(values, axis=0)
    assert values[-1, 0] > 0.1 * A
    np.testing.assert_allclose(np.log2(change[:-1] / change[1:]), 2, rtol=0, atol=0.05)
    np.testing.assert_allclose(extrapolate(values), extrapolate(values[:-1]), rtol=1e-5)
    assert extrapolate(on_all_meshes(LARGE, "to centre"))[1] == pytest.approx(extrapolate(values)[1], rel=1e-5)


def test_finer_meshes_have_less_energy():
    """With diagonals to the right each mesh holds the functions of the coarser one."""
    assert np.all(np.diff(on_all_meshes(LARGE, "right")[:, 1]) < 0)


@pytest.mark.mpi
def test_stiffening_is_of_second_order_in_the_load():
    """w/q sinks with q^2 at first: by four times as much for twice the load, up to terms of relative size
    Et/N0 (pi w/a)^2 = 3e-4 at the larger load."""
    limit = solve(SMALL, 16, "right")[0] / SMALL
    lack = [limit - solve(q, 16, "right")[0] / q for q in (0.005, 0.01)]
    assert lack[1] / lack[0] == pytest.approx(4, rel=1e-3)
