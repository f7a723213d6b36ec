"""Ropes, canopies and cones that form finding constrains, and how far a form moves when it is analysed."""

from dataclasses import replace

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
)
from fx_membrane.form_finding.constraints.cable_lines import lines_of

FABRIC = Fabric(Et=6e5, nu=0.3)


def rope(n=8, span=100.0, rise=0.0, prestress=0.0):
    x = np.linspace(0, span, n + 1)
    points = np.stack([x, 0 * x, rise * x / span], axis=1)
    return Structure(points, {"rope": Cable(polyline(range(n + 1)), 1e7, prestress)}, [Support([0, n])])


def canopy(n=8, force=0.0, depth=0.1, height=2.0):
    """Four corners held, the edges drawn as arcs of that depth over their half length."""
    flat, triangles = rectangle(2.0, 2.0, n, n)
    x, y = flat[:, 0], flat[:, 1]
    points = 6 * np.stack([x * (1 - depth * (1 - y**2)), y * (1 - depth * (1 - x**2)), 0 * x], axis=1)
    corners = np.flatnonzero(np.abs(x * y) == 1)
    points[:, 2] = height * x * y
    parts = {"film": Membrane(triangles, FABRIC, 2e3), "edge": Cable(boundary_edges(triangles), 2e7, force)}
    return Structure(points, parts, [Support(corners)])


def with_a_hole():
    """Disc with a ring cable around a hole."""
    angle = np.arange(16) * np.pi / 8
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([circle, 3 * circle])
    a, b = np.arange(16), np.roll(np.arange(16), -1)
    triangles = np.concatenate([np.stack([a, b, b + 16], axis=1), np.stack([a, b + 16, a + 16], axis=1)])
    parts = {"film": Membrane(triangles, FABRIC, 2e3), "ring": Cable(np.stack([a, b], axis=1), 1e7)}
    return Structure(points, parts, [Support(range(16, 32))])


def edges(structure, points):
    """Lengths and sags of the four edges."""
    held = structure.supported.all(axis=1)
    cells = structure.parts["edge"].cells
    lines = lines_of(cells, np.arange(len(cells)), held)
    assert len(lines) == 4
    return [line.length(points) for line in lines], [line.sag(points, None) for line in lines], lines


def moved(form, loads=()):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    assert np.abs(state.reactions - form.reactions).max() <= 1e-9 * np.abs(form.reactions).max()
    return np.abs(state.displacement).max() / np.ptp(form.points)


def cone(n=4, radius=1.0, top=2.0, base=4.0, turn=None, hoop=0.0):
    """Ring of that radius at a height, a membrane around it, and masts along the ring."""
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    share = np.linspace(0, 1, n + 1)
    points = np.concatenate([(radius + s * (base - radius)) * circle + [0, 0, top * (1 - s)] for s in share])
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)])
    points = points if turn is None else points @ turn.T
    ring = np.arange(around)
    parts = {
        "film": Membrane(triangles, FABRIC, 2e3, None if turn is None else turn @ [1, 0.3, 0]),
        "hoop": Mast(polyline([*ring, 0]), 1e8, hoop),
    }
    return Structure(points, parts, [Support(n * around + ring)]), ring


def with_supports(components, nodes=None):
    structure, ring = cone()
    nodes = ring if nodes is None else ring[nodes]
    return replace(structure, supports=[*structure.supports, Support(nodes, components)])
