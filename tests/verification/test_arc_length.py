"""Snap-through and snap-back: a von Mises truss pushed down directly, and through a softer post on its apex.

Also the loops of a star dome, which are known by symmetry.

Reference: closed form. With the feet at x = -a and a, the apex at the height h at rest and z when pushed, struts of the
length L at rest carry, by the Saint Venant-Kirchhoff law, a cubic in z, with limit points at z = +-h / sqrt(3),

    P(z) = EA z (h^2 - z^2) / L^3.

A post of the length l and the stiffness EA', shortened to d between the apex and the load, carries
Q(d) = EA' d (l^2 - d^2) / (2 l^3). Equilibrium is P(z) = Q(d) = load, with the top of the post at z + d. The tangent at
apex and top is [[P' + Q', -Q'], [-Q', Q']] with derivatives counted as stiffnesses, -dP/dz and -dQ/dd. Where the struts
unload faster than the post can follow, -dP/dz < -(-dQ/dd), the top goes back up: snap-back.
Claim: every point of the path is on these curves, over its whole course: over both limit points of the load; with the
post, under a load, over four turns of the path; and with the top driven down, when the load factor, now the
displacement, turns back. Negative pivots are as many as negative eigenvalues of the closed tangent. Limit points are
points of the path.
Tolerance: the solver's, 1e-10 of the 2-norm of all nodal forces. That of reactions and loads is below 8 times the
largest load: struts carry at most EA h^2 / (2 L^2) each, 3.5 times that load. On forces: 1e-9 of the largest load.
Limit points are where the path is flat within 1e-5, which the cubic is at a distance of 1e-5 h times a constant: 2e-5
h; and 1e-10 of the load is missing there, times a constant: 1e-9.
"""

import numpy as np
import pytest

from fx_membrane import Mast, PointLoad, PrescribedDisplacement, Stage, Structure, Support, equilibrium_path

SOURCE = "closed form of a von Mises truss"

A, H, EA = 1.0, 0.4, 1e5
L = np.hypot(A, H)
LENGTH, POST = 4.0, 2e4
APEX, TOP = 2, 3
SNAP = H / np.sqrt(3)


def struts(z):
    """Force and stiffness."""
    return EA * z * (H**2 - z**2) / L**3, -EA * (H**2 - 3 * z**2) / L**3


def post(d):
    """Force and stiffness."""
    return POST * d * (LENGTH**2 - d**2) / (2 * LENGTH**3), -POST * (LENGTH**2 - 3 * d**2) / (2 * LENGTH**3)


LIMIT = struts(SNAP)[0]
WITHIN = 1e-9 * LIMIT
NEAR = 2e-5 * H


def truss():
    points = [[-A, 0, 0], [A, 0, 0], [0, 0, H]]
    return Structure(points, {"struts": Mast([[0, APEX], [1, APEX]], EA)}, [Support([0, 1]), Support(APEX, "y")])


def truss_with_post():
    points = [[-A, 0, 0], [A, 0, 0], [0, 0, H], [0, 0, H + LENGTH]]
    parts = {"struts": Mast([[0, APEX], [1, APEX]], EA), "post": Mast([[APEX, TOP]], POST)}
    return Structure(points, parts, [Support([0, 1]), Support([APEX, TOP], "xy")])


def turns(values):
    """Numbers of the values that are above or below both neighbours."""
    steps = np.diff(values)
    return np.flatnonzero(steps[1:] * steps[:-1] < 0) + 1


def counted_right(path, negative):
    """Negative pivots, but for limit points, where an eigenvalue is zero."""
    return np.array_equal(np.delete(path.negative_pivots, path.limit_points), np.delete(negative, path.limit_points))


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [3, 10, 50])
def test_snap_through(steps, verified):
    path = equilibrium_path(truss(), Stage("push", [PointLoad(APEX, (0, 0, -1.5 * LIMIT))], increments=steps))
    z = H + path.displacements[:, APEX, 2]
    force, stiffness = struts(z)
    assert path.complete
    assert path.load_factors[0] == 0
    assert path.load_factors[-1] == pytest.approx(1, rel=1e-15)
    np.testing.assert_allclose(1.5 * LIMIT * path.load_factors, force, rtol=0, atol=WITHIN)
    assert (np.diff(z) < 0).all()
    assert counted_right(path, np.where(stiffness < 0, 1, 0))
    verified("limit load [N]", LIMIT, 1.5 * LIMIT * path.load_factors[path.limit_points[0]])
    assert z[path.limit_points] == pytest.approx([SNAP, -SNAP], abs=NEAR)
    assert path.load_factors[path.limit_points] == pytest.approx([1 / 1.5, -1 / 1.5], rel=1e-9)


def test_ends_at_a_displacement():
    path = equilibrium_path(
        truss(), Stage("push", [PointLoad(APEX, (0, 0, -LIMIT))], increments=4), None, (APEX, "z", -H)
    )
    assert path.complete
    assert path.displacements[-1, APEX, 2] == pytest.approx(-H, rel=1e-14)
    assert path.load_factors[-1] == pytest.approx(0, abs=1e-9)


