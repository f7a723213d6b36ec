"""Sails for form finding with stress in plan, and their loads."""

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PlanLoad,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    edges_where,
    rectangle,
)

FABRIC = Fabric(Et=6e5, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)


def sail(n=8, prestress=(3e3, 2e3), warp=(1.0, 0, 0), cells=None):
    """Square with a bilinear rim, all of it held."""
    points, triangles = rectangle(4.0, 4.0, n, n, "right")
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = points[rim, 0] * points[rim, 1] / 4
    film = Membrane(triangles if cells is None else cells, FABRIC, prestress, warp)
    return Structure(points, {"film": film}, [Support(rim)])


def canopy(n=8, force=40e3, material=WOVEN):
    """Four corners held, edges drawn as arcs, and a valley cable."""
    flat, triangles = rectangle(2.0, 2.0, n, n)
    x, y = flat[:, 0], flat[:, 1]
    points = 6 * np.stack([x * (1 - 0.1 * (1 - y**2)), y * (1 - 0.1 * (1 - x**2)), 0 * x], axis=1)
    corners = np.flatnonzero(np.abs(x * y) == 1)
    points[corners, 2] = 1.5 + 1.5 * (x * y)[corners]
    rim = boundary_edges(triangles)
    valley = edges_where(flat, triangles, lambda x: np.isclose(x[0], 0))
    parts = {
        "film": Membrane(triangles, material, prestress=(3e3, 2.5e3), warp=(1, 0, 0)),
        "edge": Cable(rim, 2e7, force),
        "valley": Cable(valley, 2e7, 5e3),
    }
    return Structure(points, parts, [Support(corners)])


def loads_of(structure):
    centre = int(np.argmin(np.linalg.norm(structure.points[:, :2], axis=1)))
    return [
        DistributedLoad((0, 0, -50.0), "film"),
        PlanLoad((0, 0, -100.0), "film"),
        Pressure(60.0, "film"),
        DistributedLoad((0, 0, -20.0), "edge"),
        PointLoad(centre, (100.0, 0, -500.0)),
    ]


def state_of(form, loads=()):
    return Analysis(form.structure).run([Stage("form", loads)])["form"]
