"""Structures, results and kinds of arguments that the tables of right arguments share."""

import numpy as np
from dolfinx.mesh import create_unit_square
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Stage,
    Structure,
    Support,
    rectangle,
    updated_reference,
)

POINTS = np.array([[-1.0, 0, 0], [0, 0, 0.3], [1, 0, 0]])
ARCH = Structure(POINTS, {"arch": Mast([[0, 1], [1, 2]], 1e6, mass=1.0)}, [Support([0, 2]), Support(1, "y")])
LOAD = Stage("load", [PointLoad(1, (0, 0, -100.0))])
RESULTS = Analysis(ARCH, comm=MPI.COMM_SELF).run([LOAD])
STATE = RESULTS["load"]
HISTORY = STATE.increments[0].iterations
SQUARE, TRIANGLES = rectangle(1.0, 1.0, 1, 1)
SHEET = Structure(SQUARE, {"sheet": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3)}, [Support(range(4))])
FORM = updated_reference(SHEET)
BAR = {
    "cells": [[0, 1], [1, 2]],
    "axial_stiffness": 1e6,
    "prestress": [1.0, 2.0],
    "mass": 1.0,
    "material": None,
    "natural_stretch": [1.0, 1.1],
}
BARS = {
    "cells": "rows",
    "axial_stiffness": "number",
    "prestress": "array",
    "mass": "number",
    "material": "object?",
    "natural_stretch": "array",
}
MODULUS = {"cells": [[0, 1]], "E": 1e9, "area": 1e-4, "prestress": 0.0, "density": 1.0}
MODULI = {"cells": "rows", "E": "number", "area": "number", "prestress": "array", "density": "number"}
SPREAD = {"load": [0.0, 0.0, 1.0], "part": "sheet", "cells": [0]}, {"load": "array", "part": "text", "cells": "rows?"}
FIRST_ORDER = {"preconditioner": None, "rtol": 1e-3, "max_iterations": 5}
FIRST_ORDERS = {"preconditioner": "object?", "rtol": "number", "max_iterations": "whole"}
UNITS = {"force_unit": "text", "energy_unit": "text"}
UNIT_NAMES = {"force_unit": "N", "length_unit": "m"}
UNIT_KINDS = dict.fromkeys(UNIT_NAMES, "text")
OWN_UNITS = dict.fromkeys(UNIT_NAMES, "text?")  # those of the results, if not given
WRITER = {"results": RESULTS, "folder": "a", **UNIT_NAMES}, {"results": "object", "folder": "path", **OWN_UNITS}
COMM = {"comm": MPI.COMM_SELF}
MESH = create_unit_square(MPI.COMM_SELF, 1, 1)
MODES = {"state": STATE, "count": 1, **COMM}, {"state": "object", "count": "whole", "comm": "object"}