def with_post(path):
    z, top = H + path.displacements[:, APEX, 2], H + LENGTH + path.displacements[:, TOP, 2]
    return z, top, struts(z), post(top - z)


def test_snap_back_under_a_load():
    path = equilibrium_path(truss_with_post(), Stage("push", [PointLoad(TOP, (0, 0, -1.5 * LIMIT))], increments=20))
    z, top, (P, Kz), (Q, Kd) = with_post(path)
    load = 1.5 * LIMIT * path.load_factors
    np.testing.assert_allclose(P, load, rtol=0, atol=WITHIN)
    np.testing.assert_allclose(Q, load, rtol=0, atol=WITHIN)
    tangents = np.moveaxis(np.array([[Kz + Kd, -Kd], [-Kd, Kd]]), 2, 0)
    assert counted_right(path, (np.linalg.eigvalsh(tangents) < 0).sum(axis=1))
    assert z[path.limit_points] == pytest.approx([SNAP, -SNAP], abs=NEAR)
    assert path.load_factors[path.limit_points] == pytest.approx([1 / 1.5, -1 / 1.5], rel=1e-9)
    assert len(turns(top)) == 2  # down, back up, down
    assert path.complete


@pytest.mark.mpi
def test_snap_back_of_a_driven_displacement():
    down = -2.5
    drive = Stage("drive", displacements=[PrescribedDisplacement(TOP, (0, 0, down))], increments=20)
    path = equilibrium_path(truss_with_post(), drive)
    _, top, (P, Kz), (Q, Kd) = with_post(path)
    np.testing.assert_allclose(top, H + LENGTH + down * path.load_factors, rtol=1e-14)
    np.testing.assert_allclose(P, Q, rtol=0, atol=WITHIN)
    assert counted_right(path, np.where(Kz + Kd < 0, 1, 0))
    assert len(path.limit_points) == 2
    assert (Kz + Kd)[path.limit_points] == pytest.approx(0, abs=6 * EA * H / L**3 * NEAR)
    assert path.complete
    last = path.state(-1)
    assert last.reactions[TOP, 2] == pytest.approx(-P[-1], abs=WITHIN)


@pytest.mark.parametrize("number", [-1, 4])
def test_state_of_a_point(number):
    path = equilibrium_path(truss(), Stage("push", [PointLoad(APEX, (0, 0, -1.5 * LIMIT))], increments=10))
    state, point = path.state(number), path.points[number]
    z = H + point.displacement[APEX, 2]
    strain = (z**2 - H**2) / (2 * L**2)
    expected = EA * strain * np.hypot(A, z) / L
    np.testing.assert_allclose(state.mast("struts").force, expected, rtol=1e-12)
    assert state.loads[APEX, 2] == pytest.approx(-1.5 * LIMIT * point.load_factor, rel=1e-15)
    assert state.increments[0].load_factor == point.load_factor
    assert state.equilibrium.residual < WITHIN


def star_dome():
    """24 bars on a regular hexagon, a shallow crown within six lower triangles; held at the six outer points."""
    inner = np.arange(6) * np.pi / 3
    outer = inner + np.pi / 6
    points = np.zeros((13, 3))
    points[0, 2] = 0.25
    points[1:7] = np.stack([0.75 * np.cos(inner), 0.75 * np.sin(inner), np.full(6, 0.19)], axis=1)
    points[7:] = np.stack([1.5 * np.cos(outer), 1.5 * np.sin(outer), np.zeros(6)], axis=1)
    i, following = 1 + np.arange(6), 1 + np.roll(np.arange(6), -1)
    pairs = [(0 * i, i), (i, following), (i, 6 + i), (following, 6 + i)]
    bars = np.concatenate([np.stack(pair, axis=1) for pair in pairs])
    return Structure(points, {"bars": Mast(bars, 1e4)}, [Support(range(7, 13))])


def test_loops_of_a_star_dome():
    """The dome upside down is the same, with opposite loads: its path loops from the one to the other."""
    dome = star_dome()
    stage = Stage("push", [PointLoad(0, (0, 0, -60.0))], increments=15)
    path = equilibrium_path(dome, stage, None, (0, "z", -2 * dome.points[0, 2]), max_points=1000)
    assert path.complete
    upside_down = dome.points * [1, 1, -1]
    np.testing.assert_allclose(path.state(-1).position, upside_down, rtol=0, atol=1e-8)
    limits = path.load_factors[path.limit_points]
    heights = (dome.points + path.displacements[path.limit_points])[:, 0, 2]
    assert len(limits) == 8
    np.testing.assert_allclose(limits, -limits[::-1], rtol=1e-8)
    np.testing.assert_allclose(heights, -heights[::-1], rtol=0, atol=1e-4)
    assert path.negative_pivots.max() > 1  # bifurcations, which the symmetric path passes
