"""Results of which the tests of scenes make pages."""

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
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

EVIL = "</script><img src=x onerror=alert(1)> \"&'"


def roof(columns=8, rows=6, away=(0, 0, 0)):
    """Hypar on a mast, with a cable and a stay, that wrinkles under wind: every kind of part, names that are markup."""
    points, triangles = rectangle(8.0, 6.0, columns, rows)
    points[:, 2] = points[:, 0] * points[:, 1] / 12
    n = len(points)
    middle = np.flatnonzero(np.abs(points[:, 1]) < 1e-9)
    centre = middle[len(middle) // 2]
    rim = np.unique(boundary_edges(triangles))
    parts = {
        EVIL: Membrane(triangles, Fabric(5e5, 0.3), (2e3, 1e3), warp=(1, 0, 0)),
        "cable": Cable(polyline(middle), 12e6, 20e3),
        "mast": Mast([(n, centre)], 1e8),
        "stay": Cable([(n + 1, centre)], 1e7, 1e2),
    }
    points = np.vstack([points, (0, 0, -3), (0, -7, -1)]) + away
    return Structure(points, parts, [Support(rim), Support([n, n + 1], "xyz")])


def stages():
    return [
        Stage("prestress"),
        Stage("snow", [DistributedLoad((0, 0, -600.0), EVIL)], increments=2, after="prestress"),
        Stage(f"wind {EVIL}", [DistributedLoad((0, 0, 2500.0), EVIL)], increments=4, after="prestress"),
    ]


def results(structure=None):
    return Analysis(structure or roof()).run(stages())
