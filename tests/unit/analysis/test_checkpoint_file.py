"""Checkpoint files: their content, and the refused ones."""

import re
import sqlite3
from contextlib import closing
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Analysis, Outcome, Stage, Structure, Support
from fx_membrane.analysis import checkpoint_file
from fx_membrane.analysis.checkpoint import opened
from fx_membrane.analysis.checkpoint_file import Progress
from fx_membrane.results.load_increments import Increment
from fx_membrane.solvers.base import Iteration
from interrupted import Killed, counted, cut_short, stages, structure
from models import EDGE, POINTS

# Refusals


@pytest.mark.mpi
def test_checkpoint_of_another_structure_is_refused(path):
    cut_short(path, 3)
    other = Analysis(structure(prestress=1100.0))
    calls = counted(other)
    message = r"state\.npz is of another structure, which differs in: prestress of part 'fabric'; give another name"
    with pytest.raises(ValueError, match=message):
        other.run(stages(), path)
    assert not calls


def test_checkpoint_of_other_parts_is_refused(path):
    cut_short(path, 1)
    fabric = structure().parts["fabric"]
    other = Analysis(Structure(POINTS, {"fabric": fabric}, [Support(EDGE)]))
    message = (
        r"which differs in: kind of part 'ridge', cells of part 'ridge', axial_stiffness of part 'ridge' and 5 more;"
    )
    with pytest.raises(ValueError, match=message):
        other.run(stages(), path)


def test_checkpoint_of_another_stage_is_refused(path):
    cut_short(path, 3)
    other = Analysis(structure())
    calls = counted(other)
    with pytest.raises(ValueError, match=r"state\.npz.*stage 'snow'.*differs.*loads"):
        other.run(stages(snow=-201.0), path)
    assert not calls


def write(path, content):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    MPI.COMM_WORLD.Barrier()


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    "content",
    [b"", b"Notes about the roof\n", b"PK\x03\x04 no archive", bytes(1000), b"\x93NUMPY"],
    ids=["empty", "text", "zip in name only", "zeros", "numpy in name only"],
)
def test_file_that_is_no_checkpoint_is_refused_and_kept(path, content):
    write(path, content)
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint"):
        Analysis(structure()).run(stages(), path)
    MPI.COMM_WORLD.Barrier()
    assert path.read_bytes() == content


def test_archive_of_other_arrays_is_refused(path):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True)
        np.savez(path, points=POINTS)
    MPI.COMM_WORLD.Barrier()
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint"):
        Analysis(structure()).run(stages(), path)


def test_single_array_is_refused(path):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True)
        with path.open("wb") as file:
            np.save(file, POINTS)
    MPI.COMM_WORLD.Barrier()
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint"):
        Analysis(structure()).run(stages(), path)


