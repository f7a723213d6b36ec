"""Cutting pattern of a cone made by hand: its gores unroll in closed form, whatever cuts strips elsewhere."""

import numpy as np

from fx_membrane import Fabric, Membrane, Structure, Support
from fx_membrane.patterns.flat_strips import CuttingPattern, FlatStrip, Side
from fx_membrane.patterns.strips import Edge, Strips

LOW, HIGH, HEIGHT = 7.0, 2.0, 5.0  # radii, and height [m]
SINE = 1 / np.sqrt(2)  # of half the angle of the cone
NEAR, FAR = HIGH / SINE, LOW / SINE  # radii of the development


def cone_gores(count=12, copies=False, along=8, across=4, names="gore {}"):
    """Gores of the whole cone, "gore 1" and so on, with "seam i" on the left of gore i; one name only if copies."""
    names = [names.format(number) for number in range(1, count + 1)]
    grid = np.arange((along + 1) * (across * count)).reshape(along + 1, -1)
    height = np.linspace(0, 1, along + 1)
    angle = np.linspace(0, 2 * np.pi, across * count, endpoint=False)
    radius = LOW + (HIGH - LOW) * height[:, None]
    points = np.stack(
        [radius * np.cos(angle), radius * np.sin(angle), np.broadcast_to(HEIGHT * height[:, None], grid.shape)], axis=-1
    ).reshape(-1, 3)
    parts, flat, edges = {}, {}, []
    for gore, name in enumerate(names):
        columns = np.arange(gore * across, (gore + 1) * across + 1) % grid.shape[1]
        nodes = grid[:, columns]
        parts[name], flat[name] = _gore(points, nodes, name, count)
        edges.append(Edge(f"seam {gore + 1}", nodes[:, 0], (name, names[gore - 1])))
        edges.append(Edge(f"base {gore + 1}", nodes[0], (name,), held=True))
        edges.append(Edge(f"ring {gore + 1}", nodes[-1], (name,), line="ring"))
    sides = {
        name: tuple(
            Side(edge, rows)
            for edge, rows in zip(
                (f"base {gore + 1}", f"seam {(gore + 1) % count + 1}", f"ring {gore + 1}", f"seam {gore + 1}"),
                _around(along, across),
                strict=True,
            )
        )
        for gore, name in enumerate(names)
    }
    flat = {name: FlatStrip(name, entry[0], entry[1], entry[2], sides[name]) for name, entry in flat.items()}
    structure = Structure(points, parts, [Support(np.concatenate([grid[0], grid[-1]]))])
    strips = Strips(structure, tuple(edges), dict.fromkeys(names[1:], names[0]) if copies else {})
    return CuttingPattern(strips, flat, flat, dict.fromkeys(names, np.ones(2)))


def _gore(points, nodes, name, count):
    local = np.arange(nodes.size).reshape(nodes.shape)
    a, b, c, d = (local[rows, columns].ravel() for rows, columns in _corners())
    triangles = np.vstack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    fabric = Fabric(5e5, 0.3)
    warp = points[nodes[-1].mean(dtype=int)] - points[nodes[0].mean(dtype=int)]
    distance = np.linspace(FAR, NEAR, nodes.shape[0])
    turn = (np.linspace(0, 1, nodes.shape[1]) - 0.5) * 2 * np.pi / count * SINE
    # From the base to the ring along the first axis: seen from outside, the angle grows to the right.
    places = np.stack([-distance[:, None] * np.cos(turn), -distance[:, None] * np.sin(turn)], axis=-1).reshape(-1, 2)
    return Membrane(nodes.ravel()[triangles], fabric, 1e3, warp=warp), (nodes.ravel(), places, triangles)


def _corners():
    low, high = slice(None, -1), slice(1, None)
    return (low, low), (low, high), (high, high), (high, low)


def _around(along, across):
    local = np.arange((along + 1) * (across + 1)).reshape(along + 1, across + 1)
    return local[0], local[:, -1], local[-1, ::-1], local[::-1, 0]
