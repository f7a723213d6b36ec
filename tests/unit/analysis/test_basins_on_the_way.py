"""Rain in several basins beside other features: restarts, archives, tables, pictures, paths, stability and drains."""

import csv
import json

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    PointLoad,
    Pond,
    Pressure,
    Stage,
    equilibrium_path,
    load_results,
    report,
    save_results,
    stability,
    write_tables,
)
from fx_membrane.assembly.water import PondEnergy
from wet_roofs import OWN_WEIGHT, ridged_roof, roof_on_a_low_point, tangent_rates

RAIN = Stage("rain", [Pond("roof", rain=0.1)], increments=4, after="own weight")
STAGES = [OWN_WEIGHT, RAIN]


@pytest.fixture(scope="module")
def results():
    return Analysis(ridged_roof(), progress=False).run(STAGES)


class Stop(Exception):
    """The end of a run."""


@pytest.mark.mpi
@pytest.mark.parametrize("most", [2, 3, 4])
def test_restart_keeps_the_basins(most, results, tmp_path_factory):
    from mpi4py import MPI  # noqa: PLC0415

    file = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("run") / "state")
    seen = []

    def stop(state):
        seen.append(state)
        if len(seen) == most:
            raise Stop

    with pytest.raises(Stop):
        Analysis(ridged_roof(), progress=False).run(STAGES, checkpoint_file=file, observe=stop)
    again = Analysis(ridged_roof(), progress=False).run(STAGES, checkpoint_file=file)["rain"]
    expected = results["rain"]
    np.testing.assert_allclose(again.displacement, expected.displacement, atol=1e-9)
    assert [event[:2] + event[3:6] for event in again.water_events] == [
        event[:2] + event[3:6] for event in expected.water_events
    ]
    for mine, other in zip(again.ponds[0].basins, expected.ponds[0].basins, strict=True):
        assert mine.volume == pytest.approx(other.volume, rel=1e-8)
    assert again.ponds[0].lost == pytest.approx(expected.ponds[0].lost, rel=1e-7)


def test_all_outputs_tell_basins_and_events(results, tmp_path):
    state = results["rain"]
    assert {event.kind for event in state.water_events} == {"merger", "spill"}
    told = report(state)
    assert "merge over node" in told
    assert "spills" in told
    save_results(results, tmp_path / "rain.fxm")
    opened = load_results(tmp_path / "rain.fxm")["rain"]
    assert opened.water_events == state.water_events
    assert opened.ponds[0].basins == state.ponds[0].basins
    assert opened.increments[0].basins == state.increments[0].basins
    write_tables(results, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())["stages"]["rain"]
    kinds = {event["kind"] for entry in summary["increments"] for event in entry.get("water events", ())}
    assert kinds == {"merger", "spill"}
    assert summary["ponds"][0]["basins"][0]["volume"] == pytest.approx(state.ponds[0].volume)
    rows = list(csv.DictReader((tmp_path / "membranes.csv").open(encoding="utf-8-sig")))
    depth = {stage: [float(row["water depth [m]"]) for row in rows if row["stage"] == stage] for stage in results}
    assert not any(depth["own weight"])
    a, b, c = state.position[state.structure.parts["roof"].cells].transpose(1, 0, 2)
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert areas @ depth["rain"] == pytest.approx(state.ponds[0].volume, rel=1e-10)
    nodes = csv.DictReader((tmp_path / "nodes.csv").open(encoding="utf-8-sig"))
    found = [float(row["water depth [m]"]) for row in nodes if row["stage"] == "rain"]
    np.testing.assert_allclose(found, state.ponds[0].depth)


def test_water_in_two_basins_is_stable_and_goes_on_as_a_path(results):
    light = Stage("rain", [Pond("roof", rain=0.01)], after="own weight")
    state = Analysis(ridged_roof(), progress=False).run([STAGES[0], light])["rain"]
    assert sum(basin.volume > 1e-3 for basin in state.ponds[0].basins) == 2
    assert stability(state).stable
    more = Stage("more", [Pond("roof", rain=0.005)], after="rain")
    wet = Analysis(ridged_roof(), progress=False).run([STAGES[0], light, more])["more"]
    path = equilibrium_path(state, more)
    np.testing.assert_allclose(path.points[-1].displacement, wet.displacement, atol=1e-7)
    with pytest.raises(ValueError, match="first water"):
        equilibrium_path(results["own weight"], light)


def test_first_order_methods_find_the_same_basins():
    light = Stage("rain", [Pond("roof", rain=0.01)], after="own weight")
    newton = Analysis(ridged_roof(), progress=False).run([STAGES[0], light])["rain"]
    other = Analysis(ridged_roof(), ConjugateGradient(preconditioner="jacobi", rtol=1e-8), progress=False).run(
        [STAGES[0], light]
    )["rain"]
    np.testing.assert_allclose(other.displacement, newton.displacement, atol=1e-6)


@pytest.mark.mpi
def test_tangent_of_water_at_a_drain_that_moves():
    """Residuals at a distance h differ from their tangent, with its one-sided border, by h^2."""
    made = ridged_roof()
    analysis = Analysis(made, progress=False)
    state = analysis.run(STAGES[:1])["own weight"]
    node = int(np.argmin(np.abs(made.points - (0.5, 0.25, 0)).sum(axis=1)))
    rain = Stage("rain", [Pond("roof", rain=0.1, drains=[node])], after="own weight")
    problem = analysis.problem
    actions = problem.actions_of(rain, state.actions, state.displacement)
    loaded, x = problem.under(actions), problem.to_petsc(state.displacement)
    assert [node] in [one.outlets.tolist() for one in loaded.integrals.all if isinstance(one, PondEnergy)]
    assert len(loaded.integrals.following(x)) == 1
    np.testing.assert_allclose(tangent_rates(loaded, state.displacement, made.supported, 1e-4), 2, atol=0.1)
    final = analysis.run([STAGES[0], rain])["rain"]
    basin = next(basin for basin in final.ponds[0].basins if basin.spill == node)
    assert basin.level == pytest.approx(final.position[node, 2], rel=1e-9)
    residuals = [entry.residual for _, entry in final.history]
    assert min(residuals) < 1e-6


def test_path_refuses_a_new_drain_of_rain():
    light = Stage("rain", [Pond("roof", rain=0.01)], after="own weight")
    state = Analysis(ridged_roof(), progress=False).run([STAGES[0], light])["rain"]
    node = int(state.ponds[0].basins[0].node)
    with pytest.raises(ValueError, match=f"drain at node {node}"):
        equilibrium_path(state, Stage("more", [Pond("roof", rain=0.005, drains=[node])], after="rain"))


@pytest.mark.mpi
def test_water_that_spreads_to_other_cells_is_at_rest_there():
    """The shape moves by so much in one increment that the water wets cells outside of its basin."""
    made = roof_on_a_low_point()
    node = int(np.argmin(np.abs(made.points - (-1.0, 1.0, 0)).sum(axis=1)))
    domed = Stage("domed", [Pressure(250.0, "roof"), Pond("roof", rain=0.02)])
    flat = Stage("flat", [Pressure(-250.0, "roof"), PointLoad(node, (0, 0, -300.0))], after="domed")
    states = Analysis(made, progress=False).run([domed, flat])
    before, after = (states[name].ponds[0] for name in states)
    assert after.volume == pytest.approx(before.volume, rel=1e-9)
    assert (after.depth[before.depth == 0] > 0).any()
    assert states["flat"].equilibrium.residual < 1e-8 * np.abs(states["flat"].equilibrium.loads).max()
