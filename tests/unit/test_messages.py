"""Whole messages, as a user reads them: some of each kind. Other tests look for facts, and leave the words free."""

import re
import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    Fabric,
    LargeStrainWarning,
    Membrane,
    Newton,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    equilibrium_path,
    force_density,
)
from models import TRIANGLES, arch

SQUARE = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
FABRIC = Fabric(1e5, 0.3)


def square(*supports):
    return Structure(SQUARE, {"fabric": Membrane([[0, 1, 2], [0, 2, 3]], FABRIC, 1e3)}, supports)


REFUSED = {
    "number": lambda: Fabric(-1.0, 0.3),
    "cells": lambda: Membrane([[0, 1, 1]], FABRIC),
    "node": lambda: square(Support(7)),
    "warp": lambda: Membrane(TRIANGLES, FABRIC, (1e3, 2e3)),
    "part": lambda: Analysis(square(Support(range(4)))).run([Stage("wind", [Pressure(1.0, "roof")])]),
    "supports": lambda: Analysis(square(Support(range(4), "yz"))).run([Stage("rest")]),
    "loads": lambda: equilibrium_path(arch(), Stage("rest")),
    "net": lambda: force_density(SQUARE, [[0, 1], [2, 3]], [1.0, np.inf], [Support(0)]),
}
SENTENCES = {
    "number": "Fabric Et is -1.0; it must be positive.",
    "cells": "Membrane cells: cell 0 has a node twice, [0, 1, 1]; remove or mend the cell.",
    "node": "Support 0 names node 7, which does not exist; nodes are numbered 0 to 3.",
    "warp": (
        "Membrane prestress is [1000.0, 2000.0], which has a warp and a weft; give the warp as a vector, "
        "warp=(x, y, z)."
    ),
    "part": "Stage 'wind' has a load on part 'roof', which does not exist; the parts are ['fabric'].",
    "supports": (
        "The structure is not supported enough: the piece with node 0 (4 nodes: Membrane 'fabric') can move "
        "along x as a rigid body. Add supports or prescribed displacements there."
    ),
    "loads": "Stage 'rest' moves nothing; give it loads or prescribed displacements.",
    "net": "q has a value that is not finite (inf) at index (1,); give finite numbers.",
    "failure": (
        "Stage 'down' found no equilibrium at load factor 1 (the last found is at 0): the tangent stiffness "
        "is singular: nothing holds node 1 in the direction (0, 0, 1). A straight cable without prestress has"
        " no stiffness across; give it a small prestress to begin with (prescribed displacements can bring "
        "the rest), a curved shape, or supports. In the last state tried 'rope' is slack in 2 of 2 cells: "
        "give it prestress, or a shorter length to begin with."
    ),
    "warning": (
        "Part 'tie' is prestressed by 30 %, the strain that belongs to the prestress by the stiffness (cell "
        "0); its law (Axial) is meant for less than 5 %. Check prestress, stiffness and units; if they are "
        "right, take stiffness there for a rough value."
    ),
}


@pytest.mark.parametrize("subject", REFUSED)
def test_refusal(subject):
    with pytest.raises(ValueError, match=f"^{re.escape(SENTENCES[subject])}$"):
        REFUSED[subject]()


def test_failure():
    rope = {"rope": Cable([[0, 1], [1, 2]], 1e6)}
    line = Structure([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], rope, [Support([0, 2]), Support(1, "y")])
    with pytest.raises(ConvergenceError) as failure:
        Analysis(line, Newton(line_search=False)).run([Stage("down", [PointLoad(1, (0, 0, -1.0))])])
    assert str(failure.value) == SENTENCES["failure"]


def test_warning():
    tie = {"tie": Cable([[0, 1]], 1e3, prestress=300.0)}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", LargeStrainWarning)
        Analysis(Structure([[0.0, 0, 0], [2, 0, 0]], tie, [Support([0, 1])])).run([Stage("rest")])
    assert [str(warning.message) for warning in told] == [SENTENCES["warning"]]
