"""Limit points for any number of steps, and in wrinkled states.

References: the path itself in 200 steps; limit points of the structure with a hundredth of the compression stiffness.
Nets: bars on a shallow cap, pushed at one node, which snaps through long before the cap does. Truss: closed form,
EA z (h^2 - z^2) / L^3 with limit points at z = +-h / sqrt(3).
Claim: from one step on, `equilibrium_path` finds the limit points that many steps find, in the same order. At each of
them the negative pivots change by one. Steps that are far too long are rejected, at the cost of few factorizations. A
blown cap under snow is wrinkled where it loses its stability; its limit load is that without compression stiffness.
Tolerance: load factors at smooth limit points are exact to the second order of the flatness, 1e-5: 1e-7. Wrinkled: the
0.01 % that is claimed; the reference is off by the difference of shares, 1e-3 of 0.05 %.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    equilibrium_path,
    rectangle,
)
from surfaces import half_disc

SOURCE = "closed form of a von Mises truss; fine paths"


def cap(n, rise):
    points, triangles = rectangle(8.0, 8.0, n, n, "right")
    held = np.unique(boundary_edges(triangles))
    points[:, 2] = rise * (1 - (points[:, 0] / 4) ** 2) * (1 - (points[:, 1] / 4) ** 2)
    pairs = np.vstack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return Structure(points, {"bars": Mast(np.unique(np.sort(pairs, axis=1), axis=0), 1e5)}, [Support(held)])


NETS = {"coarse": (4, 0.75, 6, 800.0, 2), "middle": (6, 0.75, 8, 800.0, 1), "fine": (8, 0.5, 20, 200.0, 2)}


@pytest.fixture(scope="module", params=["coarse", "middle", "fine"])
def net(request):
    """Structure, loads, first limit points."""
    n, rise, node, load, count = NETS[request.param]
    loads = [PointLoad(node, (0, 0, -load))]
    path = equilibrium_path(cap(n, rise), Stage("push", loads, increments=200), max_points=60)
    return cap(n, rise), loads, path.load_factors[path.limit_points[:count]]


@pytest.mark.study("steps")
@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [1, 3, 5, 10, 40])
def test_first_limit_points_whatever_the_steps(net, steps):
    structure, loads, expected = net
    path = equilibrium_path(structure, Stage("push", loads, increments=steps), max_points=25)
    limits = path.limit_points[: len(expected)]
    np.testing.assert_allclose(path.load_factors[limits], expected, rtol=1e-6, atol=1e-9)
    for limit in limits:
        assert abs(path.negative_pivots[limit + 1] - path.negative_pivots[limit - 1]) == 1
    assert (path.negative_pivots[: limits[0]] == 0).all()


@pytest.mark.parametrize("steps", [1, 2, 20])
def test_a_load_fifty_times_too_large(steps, verified):
    a, h, EA = 1.0, 0.4, 1e5
    points = [[-a, 0, 0], [a, 0, 0], [0, 0, h]]
    truss = Structure(points, {"struts": Mast([[0, 2], [1, 2]], EA)}, [Support([0, 1]), Support(2, "y")])
    limit = EA * 2 / 3**1.5 * h**3 / np.hypot(a, h) ** 3
    path = equilibrium_path(truss, Stage("push", [PointLoad(2, (0, 0, -50 * limit))], increments=steps))
    assert path.complete
    assert path.load_factors[path.limit_points] == pytest.approx([1 / 50, -1 / 50], rel=1e-9)
    verified("load factor of a limit point", 1 / 50, path.load_factors[path.limit_points[0]])
    z = h + path.displacements[path.limit_points, 2, 2]
    assert z == pytest.approx([h / np.sqrt(3), -h / np.sqrt(3)], abs=1e-4 * h)


def blown_cap(kept, rise):
    points, triangles, rim = half_disc(8)
    points = 2 * points
    points[:, 2] = rise * (1 - np.sum(points**2, axis=1) / 4)
    symmetry = np.setdiff1d(np.flatnonzero(points[:, 1] == 0), rim)
    fabric = Membrane(triangles, Fabric(1e5, 0.3), 100.0, compression_stiffness=kept)
    return Structure(points, {"fabric": fabric}, [Support(rim), Support(symmetry, "y")])


def snowed_under(kept, rise):
    structure = blown_cap(kept, rise)
    start = Analysis(structure).run([Stage("blow", [Pressure(500.0, "fabric")], increments=2)])["blow"]
    snow = Stage("snow", [DistributedLoad((0, 0, -900.0), "fabric")], increments=5, after="blow")
    return equilibrium_path(start, snow, 2.0, max_points=45)


@pytest.mark.parametrize("rise", [0.4, 0.8])
def test_wrinkled_limit_point(rise):
    path, reference = snowed_under(1e-4, rise), snowed_under(1e-6, rise)
    first, expected = path.limit_points[0], reference.load_factors[reference.limit_points[0]]
    assert path.load_factors[first] == pytest.approx(expected, rel=1e-4)
    state = path.state(first)
    assert np.count_nonzero(state.membrane("fabric").state == "wrinkled") > 20
    assert state.equilibrium.residual < 1e-7 * np.abs(state.loads).sum()
