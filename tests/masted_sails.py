"""Forms with held nodes, and masts and stays to hold them."""

import numpy as np

from fx_membrane import (
    Cable,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    updated_reference,
)

FABRIC = Fabric(Et=800e3, nu=0.2)


def turned(points, turn):
    return np.array(points) if turn is None else points @ turn.T


def sail(n=8, turn=None, unit=1.0, material=FABRIC):
    """Sail between arcs on two low points and two high ones, all held; and its corners."""
    flat, triangles = rectangle(2.0, 2.0, n, n)
    half, radius = 5.0, 10.0
    sag = np.sqrt(radius**2 - (half * flat[:, :2]) ** 2) - np.sqrt(radius**2 - half**2)
    points = half * flat
    points[:, :2] -= flat[:, :2] * sag[:, ::-1]
    points[:, :2] = points[:, :2] @ np.array([[1, 1], [-1, 1]]) / np.sqrt(2)
    west, east, south, north = (k(points[:, i]) for i in (0, 1) for k in (np.argmin, np.argmax))
    points[[west, east, south, north], 2] = 4, 4, 1, 1
    parts = {
        "fabric": Membrane(triangles, material, 2.5e3 * unit),
        "edges": Cable(boundary_edges(triangles), 2e7 * unit, 25e3 * unit),
    }
    return Structure(turned(points, turn), parts, [Support([west, south, east, north])]), (west, east, south, north)


def guys(structure, corners, turn=None, third=False):
    """Make two masts that lean outwards, with two stays each, or three; and the positions of their feet."""
    n, (west, east, *_) = len(structure.points), corners
    feet = [(-5.2, 0, 0), (5.2, 0, 0), *((s * 9.0, y, 0.0) for s in (-1, 1) for y in (2.5, -2.5))]
    stays = [[n + 2, west], [n + 3, west], [n + 4, east], [n + 5, east]]
    if third:
        feet += [(-2.0, 0, 0), (2.0, 0, 0)]
        stays += [[n + 6, west], [n + 7, east]]
    return {"masts": Mast([[n, west], [n + 1, east]], 3e8), "stays": Cable(stays, 2e7)}, turned(feet, turn)


def head(*ends, pull=(3e3, 0.0, 0.0), wanted=0.0, kinds=None):
    """Form of a node held at (0, 0, 4) under a load, and bars from it to ends, masts by default if below 1 m."""
    structure = Structure(
        [[0.0, 0, 4], [8, 0, 4]],
        {"rope": Cable([[0, 1]], 1e7, pull[0])},
        [Support([0, 1])],
    )
    loads = [PointLoad(0, np.array(pull) * [0, 1, 1])]
    form = updated_reference(structure, loads)
    kinds = kinds or ["mast" if np.hypot(*end[:2]) < 1 else "stay" for end in ends]
    wanted = np.broadcast_to(wanted, len(ends))
    bars = {}
    for kind, make in (("mast", Mast), ("stay", Cable)):
        mine = [i for i, which in enumerate(kinds) if which == kind]
        if mine:
            bars[kind] = make([[i + 2, 0] for i in mine], 1e8, prestress=wanted[mine])
    return form, bars, ends, loads


def sail_on_masts(tilt=1.0, pull=25e3, push=0.0):
    """Two low corners, two heads on tilted masts, each with two stays; all supports in one plane."""
    flat, triangles = rectangle(2.0, 2.0, 6, 6)
    x, y = flat[:, 0], flat[:, 1]
    points = 6 * np.stack([x * (1 - 0.1 * (1 - y**2)), y * (1 - 0.1 * (1 - x**2)), (1 + x * y) / 3], axis=1)
    corners = np.flatnonzero(np.abs(x * y) == 1)
    heads, low = corners[points[corners, 2] > 1], corners[points[corners, 2] < 1]
    n, away = len(points), points[heads] * [1, 1, 0] / np.hypot(*points[heads, :2].T)[:, None]
    side, base = away[:, [1, 0, 2]] * [-1, 1, 1], points[heads] * [1, 1, 0]
    feet = np.concatenate([base - tilt * away, base + 5 * away + 3 * side, base + 5 * away - 3 * side])
    masts = np.stack([n + np.arange(2), heads], axis=1)
    parts = {
        "film": Membrane(triangles, Fabric(6e5, 0.3), 2e3),
        "edge": Cable(boundary_edges(triangles), 2e7, 25e3),
        "stays": Cable(np.stack([n + 2 + np.arange(4), np.tile(heads, 2)], axis=1), 2e7, pull),
        "masts": Mast(masts, 1e8, push),
    }
    points = np.concatenate([points, feet])
    return Structure(points, parts, [Support(low), Support(range(n, n + 6))]), masts
