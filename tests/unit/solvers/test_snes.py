"""SNES instead of dolfinx's NewtonSolver: the same iterates and the same sentences."""

import numpy as np
import pytest
from dolfinx import cpp

from fx_membrane import (
    Analysis,
    ConvergenceError,
    Fabric,
    Membrane,
    Newton,
    PointLoad,
    Stage,
    Structure,
    Support,
)
from fx_membrane.assembly.actions import unloaded
from fx_membrane.assembly.problem import Problem
from hard_structures import hanging
from models import EDGE, POINTS, TRIANGLES

SUPPORTS = [Support(EDGE)]
STAGES = [Stage("load", [PointLoad(12, (0, 0, -3.0))], increments=2)]


def structure(prestress):
    return Structure(POINTS, {"fabric": Membrane(TRIANGLES, Fabric(1e3, 0.3), prestress=prestress)}, SUPPORTS)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("prestress", "solver"), [(0.0, Newton()), (10.0, Newton()), (10.0, Newton(line_search=False))]
)
def test_same_iterates(prestress, solver, monkeypatch):
    expected = Analysis(structure(prestress), solver).run(STAGES)["load"]
    monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    found = Analysis(structure(prestress), solver).run(STAGES)["load"]
    assert len(found.history) == len(expected.history)
    np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-14)
    for (factor, entry), (expected_factor, expected_entry) in zip(found.history, expected.history, strict=True):
        assert factor == expected_factor
        np.testing.assert_allclose(entry, expected_entry, rtol=1e-9, atol=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("prestress", "solver"),
    [(0.0, Newton(line_search=False)), (10.0, Newton(max_iterations=1, line_search=False))],
)
def test_same_words(prestress, solver, monkeypatch):
    words = []
    for _ in range(2):
        with pytest.raises(ConvergenceError) as failure:
            Analysis(structure(prestress), solver).run(STAGES)
        words.append((str(failure.value), len(failure.value.failed.iterations)))
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    assert words[0] == words[1]


@pytest.mark.mpi_once
@pytest.mark.parametrize("most", [1000, 70])
def test_bound_of_iterations_is_that_of_the_solver(most, monkeypatch):
    """A wavy cable that hangs down takes 80 iterations; SNES alone would stop at 50."""
    cable, stages = hanging(0.5, 1.0)
    problem = Problem(cable)
    loaded = problem.under(problem.actions_of(stages[0], unloaded(cable)))
    found = []
    for _ in range(2):
        solution = Newton(max_iterations=most).prepare(problem)(loaded, problem.create_vector())
        found.append((solution.outcome, len(solution.iterations), solution.extra_iterations, solution.reason))
        monkeypatch.delattr(cpp.nls.petsc, "NewtonSolver", raising=False)
    assert found[0] == found[1]
    assert found[0][1] > 1 + 60
