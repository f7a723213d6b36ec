"""Films, woven or not, with edge cables, loads and pressure, for form finding."""

import numpy as np

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    Pressure,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

FABRIC = Fabric(Et=5e5, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=4e5, nu=0.2, Gt=3e4)
N = 8
PLAN, TRIANGLES = rectangle(2.0, 2.0, N, N)
RIM = np.unique(boundary_edges(TRIANGLES))
CORNERS = [0, N, (N + 1) * N, (N + 1) ** 2 - 1]


def saddle(height=0.4):
    points = PLAN.copy()
    points[:, 2] = height * points[:, 0] * points[:, 1]
    points[:, :2] += 0.02 * np.sin(7 * points[:, ::-1][:, 1:])  # no symmetric grid
    return points


def film():
    """Film of constant stress on a saddle-shaped rim."""
    points = saddle()
    points[np.setdiff1d(np.arange(len(points)), RIM), 2] = 0.1
    return Structure(points, {"film": Membrane(TRIANGLES, FABRIC, prestress=2e3)}, [Support(RIM)]), ()


def film_with_edge_cables():
    parts = {
        "film": Membrane(TRIANGLES, FABRIC, prestress=1e3),
        "edge": Cable(boundary_edges(TRIANGLES), 1e7, prestress=6e3),
    }
    return Structure(saddle(), parts, [Support(CORNERS)]), ()


def woven():
    """Twice the stress in the weft."""
    parts = {"film": Membrane(TRIANGLES, WOVEN, prestress=(1e3, 2e3), warp=(1, 0.2, 0))}
    return Structure(saddle(), parts, [Support(RIM)]), ()


def inflated():
    return (
        Structure(PLAN, {"film": Membrane(TRIANGLES, FABRIC, prestress=2e3)}, [Support(RIM)]),
        [Pressure(800.0, "film")],
    )


def loaded():
    """Film with edge cables and one across it, with a force at a node and a pressure."""
    structure, _ = film_with_edge_cables()
    lines = np.column_stack([np.arange(N) + N // 2 * (N + 1), np.arange(1, N + 1) + N // 2 * (N + 1)])
    structure = Structure(structure.points, {**structure.parts, "ridge": Cable(lines, 1e7, 2e3)}, structure.supports)
    return structure, [PointLoad(40, (10.0, 0, -100)), Pressure(100.0, "film")]


def weighed_down():
    """Film with edge cables and a ridge that have weights, per area and length of the form."""
    structure, loads = loaded()
    return structure, [*loads, DistributedLoad((0, 0, -150.0), "film"), DistributedLoad((0, 20.0, -200.0), "ridge")]
