"""An analysis that is no longer used gives its memory back, though C and C++ hold callbacks into it."""

import gc
import weakref

import numpy as np
import pytest
from dolfinx import cpp

from fx_membrane import Analysis, Fabric, Membrane, PointLoad, Stage, Structure, Support, boundary, rectangle


@pytest.mark.parametrize("driver", ["dolfinx", "snes"])
def test_problem_is_released(driver, monkeypatch):
    if driver == "snes":
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    points, triangles = rectangle(1.0, 1.0, 2, 2)
    edge = np.unique(boundary(triangles))
    structure = Structure(points, {"fabric": Membrane(triangles, Fabric(1e3, 0.3), prestress=10.0)}, [Support(edge)])
    analysis = Analysis(structure)
    analysis.run([Stage("load", [PointLoad(4, (0, 0, -0.1))])])
    problem = weakref.ref(analysis._problem)
    del analysis
    gc.collect()
    assert problem() is None
