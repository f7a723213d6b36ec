"""A flat square of triangles, its rim, and the parts that mesh files name; and a roof of them."""

import numpy as np

from fx_membrane import Cable, Fabric, Membrane, Structure, Support, boundary_edges, rectangle

POINTS, TRIANGLES = rectangle(2.0, 2.0, 3, 3)
RIM = boundary_edges(TRIANGLES)
PARTS = {
    "Dach süd": lambda cells: Membrane(cells, Fabric(4e5, 0.3), 2e3),
    "edge": lambda cells: Cable(cells, 1e6, 1e2),
}


def roof():
    """Roof at odd places, held along its rim."""
    points = POINTS + np.array([0.1, 1 / 3, 1e-7])
    points[:, 2] += points[:, 0] * points[:, 1] / 7
    parts = {"Dach süd": PARTS["Dach süd"](TRIANGLES), "edge": PARTS["edge"](RIM)}
    return Structure(points, parts, [Support(np.unique(RIM))])
