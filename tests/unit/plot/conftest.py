"""The roof that is drawn."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
)
from pictures import CENTRE, FOOT, HALF, POINTS, TRIANGLES


@pytest.fixture(scope="session")
def result():
    """Roof of two membranes, a cable on their common line and a mast; one is stretched, one has folds."""
    rim = np.unique(boundary_edges(TRIANGLES))
    parts = {
        "south": Membrane(TRIANGLES[HALF], Fabric(Et=1e5, nu=0.3), prestress=1e3),
        "north": Membrane(np.delete(TRIANGLES, HALF, axis=0), Fabric(Et=1e5, nu=0.3), prestress=10.0),
        "ridge": Cable(np.column_stack([range(10, 14), range(11, 15)]), 1e6, 2e3),
        "mast": Mast([[FOOT, CENTRE]], 1e7),
    }
    structure = Structure(POINTS, parts, [Support(rim), Support(FOOT, "xy")])
    snow = DistributedLoad((0, 0, -100.0), "south")
    lift = PrescribedDisplacement(FOOT, (0, 0, 0.2), "z")
    return Analysis(structure).run([Stage("snow", [snow], [lift], increments=4)])["snow"]
