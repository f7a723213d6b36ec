"""Energy terms in analyses, paths and sums of loads: scaled by the load factor, added up."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    DistributedLoad,
    Mast,
    Newton,
    Pressure,
    Stage,
    Structure,
    Support,
    equilibrium_path,
    natural_frequencies,
    report,
    stability,
)
from fx_membrane.assembly.actions import between
from fx_membrane.assembly.problem import Problem
from models import CENTRE, EDGE, close, inclined_sheet, rotation, same_state, sheet
from own_terms import ElasticBed, Follower, Ground, Water, WaterWork, random

WATER = Water("fabric", 2e3, 0.3)
BED = ElasticBed("fabric", 400.0)
SNOW = DistributedLoad((0, 0, -200.0), "fabric")


@pytest.mark.mpi_once
@pytest.mark.parametrize("solver", [Newton(), Newton(line_search=False), ConjugateGradient(rtol=1e-9)])
@pytest.mark.parametrize("water", [WATER, WaterWork("fabric", 2e3, 0.3)])
def test_balance(solver, water):
    structure = replace(inclined_sheet(), terms=[BED, Ground("fabric", 5e4, -0.05, (0.1, 0.0, 1.0))])
    results = Analysis(structure, solver).run([Stage("water", [water]), Stage("snow", [SNOW], after="water")])
    for result in results.values():
        balance, size = result.equilibrium, np.abs(result.loads).sum()
        tolerance = 1e-10 * size if isinstance(solver, Newton) else 1e-7 * size
        assert balance.loads + balance.reactions == pytest.approx(0, abs=tolerance)
        assert balance.load_moment + balance.reaction_moment == pytest.approx(0, abs=tolerance)
        assert balance.residual < tolerance
        assert not result.remarks
        of_terms = sum(term.forces for term in result.terms)
        fixed = result.actions.loads
        assert close(result.loads, fixed + of_terms)
        assert [term.factor for term in result.terms] == [1.0, 1.0, 1.0]
        for term in result.terms:
            assert np.abs(term.forces).max() > 1.0
            words = f"{type(term.term).__name__} on 'fabric': sum of forces ("
            assert words in report(result)


def test_stages_keep_terms_and_the_structure_has_its_own():
    bed = ElasticBed("fabric", 300.0)
    stages = [Stage("snow", [SNOW]), Stage("bed", [bed], after="snow"), Stage("twice", [bed], after="bed")]
    stages += [Stage("more snow", [SNOW], after="bed"), Stage("only bed", [bed])]
    in_stages = Analysis(sheet()).run(stages)
    for name, k, load in [("bed", 300.0, 1), ("twice", 600.0, 1), ("more snow", 300.0, 2), ("snow", 0.0, 1)]:
        structure = replace(sheet(), terms=[ElasticBed("fabric", k)] if k else [])
        expected = Analysis(structure).run([Stage("snow", [SNOW] * load)])["snow"]
        assert same_state(in_stages[name], expected)
    assert [term.factor for term in in_stages["twice"].terms] == [2.0]
    assert not in_stages["only bed"].loads.any()


def test_load_factor_scales_terms_of_the_stage_alone():
    structure, spring = replace(inclined_sheet(), terms=[BED]), ElasticBed("fabric", 1e3)
    problem = Problem(structure)
    start = problem.actions_of(Stage("snow", [SNOW]))
    end = problem.actions_of(Stage("more", [spring, WATER, Pressure(50.0, "fabric")]), start)
    x, quarter, half = random(problem.under(), 5), *(between(start, end, factor) for factor in (0.25, 0.5))
    difference = problem.under(half).residual(x)
    difference.axpy(-1.0, problem.under(quarter).residual(x))
    expected = 0.25 * problem.to_numpy(problem.under(end).load_derivative(x, start))
    assert close(problem.to_numpy(difference), expected)
    alone = -problem.to_numpy(problem.under(end).load_derivative(x))
    assert close(alone + problem.under().term_forces(x)[0][1],
                 sum(forces for _, forces in problem.under(end).term_forces(x)) + end.loads
                 + problem.under(end).pressure_loads(x))  # fmt: skip


@pytest.mark.mpi_once
@pytest.mark.parametrize("water", [WATER, WaterWork("fabric", 2e3, 0.3)])
def test_path(water):
    """Points of a path are the states of stages under the same factor; terms with a potential have their pivots."""
    structure = replace(inclined_sheet(), terms=[BED])
    stage = Stage("water", [water], increments=3)
    path = equilibrium_path(structure, stage)
    assert path.complete
    pivots = path.negative_pivots
    assert pivots is None if isinstance(water, WaterWork) else not pivots.any()
    middle = len(path.points) // 2
    factor = path.load_factors[middle]
    weaker = replace(water, weight=factor * water.weight)
    expected = Analysis(structure).run([Stage("water", [weaker])])["water"]
    assert close(path.displacements[middle], expected.displacement)
    state = path.state(middle)
    assert close(state.loads, expected.loads)
    assert state.terms[1].factor == factor


def test_bed_alone_holds_a_sheet():
    """Supports across the bed only: the check of supports leaves the rest to the bed."""
    supports = [Support(EDGE, "xy")]
    with pytest.raises(ValueError, match="move along z"):
        Analysis(sheet(*supports)).run([Stage("snow", [SNOW])])
    state = Analysis(replace(sheet(*supports), terms=[BED])).run([Stage("snow", [SNOW])])["snow"]
    assert state.displacement[:, 2] == pytest.approx(-200 / 400, rel=1e-9)
    assert state.equilibrium.loads == pytest.approx(0, abs=1e-9)
    assert not state.remarks
    assert stability(state, 1).stable


@pytest.mark.mpi
def test_stability_counts_a_concave_term():
    """A bed that pushes away, stronger than the sheet: the flat state is unstable."""
    weak, strong = (
        Analysis(replace(sheet(), terms=[ElasticBed("fabric", -k)])).run([Stage("rest")])["rest"] for k in (2e3, 2e4)
    )
    assert stability(weak, 1).negative == 0
    assert stability(strong, 1).negative > 0


def test_copy_of_a_state_has_its_terms():
    structure = sheet()
    structure = Structure(
        structure.points, {"fabric": replace(structure.parts["fabric"], mass=1.0)}, structure.supports, terms=[BED]
    )
    state = Analysis(structure).run([Stage("snow", [SNOW])])["snow"]
    expected = natural_frequencies(state, 2).frequencies
    assert close(natural_frequencies(copy.deepcopy(state), 2).frequencies, expected)


def test_results_do_not_depend_on_orientation_of_space():
    """Contact with a plane, turned with the structure."""
    Q = rotation(4)
    states = []
    for turn in (np.eye(3), Q):
        ground = Ground("fabric", 1e4, -0.02, tuple(turn[:, 2]))
        structure = replace(sheet(points=inclined_sheet().points @ turn.T), terms=[ground])
        load = DistributedLoad(turn @ (0, 0, -400.0), "fabric")
        states.append(Analysis(structure).run([Stage("snow", [load])])["snow"])
    assert close(states[1].displacement, states[0].displacement @ Q.T)
    assert states[0].terms[0].forces[CENTRE, 2] > 1


@pytest.mark.mpi
def test_part_of_which_a_process_has_no_cell():
    points = np.vstack([inclined_sheet().points, [[0, 0, -1.0]]])
    fabric = inclined_sheet().parts["fabric"]
    parts = {"stay": Mast([[CENTRE, len(points) - 1]], 1e5), "fabric": fabric}
    supports = [Support(EDGE), Support(len(points) - 1, "xy")]
    terms = [ElasticBed("stay", 900.0), Follower("stay", (1.0, 0, 2.0))]
    structure = Structure(points, parts, supports, terms=terms)
    stages = [Stage("load", [SNOW, WATER, ElasticBed("stay", 5.0), ElasticBed("fabric", 5.0, range(9))])]
    all_processes = Analysis(structure).run(stages)["load"]
    alone = Analysis(structure, comm=MPI.COMM_SELF).run(stages)["load"]
    assert same_state(all_processes, alone)
    assert all_processes.energy == pytest.approx(alone.energy, rel=1e-9)
    assert all_processes.terms[0].forces[-1, 2] > 0
    assert not all_processes.remarks


@pytest.mark.mpi
def test_checkpoint_of_other_terms_is_refused(tmp_path):
    path = MPI.COMM_WORLD.bcast(tmp_path / "run")

    def run(k, weight=WATER.weight):
        structure = replace(inclined_sheet(), terms=[ElasticBed("fabric", k)])
        return Analysis(structure).run([Stage("water", [replace(WATER, weight=weight)])], path)["water"]

    expected = run(400.0)
    again = run(400)
    assert np.array_equal(again.displacement, expected.displacement)
    assert len(again.history) == len(expected.history)
    with pytest.raises(ValueError, match="is of another structure, which differs in: terms"):
        run(401.0)
    with pytest.raises(ValueError, match="has another stage 'water', which differs in: loads"):
        run(400.0, 2.1e3)


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one process agrees with itself")
def test_terms_that_differ_between_processes_are_refused():
    k = 400.0 + MPI.COMM_WORLD.rank
    with pytest.raises(ValueError, match="differs from that of process 0 in: terms"):
        Analysis(replace(inclined_sheet(), terms=[ElasticBed("fabric", k)]))
    with pytest.raises(ValueError, match="differs from that of process 0 in: loads of stage 'a'"):
        Analysis(inclined_sheet()).run([Stage("a", [ElasticBed("fabric", k)])])


@pytest.mark.mpi_once
@pytest.mark.parametrize("k", [1e5, 1e8])
def test_stiff_contact(k):
    """Penetration falls with the penalty; forces balance, and no remark is made."""
    state = Analysis(replace(sheet(), terms=[Ground("fabric", k, -0.02)])).run([Stage("snow", [SNOW])])["snow"]
    assert not state.remarks
    assert -0.02 - 2 * 200.0 / k < state.position[CENTRE, 2] < -0.02
    assert state.equilibrium.residual < 1e-8 * state.terms[0].forces[:, 2].sum()
