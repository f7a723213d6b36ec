"""Hand-over: a form of any method is at rest under its loads, with the forces that it is handed over with.

Structure: canopy over a hexagon, corners high and low in turn, edge cables, a valley cable, a held ring in the middle;
    the high corners on masts with two stays each afterwards.
Loads: none, or a load per area and an internal pressure on the membrane, weight of the cables, and a force at a node.
Claim: the analysis of the form moves it by nothing, in no iteration, and has its reactions.
Tolerance: displacement 1e-12 of the size, reactions 1e-9 of the largest.
"""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    CableLength,
    DistributedLoad,
    Mast,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    force_density,
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    updated_reference,
)

SOURCE = "equilibrium: no displacement"

pytestmark = pytest.mark.filterwarnings(
    "ignore::fx_membrane.UnsettledFormWarning", "ignore::fx_membrane.LargeStrainWarning"
)

N, AROUND = 6, 36
WOVEN = OrthotropicFabric(Et_warp=9e5, Et_weft=6e5, nu=0.3, Gt=3e4)


def plan():
    """Points of the plan, triangles, nodes by ring, and corners."""
    angle = 2 * np.pi * np.arange(AROUND) / AROUND
    phase = (angle + np.pi / 6) % (np.pi / 3) - np.pi / 6  # from the nearest corner
    rim = 8 * np.cos(np.pi / 6) / np.cos(np.pi / 6 - np.abs(phase)) * (1 - 0.5 * np.abs(phase))
    share = np.linspace(0, 1, N + 1)[:, None]
    radius = 1 + share * (rim - 1)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * radius], axis=-1).reshape(-1, 3)
    node = np.arange(len(points)).reshape(N + 1, AROUND)
    a, b, c, d = node[:-1], node[1:], np.roll(node[1:], -1, axis=1), np.roll(node[:-1], -1, axis=1)
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    return points, triangles, node, node[-1, :: AROUND // 6]


def canopy():
    points, triangles, node, corners = plan()
    points[corners[::2], 2], points[corners[1::2], 2], points[node[0], 2] = 4.0, 0.0, 2.0
    rim = boundary_edges(triangles)
    valley = node[:, AROUND // 6]
    parts = {
        "film": Membrane(triangles, WOVEN, (2.6e3, 2e3), (1, 0, 0)),
        "edge": Cable(rim[np.isin(rim, node[-1]).all(axis=1)], 2e7, 40e3),
        "valley": Cable(np.stack([valley[:-1], valley[1:]], axis=1), 2e7, 6e3),
    }
    return Structure(points, parts, [Support(corners), Support(node[0])])


def lifted(structure):
    """Lift a structure to a shape in space, from which the other methods start."""
    return replace(structure, points=projected_stress(structure, cables="force density").points)


def net(loads):
    points, triangles, node, corners = plan()
    points[corners[::2], 2], points[node[0], 2] = 4.0, 2.0
    branches = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    force = np.zeros(points.shape)
    for load in loads:
        if isinstance(load, PointLoad):
            force[load.nodes] += load.force
    found = force_density(points, branches, 2e3, [Support(corners), Support(node[0])], loads=force)
    cables = Cable(branches, 2e6, found.forces["net"])
    made = Structure(found.points, {"net": cables}, [Support(corners), Support(node[0])])
    return replace(found, made=made)


METHODS = {
    "force density": net,
    "projected stress": lambda loads: projected_stress(canopy(), loads),
    "projected stress, forces": lambda loads: projected_stress(canopy(), loads, cables="force"),
    "projected stress, length": lambda loads: projected_stress(
        canopy(), loads, constraints=[CableLength("valley", 7.5)]
    ),
    "natural force density": lambda loads: natural_force_density(lifted(canopy()), loads),
    "natural force density, repeated": lambda loads: natural_force_density(lifted(canopy()), loads, iterations=5),
    "prescribed stress": lambda loads: prescribed_stress(lifted(canopy()), loads, max_iterations=3),
    "updated reference": lambda loads: updated_reference(lifted(canopy()), loads, max_iterations=5),
}


def loads_of(method):
    node = 3 * AROUND + 7
    if method == "force density":
        return [PointLoad(node, (100.0, 0, -500.0))]
    return [
        DistributedLoad((0, 0, -15.0), "film"),
        Pressure(60.0, "film"),
        DistributedLoad((0, 0, -20.0), "edge"),
        PointLoad(node, (100.0, 0, -500.0)),
    ]


def at_rest(form, loads):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    assert state.largest_displacement <= 1e-12 * np.ptp(form.points, axis=0).max()
    assert len(state.history) == 1
    assert state.reactions == pytest.approx(form.reactions, abs=1e-9 * np.abs(form.reactions).max())
    return state.largest_displacement / np.ptp(form.points, axis=0).max()


@pytest.mark.parametrize("loaded", [False, pytest.param(True, marks=pytest.mark.mpi)])
@pytest.mark.parametrize("method", METHODS)
def test_form_is_at_rest(method, loaded, verified):
    loads = loads_of(method) if loaded else []
    form = METHODS[method](loads)
    assert np.abs(form.points[:, 2]).max() > 1
    verified("displacement of a form over its size", 0.0, at_rest(form, loads))


@pytest.mark.parametrize("find", [projected_stress, natural_force_density])
def test_form_under_uplift_that_grows_with_it_is_at_rest(find):
    """The loads follow the shape from solve to solve, and settle the slower, the nearer they are to the largest."""
    loads = [Pressure(1000.0, "film")]
    at_rest(find(canopy() if find is projected_stress else lifted(canopy()), loads), loads)


@pytest.mark.parametrize("loaded", [False, True])
@pytest.mark.parametrize("method", METHODS)
def test_form_on_masts_and_stays_is_at_rest(method, loaded):
    loads = loads_of(method) if loaded else []
    form = METHODS[method](loads)
    heads = plan()[3][::2]
    n = len(form.points)
    away = form.points[heads] * [1, 1, 0]
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    side = away[:, [1, 0, 2]] * [-1, 1, 1]
    feet = [form.points[heads] * [1, 1, 0] + k * away + s * side for k, s in ((0.5, 0), (5, -3), (5, 3))]
    bars = {
        "masts": Mast(np.stack([n + np.arange(3), heads], axis=1), 4e7),
        "stays": Cable(np.stack([n + 3 + np.arange(6), np.tile(heads, 2)], axis=1), 1e7),
    }
    guyed = masts_and_stays(form, bars, np.concatenate(feet), heads=heads)
    assert guyed.forces["masts"].max() < -1e3
    at_rest(guyed, loads)