@pytest.mark.mpi_once
@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_file_is_refused(path, share):
    cut_short(path, 3)
    MPI.COMM_WORLD.Barrier()
    whole = path.read_bytes()
    MPI.COMM_WORLD.Barrier()
    write(path, whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint"):
        Analysis(structure()).run(stages(), path)


# Files


def progress(factor=Fraction(1, 3), count=1):
    iterations = (Iteration(0.0, 1e300, 0.0), Iteration(-1.25, 1 / 3, 1.0))
    shape = np.random.default_rng(1).normal(size=POINTS.shape)
    increments = tuple(Increment(1 / 3 + i, iterations, Outcome.SNAPPED, 3) for i in range(count))
    return Progress(shape, factor, Fraction(1, 7), increments)


def saved(path, **states):
    with opened(path, structure(), stages(), MPI.COMM_SELF) as kept:
        for name, state in states.items():
            kept.save(name, state)


def loaded(path):
    with opened(path, structure(), stages(), MPI.COMM_SELF) as kept:
        return kept.progress


@pytest.mark.mpi
def test_what_is_saved_is_loaded_to_the_last_digit(tmp_path):
    path, state = tmp_path / "state", progress()
    saved(path, lift=state)
    found = loaded(path)
    assert list(found) == ["lift"]
    assert np.array_equal(found["lift"].displacement, state.displacement)
    assert (found["lift"].factor, found["lift"].size) == (Fraction(1, 3), Fraction(1, 7))
    assert found["lift"].increments == state.increments
    assert isinstance(found["lift"].increments[0].iterations[0], Iteration)


@pytest.mark.mpi
def test_no_file_is_no_progress(tmp_path):
    assert loaded(tmp_path / "none") == {}


@pytest.mark.mpi
def test_states_that_are_saved_again_replace_what_was(tmp_path):
    path = tmp_path / "state"
    saved(path, lift=progress())
    saved(path, lift=progress(Fraction(2, 3), 3), snow=progress(Fraction(1), 5))
    found = loaded(path)
    assert found["lift"].increments == progress(count=3).increments
    assert (found["lift"].factor, found["snow"].factor) == (Fraction(2, 3), 1)
    assert len(found["snow"].increments) == 5


@pytest.mark.mpi
def test_nothing_but_the_checkpoint_is_left_behind(path):
    Analysis(structure()).run(stages(), path)
    MPI.COMM_WORLD.Barrier()
    assert [file.name for file in path.parent.iterdir()] == ["state.npz"]


def test_structure_may_change_while_nothing_is_saved(path):
    analysis = Analysis(structure())
    counted(analysis, 0)
    with pytest.raises(Killed):
        analysis.run(stages(), path)
    assert Analysis(structure(stiffness=2e6)).run(stages()[:1], path)["lift"].equilibrium.residual < 1e-6


@pytest.mark.parametrize("name", ["wind / 45°", "\udcff", "n" * 70_000, "header"], ids=range(4))
def test_stage_of_any_name_is_saved(tmp_path, name):
    path = tmp_path / "state"
    for _ in range(2):
        with opened(path, structure(), [Stage(name)], MPI.COMM_SELF) as kept:
            kept.save(name, progress())
    assert list(loaded(path)) == [name]


def test_increment_costs_its_own_state_however_many_came_before(tmp_path):
    def written():
        return int(re.search(r"wchar: (\d+)", Path("/proc/self/io").read_text())[1])

    shape = np.zeros((2000, 3))
    many = [Stage(f"stage {number}") for number in range(100)]
    costs = []
    with opened(tmp_path / "state", structure(), many, MPI.COMM_SELF) as kept:
        for stage in many:
            for count in (1, 2):
                before = written()
                kept.save(stage.name, replace(progress(count=count), displacement=shape))
                costs.append(written() - before)
    assert max(costs) < 4 * shape.nbytes  # the previous state is kept until the new one is complete
    assert (tmp_path / "state").stat().st_size < 1.5 * len(many) * shape.nbytes


@pytest.mark.mpi_once
@pytest.mark.parametrize("outcome", list(Outcome))
def test_outcome_is_saved_by_its_name(tmp_path, outcome):
    path = tmp_path / "state"
    increment = Increment(1.0, (), outcome, 3, "words")
    saved(path, lift=Progress(POINTS, Fraction(1), Fraction(1), (increment,)))
    assert loaded(path)["lift"].increments == (increment,)
    with closing(sqlite3.connect(path)) as database:
        (document,) = database.execute("SELECT document FROM entry WHERE key LIKE 'increment%'").fetchone()
    assert f'"outcome": "{outcome.name}"'.encode() in document


# Changed files


def test_file_of_an_earlier_format_is_refused_in_words(tmp_path, monkeypatch):
    path = tmp_path / "state"
    with monkeypatch.context() as earlier:
        earlier.setattr(checkpoint_file, "FORMAT", 1)
        saved(path, lift=progress())
    words = r"is not a checkpoint \(of another version: its format is 1, and this one reads 2\); give another name"
    with pytest.raises(ValueError, match=words):
        loaded(path)


def edit(path, change):
    with closing(sqlite3.connect(path)) as database, database:
        database.execute(change)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    "change",
    [
        "UPDATE entry SET displacement = zeroblob(length(displacement)) WHERE key LIKE 'stage%'",
        "UPDATE entry SET displacement = x'' WHERE key LIKE 'stage%'",
        "UPDATE entry SET displacement = NULL WHERE key LIKE 'stage%'",
        "UPDATE entry SET document = replace(document, '1/3', '2/3') WHERE key LIKE 'stage%'",
        "UPDATE entry SET document = replace(document, 'true', 'false') WHERE key LIKE 'increment%'",
        "UPDATE entry SET document = '{}'",
        "UPDATE entry SET digest = 5",
        "DELETE FROM entry WHERE key LIKE 'increment%'",
        "DELETE FROM entry WHERE key LIKE '%stage%'",
        "DELETE FROM entry",
        "DROP TABLE entry",
        "ALTER TABLE entry DROP COLUMN digest",
    ],
)
def test_changed_content_is_refused(tmp_path, change):
    path = tmp_path / "state.npz"
    saved(path, lift=progress())
    edit(path, change)
    with pytest.raises(ValueError, match=r"state\.npz.*not a checkpoint \(.+\).*name.*remove"):
        loaded(path)
