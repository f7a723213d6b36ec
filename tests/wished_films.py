"""Woven films between corners, rims and rings, with a prestress that form finding takes as a wish."""

from dataclasses import replace

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Membrane,
    OrthotropicFabric,
    PlanLoad,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)


def canopy(n=8, prestress=(3e3, 2e3), force=40e3, warp=(1.0, 0.3, 0)):
    """Plan between four corners, two of them high, with edge cables."""
    points, triangles = rectangle(8.0, 8.0, n, n)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 16)
    points[corners, 2] = 1.5 * np.sign(points[corners, 0] * points[corners, 1])
    parts = {
        "film": Membrane(triangles, WOVEN, prestress, warp),
        "edge": Cable(boundary_edges(triangles), 2e7, force),
    }
    return Structure(points, parts, [Support(corners)])


def cone(n=6, a=2.0, b=7.0, h=5.0, prestress=(4e3, 2e3)):
    """Mesh in plan between two held rings, one lifted."""
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([r * ring for r in np.linspace(a, b, n + 1)])
    points[:around, 2] = h
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    film = Membrane(triangles, WOVEN, prestress, warp=(1, 0, 0))
    return Structure(points, {"film": film}, [Support([*range(around), *range(n * around, (n + 1) * around)])])


def loads():
    return [
        Pressure(40.0, "film"),
        PlanLoad((0, 0, -60.0), "film"),
        DistributedLoad((0, 0, -20.0), "edge"),
        PointLoad(40, (50.0, 0, -300.0)),
    ]


def state_of(form, loads=()):
    return Analysis(form.structure).run([Stage("form", loads)])["form"]


def lifted(structure, start):
    """Move the free nodes to another start: in plan, bent, slid within the surface, or at random."""
    points, free = structure.points.copy(), ~structure.supported.all(axis=1)
    x, y = points[:, 0] / 4, points[:, 1] / 4
    hump = np.cos(np.pi * x / 2) * np.cos(np.pi * y / 2)
    moves = {
        "plan": np.stack([0 * x, 0 * x, -points[:, 2]]),
        "bent": np.stack([0 * x, 0 * x, 0.8 * hump - points[:, 2] / 2]),
        "slid": np.stack([0.5 * hump, -0.3 * hump * x, 0 * x]),
        "random": 0.2 * np.random.default_rng(0).uniform(-1, 1, (3, len(x))),
    }
    points[free] += moves[start].T[free]
    return replace(structure, points=points)


def saddle(n=8, prestress=(3e3, 2e3)):
    structure = canopy(n, prestress)
    points, rim = structure.points.copy(), np.unique(boundary_edges(structure.parts["film"].cells))
    points[:, 2] = 1.5 * points[:, 0] * points[:, 1] / 16
    return Structure(points, {"film": structure.parts["film"]}, [Support(rim)])


def tent(force, radius=0.6, n=3):
    """Cone over a plan of 12 x 12 m: four low corners, edge cables, a ring at 5 m."""
    around = 8 * n
    angle = np.arange(around) * 2 * np.pi / around + np.pi / 4
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    base = 6 * circle / np.abs(circle).max(axis=1, keepdims=True)
    along = np.abs(base).min(axis=1, keepdims=True) / 6
    base *= np.where(np.isclose(np.abs(base), 6), 1 - 0.12 * (1 - along**2), 1)
    shares = np.linspace(0, 1, 2 * n + 1)
    rows = [np.column_stack([(1 - s) * radius * circle + s * base, np.full(around, 5 * (1 - s))]) for s in shares]
    i, j = (index.ravel() for index in np.mgrid[: 2 * n, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    rim = np.arange(2 * n * around, (2 * n + 1) * around)
    parts = {
        "film": Membrane(triangles, WOVEN, (3e3, 2e3), warp=(1, 0, 0)),
        "edge": Cable(np.stack([rim, np.roll(rim, -1)], axis=1), 2e7, force),
    }
    return Structure(np.concatenate(rows), parts, [Support(range(around)), Support(rim[:: 2 * n])])
