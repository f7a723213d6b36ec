"""Strips of surfaces of revolution on regular grids, whose seams are meridians."""

import numpy as np
from scipy.optimize import brentq

from fx_membrane import Fabric, Membrane, Structure, Support
from fx_membrane.patterns.strips import Edge, Strips

FABRIC = Fabric(5e5, 0.3)


def grid(radius, height, gores, across, along, sweep=2 * np.pi):
    """Points of a surface of revolution, shape (n, 3), and their numbers by meridian and parallel."""
    whole = np.isclose(sweep, 2 * np.pi)
    meridians = gores * across + (not whole)
    angle = sweep * np.arange(meridians) / (gores * across)
    r, z = radius, height
    points = np.stack([np.outer(np.cos(angle), r), np.outer(np.sin(angle), r), np.tile(z, (meridians, 1))], axis=-1)
    nodes = np.arange(meridians * len(r)).reshape(meridians, len(r))
    return points.reshape(-1, 3), np.vstack([nodes, nodes[:1]]) if whole else nodes


def triangles_of(nodes, alternating):
    """Triangles of a grid of nodes, counter-clockwise from outside; diagonals in turn, or all alike."""
    a, b, c, d = (part.ravel() for part in (nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]))
    column, row = (index.ravel() for index in np.indices((nodes.shape[0] - 1, nodes.shape[1] - 1)))
    first = (column + row) % 2 == 0 if alternating else np.ones(len(a), dtype=bool)
    one = np.where(first[:, None], np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    other = np.where(first[:, None], np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    return np.stack([one, other], axis=1).reshape(-1, 3)


def gores(radius, height, count, across, along, law=FABRIC, prestress=2e3, sweep=2 * np.pi, alternating=True, **given):
    """Make strips between meridians, `across` cells wide; radius and height are functions of a share from 0 to 1.

    A sweep below a whole turn ends at planes of symmetry, which must be y = 0 and x = 0.
    """
    share = np.linspace(0, 1, along + 1)
    points, nodes = grid(radius(share), height(share), count, across, along, sweep)
    parts, edges = {}, []
    for number in range(count):
        own = nodes[number * across : (number + 1) * across + 1]
        cells = triangles_of(own, alternating)
        middle = sweep * (number + 0.5) / count
        a, b, c = points[cells].transpose(1, 0, 2)
        warp = np.cross([-np.sin(middle), np.cos(middle), 0.0], np.cross(b - a, c - a))
        warp *= np.sign(warp[:, 2:])
        name = f"gore {number + 1}"
        parts[name] = Membrane(cells, law, prestress, warp=warp, **given)
        for end, at in (("bottom", 0), ("top", -1)):
            edges.append(Edge(f"{end} {number + 1}", own[:, at], (name,), held=True))
    whole = np.isclose(sweep, 2 * np.pi)
    for number in range(count + (not whole)):
        sides = [f"gore {number}", f"gore {number + 1}"]
        if whole:
            sides[0] = f"gore {(number - 1) % count + 1}"
        edges.append(Edge(f"seam {number}", nodes[number * across], tuple(name for name in sides if name in parts)))
    supports = [Support(np.concatenate([nodes[:, 0], nodes[:, -1]]))]
    if not whole:
        supports += [Support(nodes[0], "y"), Support(nodes[-1], "x")]
    return Strips(Structure(points, parts, supports), tuple(edges))


def cone(count=12, across=4, along=8, **given):
    """Cone frustum of radius 7 to 2, height 5."""
    return gores(lambda t: 7 - 5 * t, lambda t: 5 * t, count, across, along, **given)


def catenoid(count, across, along, quarter=False, **given):
    """Catenoid between rings of radius 10, 10 apart, of `count` gores around."""
    waist = brentq(lambda c: c * np.cosh(5 / c) - 10, 6, 10)
    sweep = np.pi / 2 if quarter else 2 * np.pi
    return gores(
        lambda t: waist * np.cosh((10 * t - 5) / waist),
        lambda t: 10 * t - 5,
        count // 4 if quarter else count,
        across,
        along,
        sweep=sweep,
        **{"prestress": 4e3} | given,
    )
