"""Results keep the problem on which they were computed: modes and paths continue on its meshes."""

import copy
import dataclasses
import pickle

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    PointLoad,
    Problem,
    Stage,
    equilibrium_path,
    natural_frequencies,
    stability,
)
from fx_membrane.assembly.discretization import Discretization
from models import CENTRE, arch, sheet

WORLD = MPI.COMM_WORLD
STAGES = [Stage("rest"), Stage("push", [PointLoad(CENTRE, (0, 0, -50.0))], after="rest")]
SHEET = sheet()
for part in SHEET.parts.values():
    object.__setattr__(part, "mass", 1.0)


@pytest.fixture
def made(monkeypatch):
    """List of the discretizations made."""
    calls = []
    monkeypatch.setattr(
        "fx_membrane.assembly.problem.Discretization", lambda *args: calls.append(1) or Discretization(*args)
    )
    return calls


@pytest.fixture
def states():
    analysis = Analysis(SHEET)
    return analysis, analysis.run(STAGES)


@pytest.mark.mpi
def test_everything_after_an_analysis_continues_on_its_meshes(made):
    analysis = Analysis(SHEET)
    results = analysis.run(STAGES)
    rest = results["rest"]
    assert rest.problem is results["push"].problem is analysis.problem
    stability(rest)
    natural_frequencies(rest, 2)
    path = equilibrium_path(rest, STAGES[1], max_points=2)
    assert path.problem is path.state(-1).problem is analysis.problem
    stability(path.state(-1))
    assert len(made) == 1


@pytest.mark.mpi
def test_path_of_a_structure_makes_its_meshes_once(made):
    path = equilibrium_path(arch(), Stage("push", [PointLoad(1, (0, 0, -1e3))], increments=4), max_points=3)
    assert path.state(0).problem is path.state(1).problem is path.problem
    assert len(made) == 1


COPIES = {
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
    "pickle": lambda state: pickle.loads(pickle.dumps(state)),
    "pickle, but on the first process": lambda state: state if WORLD.rank == 0 else pickle.loads(pickle.dumps(state)),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", COPIES)
def test_a_copy_has_no_problem_until_it_is_asked(states, made, kind):
    state = COPIES[kind](states[1]["push"])
    partly = "but" in kind
    assert (state.owner is None) == (not partly or WORLD.rank > 0)
    expected = stability(states[1]["push"])
    made.clear()
    found = [stability(state), stability(state)]
    assert len(made) == (not partly or WORLD.size > 1)
    assert state.problem is state.owner
    for one in found:
        np.testing.assert_allclose(one.stiffnesses, expected.stiffnesses, rtol=1e-9)


@pytest.mark.mpi
def test_results_of_stages_and_paths_are_copied(states):
    path = equilibrium_path(states[1]["rest"], STAGES[1], max_points=2)
    for copied in (copy.deepcopy(path), pickle.loads(pickle.dumps(path))):
        assert copied.owner is None
        assert copied.points[1].displacement.tolist() == path.points[1].displacement.tolist()
        assert copied.state(1).energy == pytest.approx(path.state(1).energy, rel=1e-12)
    copied = pickle.loads(pickle.dumps(states[1]))
    assert all(state.owner is None for state in copied.values())
    assert dataclasses.asdict(states[1]["rest"])["owner"] is states[0].problem


@pytest.mark.mpi
def test_other_processes_get_meshes_of_their_own(states, made):
    state = states[1]["push"]
    made.clear()
    alone = stability(state, comm=MPI.COMM_SELF)
    assert len(made) == (WORLD.size > 1)
    assert state.problem is states[0].problem
    np.testing.assert_allclose(alone.stiffnesses, stability(state).stiffnesses, rtol=1e-9)


@pytest.mark.mpi
def test_processes_that_hold_states_of_other_problems_agree(states):
    """Equal states with two problems, one on the first process, the other on the rest."""
    state, other = states[1]["push"], Problem(SHEET)
    mixed = dataclasses.replace(state, owner=state.owner if WORLD.rank == 0 else other)
    np.testing.assert_allclose(stability(mixed).stiffnesses, stability(state).stiffnesses, rtol=1e-9)
    numbers = WORLD.allgather(mixed.problem.number)
    assert len(set(numbers)) == 1


def test_state_of_another_structure_does_not_keep_the_problem(states):
    other = sheet(prestress=2e3)
    state = dataclasses.replace(states[1]["rest"], structure=other)
    assert state.problem.structure is other
    assert stability(state).stiffnesses[0] > 1.5 * stability(states[1]["rest"]).stiffnesses[0]


@pytest.mark.mpi
def test_state_of_a_checkpoint_is_cold(path):
    expected = Analysis(SHEET).run(STAGES, path)
    again = Analysis(SHEET).run(STAGES, path)["push"]
    np.testing.assert_allclose(stability(again).stiffnesses, stability(expected["push"]).stiffnesses, rtol=1e-9)


def test_problem_is_neither_printed_nor_compared(states):
    state = states[1]["push"]
    assert "roblem" not in repr(state)
    assert state != states[1]["rest"]
    assert isinstance(state.problem, Problem)
