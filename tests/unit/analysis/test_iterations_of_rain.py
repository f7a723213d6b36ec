"""Iterations of the rounds of rain: bound and count are those of one try of a load increment."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    ConvergenceError,
    Fabric,
    Membrane,
    Newton,
    PointLoad,
    Pond,
    Stage,
    Structure,
    Support,
    WorkLimit,
    boundary_edges,
    rectangle,
)

PLACES = [(0.0, 0.0), (2.5, 0.0), (-2.5, 0.0), (0.0, 2.5), (0.0, -2.5)]


def dented():
    """Return a flat sheet with five dents, and rain that runs from one to another."""
    points, triangles = rectangle(10.0, 10.0, 8, 8)
    edge = np.unique(boundary_edges(triangles))
    structure = Structure(points, {"roof": Membrane(triangles, Fabric(5e5, 0.3), prestress=2e3)}, [Support(edge)])
    nodes = [int(np.linalg.norm(points[:, :2] - place, axis=1).argmin()) for place in PLACES]
    dents = [PointLoad(node, (0, 0, -500.0 - 100 * number)) for number, node in enumerate(nodes)]
    return structure, [Stage("dents", dents), Stage("rain", [Pond("roof", rain=0.05)], after="dents")]


@pytest.mark.mpi
def test_rounds_count_together(steps):
    structure, stages = dented()
    (increment,) = Analysis(structure).run(stages)["rain"].increments
    made, _, *rounds = steps
    assert (made, len(rounds)) == (0, 2)
    assert increment.total_iterations == len(increment.iterations) - 1 == sum(rounds)


def test_rounds_share_the_bound_of_a_try():
    """With 8 iterations the rain, which needs 4 and 6 at once, comes in halves."""
    structure, stages = dented()
    increments = Analysis(structure, Newton(max_iterations=8)).run(stages)["rain"].increments
    assert len(increments) > 1
    assert max(increment.total_iterations for increment in increments) <= 8


def test_rounds_by_conjugate_gradients_share_the_bound():
    structure, stages = dented()
    solver = ConjugateGradient(preconditioner="tangent", rtol=1e-4)
    (increment,) = Analysis(structure, solver).run(stages)["rain"].increments
    most = increment.total_iterations - 1
    with pytest.raises(ConvergenceError, match=r"Before that, water ran on in rounds, which took \d+ iterations") as e:
        Analysis(structure, replace(solver, max_iterations=most)).run(stages)
    assert e.value.failed.total_iterations == most


def test_limit_of_work_counts_each_round_once(steps):
    structure, stages = dented()
    with pytest.raises(ConvergenceError) as e:
        Analysis(structure, limit=WorkLimit(iterations=7)).run(stages)
    assert e.value.failed.total_iterations == sum(steps[2:]) == 8
