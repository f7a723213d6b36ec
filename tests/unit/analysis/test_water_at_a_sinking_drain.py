"""Water at a drain that sinks with the roof: stability, convergence, and independence of the increments.

The level follows the drain where that sinks, by a tangent that is not symmetric; where it rises, the water keeps its
volume. Reference: eigenvalues of dense tangents, by differences of residuals with a little more and less water than the
basin holds.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Newton,
    Pond,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
    stability,
)
from fx_membrane.results.owner import problem_of

DEAD = Stage("dead", [DistributedLoad((0, 0, -150.0), "roof")])


def ridged(nx=12, ny=8):
    """Level roof within a wall, with a ridge cable of little force."""
    points, triangles = rectangle(6.0, 4.0, nx, ny)
    rim, ridge = np.unique(boundary_edges(triangles)), np.flatnonzero(np.isclose(points[:, 0], 0.0))
    cable = Cable(polyline(ridge[np.argsort(points[ridge, 1])]), 1e6, 3.7e3)
    parts = {"roof": Membrane(triangles, Fabric(1.6e5, 0.3), 2.3e3), "ridge": cable}
    return Structure(points, parts, [Support(rim)]), rim


def drained(increments=2):
    """State of that roof with a drain beside the ridge, after rain that fills the basin of the drain."""
    made, rim = ridged()
    drain = int(np.argmin(np.abs(made.points - (-1, -1, 0)).sum(axis=1)))
    rain = Stage("rain", [Pond("roof", rain=0.035, drains=[drain], walls=rim)], increments=increments, after="dead")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return Analysis(made, progress=False).run([DEAD, rain])["rain"]


@pytest.fixture(scope="module")
def full():
    return drained()


def with_water(state, factor):
    """Problem of a state, under its actions with another volume of water in all basins."""
    ponds = []
    for entry in state.actions.ponds:
        basins = tuple(basin._replace(volume=factor * basin.volume) for basin in entry.water.basins)
        ponds.append(entry._replace(water=entry.water._replace(basins=basins)))
    problem = problem_of(state, MPI.COMM_WORLD)
    return problem, problem.under(replace(state.actions, ponds=tuple(ponds)))


def dense(state, factor, h=1e-6):
    """Tangent of the free components by central differences."""
    problem, loaded = with_water(state, factor)
    free = np.flatnonzero(~state.actions.held.ravel())

    def residual(component, change):
        moved = state.displacement.copy()
        moved.flat[component] += change
        return problem.to_numpy(loaded.residual(problem.to_petsc(moved))).flat[free]

    return np.column_stack([(residual(one, h) - residual(one, -h)) / (2 * h) for one in free])


def test_stability_is_that_of_water_that_runs_off_and_of_water_that_stays(full):
    (basin,) = full.ponds[0].basins
    assert basin.is_full
    assert not full.actions.held[basin.spill, 2]
    followed, kept = dense(full, 1.01), dense(full, 0.9999)
    assert np.abs(followed - followed.T).max() > 100
    np.testing.assert_allclose(kept, kept.T, atol=1)
    lowest = [np.sort(np.linalg.eigvals(K).real)[:3] for K in (followed, kept)]
    assert np.linalg.eigvalsh((followed + followed.T) / 2)[0] < 0  # the symmetric part has no meaning here
    found = stability(full, 3)
    np.testing.assert_allclose(found.stiffnesses, min(lowest, key=lambda values: values[0]), rtol=1e-2)
    assert found.stable


def test_increments_do_not_matter_and_few_iterations_are_enough(full):
    assert len(full.history) <= 30
    fine = drained(16)
    assert fine.ponds[0].volume == pytest.approx(full.ponds[0].volume, rel=1e-8)
    np.testing.assert_allclose(fine.displacement, full.displacement, atol=1e-8)
    assert fine.ponds[0].volume + fine.ponds[0].lost == pytest.approx(24 * 0.035, rel=1e-12)


@pytest.mark.mpi
def test_quadratic_rate(full):
    """From a disturbed shape, with more rain than the basin holds: no shift at the end, and digits double."""
    problem, loaded = with_water(full, 1.5)
    rng = np.random.default_rng(3)
    noise = np.where(full.actions.held, 0.0, rng.normal(scale=1e-3, size=full.displacement.shape))
    x = problem.to_petsc(full.displacement + noise)
    assert loaded.integrals.following(x)
    solution = Newton(rtol=1e-12).prepare(problem)(loaded, x)
    assert solution.converged
    np.testing.assert_allclose(problem.to_numpy(x), full.displacement, atol=1e-7)
    residuals = np.array([entry.residual for entry in solution.iterations])
    last = residuals[residuals > 1e-7]
    assert [entry.shift for entry in solution.iterations][-2:] == [0, 0]
    assert len(solution.iterations) <= 8
    assert np.log(last[-1] / last[-2]) / np.log(last[-2] / last[-3]) > 1.7
