"""Water of a shape is found once, however often energies, forces and borders ask for it."""

import numpy as np
import pytest

from fx_membrane import Problem
from fx_membrane.assembly.pond_cells import PondCells
from fx_membrane.geometry import water_on_triangles
from wet_roofs import roof_on_a_low_point


@pytest.mark.mpi
def test_level_is_looked_for_once_in_each_shape(monkeypatch):
    problem = Problem(roof_on_a_low_point())
    points, triangles = problem.structure.points, problem.structure.parts["roof"].cells
    cells = PondCells(problem.discretization, triangles, np.array([0]))
    evaluated, volumes = [], water_on_triangles.volumes
    monkeypatch.setattr(water_on_triangles, "volumes", lambda *args: evaluated.append(1) or volumes(*args))
    x = problem.to_petsc(np.zeros_like(points))
    found = [cells.holding(cells.places(x), amount) for amount in (0.01, 0.02)]
    searched = len(evaluated)
    assert [cells.holding(cells.places(x), amount) for amount in (0.01, 0.02)] == found
    assert len(evaluated) == searched > 0
    # A node of one process that moves changes the water on all.
    lower = np.zeros_like(points)
    lower[np.argmin(points[:, 2]), 2] = -0.01
    y = problem.to_petsc(lower)
    moved = cells.holding(cells.places(y), 0.01)
    assert moved.volume == pytest.approx(0.01, rel=1e-12)
    assert moved.level < found[0].level
    anew = PondCells(problem.discretization, triangles, np.array([0]))
    assert anew.holding(anew.places(y), 0.01) == moved
