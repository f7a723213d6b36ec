"""Full basins that spill into others within Newton's loop: a roof of three terraces, the upper two of them full.

Each ridge sinks with the water on both sides, so that spilt water changes how much the basin above holds.
References: the balance of the rain in each basin, with volumes from the shape; differences of residuals.
"""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Analysis, Newton, Pond, Stage, equilibrium_path, stability
from fx_membrane.geometry import water_on_triangles
from fx_membrane.results.owner import problem_of
from wet_roofs import OWN_WEIGHT, tangent_rates, terraced_roof

DEPTH = 0.012
RAIN = Stage("rain", [Pond("roof", rain=DEPTH)], after="own weight")


@pytest.fixture(scope="module")
def terraces():
    return Analysis(terraced_roof(), progress=False).run([OWN_WEIGHT, RAIN])["rain"]


def with_more(state, volume):
    """Problem of a state, under its actions with more rain on the uppermost basin."""
    (entry,) = state.actions.ponds
    first, *others = entry.water.basins
    basins = (first._replace(volume=first.volume + volume), *others)
    problem = problem_of(state, MPI.COMM_WORLD)
    ponds = (entry._replace(water=entry.water._replace(basins=basins)),)
    return problem, problem.under(replace(state.actions, ponds=ponds))


@pytest.mark.mpi
def test_all_rain_is_in_the_basins_below(terraces):
    """Upper basins hold what their shape holds up to the ridge; the lowest one has all the rest."""
    upper, middle, lower = terraces.ponds[0].basins
    assert [basin.is_full for basin in (upper, middle, lower)] == [True, True, False]
    water = terraces.actions.ponds[0].water
    triangles = terraces.structure.parts["roof"].cells
    held = []
    for basin, found in zip(terraces.ponds[0].basins, water.basins, strict=True):
        corners = terraces.position[triangles[found.cells]]
        held.append(float(water_on_triangles.volumes(corners, basin.level)[0].sum()))
        if basin.is_full:
            assert basin.level == pytest.approx(terraces.position[basin.spill, 2], abs=1e-12)
    own = np.array([found.share for found in water.basins]) * DEPTH * 12
    spilt = own[0] - held[0], own[0] + own[1] - held[0] - held[1]
    assert min(spilt) > 0.01
    np.testing.assert_allclose([basin.volume for basin in (upper, middle, lower)], held, rtol=1e-10)
    assert lower.volume == pytest.approx(own[2] + spilt[1], rel=1e-9)
    events = {(event.kind, event.basin, event.other): event.volume for event in terraces.water_events}
    pairs = ("spill", upper.node, middle.node), ("spill", middle.node, lower.node)
    assert events == pytest.approx(dict(zip(pairs, spilt, strict=True)), rel=1e-9)
    assert terraces.ponds[0].lost == pytest.approx(0, abs=1e-9)
    assert terraces.equilibrium.residual < 1e-7


def test_one_solution_is_enough(terraces):
    (increment,) = terraces.increments
    assert len(terraces.history) <= 8
    assert increment.extra_iterations == 0
    fine = replace(RAIN, increments=4)
    states = Analysis(terraced_roof(), progress=False).run([OWN_WEIGHT, fine])["rain"]
    np.testing.assert_allclose(states.displacement, terraces.displacement, atol=1e-8)


@pytest.mark.mpi
def test_tangent_of_a_chain_of_basins(terraces):
    """Residuals at a distance h differ from their tangent, with its one-sided borders, by h^2."""
    problem, loaded = with_more(terraces, 0.01)
    x = problem.to_petsc(terraces.displacement)
    assert len(loaded.integrals.following(x)) == 3
    rates = tangent_rates(loaded, terraces.displacement, terraces.actions.held, 1e-5)
    np.testing.assert_allclose(rates, 2, atol=0.1)


def test_quadratic_rate(terraces):
    problem, loaded = with_more(terraces, 0.005)
    x = problem.to_petsc(terraces.displacement)
    solution = Newton(rtol=1e-12).prepare(problem)(loaded, x)
    assert solution.converged
    residuals = np.array([entry.residual for entry in solution.iterations])
    last = residuals[residuals > 1e-7]
    assert [entry.shift for entry in solution.iterations][-2:] == [0, 0]
    assert len(solution.iterations) <= 7
    assert np.log(last[-1] / last[-2]) / np.log(last[-2] / last[-3]) > 1.7


def test_stability_knows_water_that_runs_into_the_next_basin(terraces):
    """Lowest eigenvalues are those of a dense tangent by differences, under so much rain that none stops to spill."""
    free = np.flatnonzero(~terraces.actions.held.ravel())

    def dense(more, h=1e-6):
        problem, loaded = with_more(terraces, more)

        def residual(component, change):
            moved = terraces.displacement.copy()
            moved.flat[component] += change
            return problem.to_numpy(loaded.residual(problem.to_petsc(moved))).flat[free]

        start = residual(0, 0.0)
        return np.column_stack([(residual(one, h) - start) / h for one in free])

    followed = np.sort(np.linalg.eigvals(dense(2e-5)).real)[:2]
    found = stability(terraces, 2)
    assert found.stable
    np.testing.assert_allclose(found.stiffnesses, followed, rtol=2e-2)


def test_path_goes_on_over_the_ridges(terraces):
    """A path spills, too: its end is that of a stage."""
    more = Stage("more", [Pond("roof", rain=2e-4)], after="rain")
    path = equilibrium_path(terraces, more)
    end = Analysis(terraced_roof(), progress=False).run([OWN_WEIGHT, RAIN, more])["more"]
    np.testing.assert_allclose(path.points[-1].displacement, end.displacement, atol=1e-8)
