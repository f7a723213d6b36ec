"""Saddles of fabric with edge cables, stays and a mast, and loads on them."""

import numpy as np

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    Pressure,
    Structure,
    Support,
    rectangle,
)

N = 6
CENTRE = (N + 1) * (N // 2) + N // 2


def saddle(material, prestress):
    """Saddle with edge cables, held at three corners, the fourth on a mast with two stays.

    It carries compression: the energy has all its derivatives only within one state of wrinkling.
    """
    points, triangles = rectangle(2.0, 2.0, N, N)
    points[:, 2] = 0.6 * points[:, 0] * points[:, 1]
    grid = np.arange(len(points)).reshape(N + 1, N + 1)
    sides = [grid[0], grid[-1], grid[:, 0], grid[:, -1]]
    edges = np.concatenate([np.stack([side[:-1], side[1:]], axis=-1) for side in sides])
    top, foot = grid[-1, -1], len(points)
    points = np.vstack([points, [[0.8, 0.8, -1.0], [2.2, 1.1, -1.0], [1.1, 2.2, -1.0]]])
    stays = np.array([[top, foot + 1], [top, foot + 2]])
    parts = {
        "sail": Membrane(triangles, material, prestress, warp=(1.0, 0.5, 0.0), compression_stiffness=1.0),
        "edges": Cable(edges, 5e3, 60.0, compression_stiffness=1.0),
        "stays": Cable(stays, 5e3, 60.0, compression_stiffness=1.0),
        "mast": Mast(np.array([[foot, top]]), 5e4, -50.0),
    }
    return Structure(points, parts, [Support([grid[0, 0], grid[0, -1], grid[-1, 0], foot, foot + 1, foot + 2])])


WOVEN = OrthotropicFabric(1000.0, 600.0, nu=0.3, Gt=100.0)
SADDLES = {
    "isotropic": saddle(Fabric(1000.0, 0.3), 100.0),
    "woven": saddle(WOVEN, np.array([[125.0, 20.0], [20.0, 75.0]])),
}
LOADS = {
    "point": PointLoad(CENTRE, (4.0, 2.0, -15.0)),
    "dead": DistributedLoad((0.0, 0.0, -20.0), "sail"),
    "pressure": Pressure(20.0, "sail"),
    "suction": Pressure(-20.0, "sail"),
}
