"""Checkpoints: an interrupted run resumes, and nothing is computed twice."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import interrupted
from fx_membrane import (
    Analysis,
    Newton,
    PointLoad,
    Stage,
)
from fx_membrane.analysis.checkpoint_file import CheckpointFile
from interrupted import Killed, assert_same, counted, cut_short, stages, structure


@pytest.fixture(scope="module")
def expected():
    return Analysis(structure()).run(stages())


def test_run_with_a_checkpoint_gives_what_one_without_gives(path, expected):
    assert_same(Analysis(structure()).run(stages(), path), expected)
    assert path.exists()


@pytest.mark.mpi_once
@pytest.mark.parametrize("most", [1, 2, 4, 6])
def test_run_cut_short_goes_on_and_computes_nothing_twice(path, expected, most):
    cut_short(path, most)
    analysis = Analysis(structure())
    calls = counted(analysis)
    assert_same(analysis.run(stages(), path), expected)
    assert len(calls) == 7 - most


@pytest.mark.mpi
def test_complete_run_is_read_and_not_computed(path, expected):
    Analysis(structure()).run(stages(), path)
    again = Analysis(structure())
    calls = counted(again)
    assert_same(again.run(stages(), path), expected)
    assert not calls


def test_path_may_be_a_string_and_of_any_ending(path, expected):
    odd = str(path.with_name("state of the roof"))
    Analysis(structure()).run(stages(), odd)
    assert os.path.exists(odd)
    again = Analysis(structure())
    calls = counted(again)
    assert_same(again.run(stages(), odd), expected)
    assert not calls


def test_stages_can_be_added(path, expected):
    Analysis(structure()).run(stages()[:2], path)
    more = Analysis(structure())
    calls = counted(more)
    assert_same(more.run(stages(), path), expected)
    assert len(calls) == 2


def test_stages_that_are_left_out_stay_in_the_file(path, expected):
    Analysis(structure()).run(stages(), path)
    fewer = Analysis(structure())
    calls = counted(fewer)
    lift, *_ = stages()
    other = Stage("other", after="lift")
    assert list(fewer.run([lift, other], path)) == ["lift", "other"]
    assert len(calls) == 1
    again = Analysis(structure())
    calls = counted(again)
    assert_same(again.run(stages(), path), expected)
    assert not calls
    with pytest.raises(ValueError, match=r"stage 'snow'.*differs.*loads"):
        again.run(stages(snow=-201.0), path)


def test_steps_may_change(path, expected):
    cut_short(path, 3)  # the first of three steps of snow is done
    finer = Analysis(structure())
    snow = finer.run(stages(increments=12)[:2], path)["snow"]
    factors = [increment.load_factor for increment in snow.increments]
    assert factors == pytest.approx([1 / 3 + k / 12 for k in range(9)])
    largest = np.abs(expected["snow"].displacement).max()
    assert snow.displacement == pytest.approx(expected["snow"].displacement, abs=1e-9 * largest)


def test_halved_increments_go_on_with_the_same_length(path):
    hard = [Stage("load", [PointLoad(6, (0, 0, -2e4))])]
    solver = Newton(max_iterations=4, line_search=False)
    expected = Analysis(structure(), solver).run(hard)["load"]
    assert len(expected.increments) > 2
    first = Analysis(structure(), solver)
    tried = counted(first)
    first.run(hard, path)
    half = Analysis(structure(), solver)
    counted(half, len(tried) // 2)
    path.unlink(missing_ok=True)
    MPI.COMM_WORLD.Barrier()
    with pytest.raises(Killed):
        half.run(hard, path)
    rest = Analysis(structure(), solver)
    remaining = counted(rest)
    found = rest.run(hard, path)["load"]
    assert [i.load_factor for i in found.increments] == [i.load_factor for i in expected.increments]
    assert found.displacement == pytest.approx(expected.displacement, abs=1e-9 * np.abs(expected.displacement).max())
    assert 0 < len(remaining) < len(tried)


@pytest.mark.mpi
def test_failed_run_can_be_taken_up_by_a_better_solver(path, expected):
    analysis = Analysis(structure())
    calls = counted(analysis)
    with pytest.raises(RuntimeError):
        Analysis(structure(), Newton(max_iterations=1, line_search=False)).run(stages(), path)
    assert_same(analysis.run(stages(), path), expected)
    assert len(calls) == 7


@pytest.mark.mpi
def test_only_the_first_process_writes(tmp_path, monkeypatch, expected):
    written = []
    write = CheckpointFile.write
    monkeypatch.setattr(CheckpointFile, "write", lambda file, *rest: (written.append(file.path), write(file, *rest)))
    mine = tmp_path / f"state {MPI.COMM_WORLD.rank}"  # each process has a name of its own
    found = Analysis(structure()).run(stages(), mine)
    assert len(written) == (7 if MPI.COMM_WORLD.rank == 0 else 0)
    assert mine.exists() == (MPI.COMM_WORLD.rank == 0)
    assert_same(found, expected)


@pytest.mark.mpi
def test_run_of_one_process_goes_on_with_several(path, expected):
    if MPI.COMM_WORLD.rank == 0:
        alone = Analysis(structure(), comm=MPI.COMM_SELF)
        counted(alone, 4)
        with pytest.raises(Killed):
            alone.run(stages(), path)
    MPI.COMM_WORLD.Barrier()
    together = Analysis(structure())
    calls = counted(together)
    assert_same(together.run(stages(), path), expected)
    assert len(calls) == 3


KILLED = """
import os
import sys

sys.path.insert(0, sys.argv[1])
import interrupted as model

analysis = model.Analysis(model.structure())
solve, left = analysis._solve, [int(sys.argv[3])]

def dying(*arguments):
    if not left[0]:
        os._exit(7)
    left[0] -= 1
    return solve(*arguments)

analysis._solve = dying
analysis.run(model.stages(), sys.argv[2])
"""


def test_process_that_is_killed_goes_on(path, expected):
    command = [sys.executable, "-c", KILLED, str(Path(interrupted.__file__).parent), str(path), "4"]
    assert subprocess.run(command, timeout=120, check=False).returncode == 7
    rest = Analysis(structure())
    calls = counted(rest)
    assert_same(rest.run(stages(), path), expected)
    assert len(calls) == 3
