"""Roofs on which rain stands in several basins."""

import numpy as np

from fx_membrane import DistributedLoad, Fabric, Membrane, Stage, Structure, Support, boundary_edges, rectangle

OWN_WEIGHT = Stage("own weight", [DistributedLoad((0, 0, -400.0), "roof")])


def ridged_roof():
    """Soft roof, 4 x 2, of two shallow hollows on both sides of a held ridge at x = -0.5, a little below its rim."""
    points, triangles = rectangle(4.0, 2.0, 16, 8)
    rim, ridge = np.unique(boundary_edges(triangles)), np.flatnonzero(points[:, 0] == -0.5)
    points[:, 2] = -0.005 * (1 - np.abs(points[:, 1])) * (1 - np.abs(points[:, 0] + 0.5) / 2.5)
    points[rim, 2] = 0.0
    return Structure(points, {"roof": Membrane(triangles, Fabric(2e5, 0.3), 2e3)}, [Support(np.union1d(rim, ridge))])
