"""Checkpoints under faults: full disks, two runs at once, kills at any moment, flipped bits."""

import os
import resource
import signal
import subprocess
import sys
import warnings
from contextlib import ExitStack, contextmanager
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import interrupted
from fx_membrane import Analysis, Stage
from fx_membrane.analysis.checkpoint import CheckpointWarning, opened
from fx_membrane.analysis.checkpoint_file import Progress
from fx_membrane.results.load_increments import Increment
from interrupted import Killed, assert_same, counted, stages, structure
from models import POINTS

TESTS = str(Path(interrupted.__file__).parent)


def state(number):
    shape = np.full(POINTS.shape, float(number))
    return Progress(shape, Fraction(1, 2), Fraction(1, 2), (Increment(0.5, ()),) * number)


def loaded(path):
    with opened(path, structure(), [], MPI.COMM_SELF) as kept:
        return kept.progress


@contextmanager
def full_disk(size):
    """Limit the size of files, so that writing beyond it fails as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:  # before pytest writes the report of the test, perhaps to a file
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_run_on_a_full_disk_goes_on_and_says_so_once(path):
    expected = Analysis(structure()).run(stages())
    analysis = Analysis(structure())
    solve, done = analysis._solve, []
    with ExitStack() as filled:

        def filling(*arguments):
            done.append(1)
            if len(done) == 3:
                filled.enter_context(full_disk(path.stat().st_size))
            return solve(*arguments)

        analysis._solve = filling
        with pytest.warns(CheckpointWarning, match=r"'snow'.*state.*saved.*state\.npz \(") as told:
            assert_same(analysis.run(stages(), path), expected)
    assert len([entry for entry in told if entry.category is CheckpointWarning]) == 1
    assert told[0].filename == __file__
    assert [file.name for file in path.parent.iterdir()] == ["state.npz"]
    rest = Analysis(structure())
    calls = counted(rest)
    assert_same(rest.run(stages(), path), expected)
    assert len(calls) == 4  # the third state has room in the pages that the file has


def test_states_that_found_no_room_are_saved_when_there_is_some(path):
    names = [Stage(name) for name in "abc"]
    with opened(path, structure(), names, MPI.COMM_SELF) as kept:
        with full_disk(path.stat().st_size):
            with pytest.warns(CheckpointWarning):
                kept.save("a", state(3000))
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                kept.save("b", state(2))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            kept.save("c", state(3))
    assert {name: len(found.increments) for name, found in loaded(path).items()} == {"a": 3000, "b": 2, "c": 3}


@pytest.mark.parametrize("place", ["file/state.npz", "folder", "/proc/fx/state.npz", "n" * 300, "a\0b"])
def test_place_that_cannot_be_written_is_refused_before_the_run(tmp_path, place):
    (tmp_path / "file").write_text("a file")
    (tmp_path / "folder").mkdir()
    analysis = Analysis(structure())
    calls = counted(analysis)
    with pytest.raises(ValueError, match=r"^(checkpoint_file (is|has)|The checkpoint) .*give "):
        analysis.run(stages(), tmp_path / place)
    assert not calls


def test_full_disk_is_refused_before_the_run(path):
    analysis = Analysis(structure())
    with full_disk(100), pytest.raises(ValueError, match=r"The checkpoint .* cannot be written \(File too large\)"):
        analysis.run(stages(), path)
    assert list(path.parent.iterdir()) == []


def test_second_run_on_a_file_is_refused(path):
    analysis = Analysis(structure())
    solve = analysis._solve

    def second(*arguments):
        other = Analysis(structure())
        with pytest.raises(ValueError, match=r"The checkpoint .*state\.npz.*use.*run.*one"):
            other.run(stages(), path)
        return solve(*arguments)

    analysis._solve = second
    analysis.run(stages()[:1], path)
    assert list(Analysis(structure()).run(stages(), path)) == ["lift", "snow", "wind: 45°"]


HOLDING = """
import sys
sys.path.insert(0, sys.argv[1])
import interrupted as model

analysis = model.Analysis(model.structure())
solve = analysis._solve

def waiting(*arguments):
    print("begun", flush=True)
    sys.stdin.read()
    return solve(*arguments)

analysis._solve = waiting
analysis.run(model.stages(), sys.argv[2])
"""


def test_file_of_a_process_that_was_killed_is_free(path):
    command = [sys.executable, "-c", HOLDING, TESTS, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout.readline() == "begun\n"
        with pytest.raises(ValueError, match="in use"):
            Analysis(structure()).run(stages(), path)
        other.kill()
        other.wait()
        assert list(Analysis(structure()).run(stages()[:1], path)) == ["lift"]


def write_on(path, told):
    """Save one state after the other, and tell each, until this process is killed."""
    with opened(path, structure(), [Stage("a")], MPI.COMM_SELF) as kept:
        number = len(kept.progress["a"].increments) if kept.progress else 0
        while True:
            number += 1
            kept.save("a", state(number))
            os.write(told, b"%d\n" % number)


def test_kill_at_any_moment_leaves_the_last_state_or_the_next(path):
    told = 0
    for lines in (0, 1, 14, 36):
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                write_on(path, writer)
            finally:
                os._exit(1)
        os.close(writer)
        with open(reader, encoding="ascii") as numbers:
            for _ in range(lines):
                told = int(numbers.readline())
            os.kill(child, signal.SIGKILL)
            told = max([told, *map(int, numbers.read().split())])
        assert os.waitpid(child, 0)[1] == signal.SIGKILL
        found = loaded(path)
        number = len(found["a"].increments) if found else 0
        assert number in (told, told + 1)
        assert not found or (found["a"].displacement == number).all()
        told = number
    assert told > 50


def test_bit_that_turned_over_is_refused_or_without_effect(path):
    with opened(path, structure(), stages(), MPI.COMM_SELF) as kept:
        kept.save("lift", state(2))
        kept.save("snow", state(3))
    whole = path.read_bytes()
    random = np.random.default_rng(1)
    refused = 0
    for position in random.integers(8 * len(whole), size=100):
        content = bytearray(whole)
        content[position // 8] ^= 1 << position % 8
        path.write_bytes(content)
        try:
            found = loaded(path)
        except ValueError:
            refused += 1
            continue
        assert {name: len(entry.increments) for name, entry in found.items()} == {"lift": 2, "snow": 3}
        assert all((entry.displacement == len(entry.increments)).all() for entry in found.values())
    assert refused > 20


def test_archive_of_an_earlier_version_is_refused(path):
    path.parent.mkdir()
    np.savez(path, document=np.array("{}"))
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint.*version.*read"):
        Analysis(structure()).run(stages(), path)


def test_run_that_ends_in_an_exception_frees_the_file(path):
    analysis = Analysis(structure())
    counted(analysis, 2)
    with pytest.raises(Killed) as error:
        analysis.run(stages(), path)
    assert error.traceback
    assert list(Analysis(structure()).run(stages()[:1], path)) == ["lift"]
