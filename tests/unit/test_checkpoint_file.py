"""Checkpoint files: which are refused, and what is in them."""

from fractions import Fraction

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Membrane,
    OrthotropicFabric,
    Structure,
    Support,
    checkpoint,
)
from fx_membrane.checkpoint import Progress
from fx_membrane.results import Increment
from fx_membrane.solver import Iteration
from interrupted import Killed, counted, cut_short, stages, structure
from models import EDGE, POINTS, TRIANGLES

# Refusals

WOVEN = {"nu": 0.0, "Gt": 5}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (structure(), structure(points=POINTS * [1, 1.01, 1])),
        (structure(), structure(prestress=1001.0)),
        (structure(), structure(stiffness=1.1e6)),
        (
            Structure(POINTS, {"fabric": Membrane(TRIANGLES, OrthotropicFabric(1, 12, **WOVEN), warp=(1, 0, 0))}),
            Structure(POINTS, {"fabric": Membrane(TRIANGLES, OrthotropicFabric(11, 2, **WOVEN), warp=(1, 0, 0))}),
        ),
    ],
    ids=["points", "prestress", "stiffness", "digits of two moduli that follow each other"],
)
def test_another_structure_has_another_fingerprint(before, after):
    assert checkpoint.fingerprint(before) != checkpoint.fingerprint(after)


def test_fingerprints_name_what_differs():
    mine = checkpoint.fingerprints(structure())
    other = structure(points=POINTS * 2, prestress=5.0)
    changed = [name for name, digest in checkpoint.fingerprints(other).items() if digest != mine[name]]
    assert changed == ["points", "prestress of part 'fabric'"]


def test_fingerprint_does_not_change_between_equal_structures():
    assert checkpoint.fingerprint(structure()) == checkpoint.fingerprint(structure())
    assert checkpoint.fingerprint(stages()) == checkpoint.fingerprint(stages())


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
        r"which differs in: kind of part 'ridge', cells of part 'ridge', axial_stiffness of part 'ridge' and 3 more;"
    )
    with pytest.raises(ValueError, match=message):
        other.run(stages(), path)


def test_checkpoint_of_another_stage_is_refused(path):
    cut_short(path, 3)
    other = Analysis(structure())
    calls = counted(other)
    with pytest.raises(ValueError, match=r"state\.npz has another stage 'snow', which differs in: loads; give another"):
        other.run(stages(snow=-201.0), path)
    assert not calls


def write(path, content):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    MPI.COMM_WORLD.Barrier()


@pytest.mark.parametrize(
    "content",
    [b"", b"Notes about the roof\n", b"PK\x03\x04 no archive", bytes(1000), b"\x93NUMPY"],
    ids=["empty", "text", "zip in name only", "zeros", "numpy in name only"],
)
def test_file_that_is_no_checkpoint_is_refused_and_kept(path, content):
    write(path, content)
    with pytest.raises(ValueError, match=r"state\.npz is not a checkpoint"):
        Analysis(structure()).run(stages(), path)
    MPI.COMM_WORLD.Barrier()
    assert path.read_bytes() == content


def test_archive_of_other_arrays_is_refused(path):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True)
        np.savez(path, points=POINTS)
    MPI.COMM_WORLD.Barrier()
    with pytest.raises(ValueError, match=r"state\.npz is not a checkpoint"):
        Analysis(structure()).run(stages(), path)


def test_single_array_is_refused(path):
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True)
        with path.open("wb") as file:
            np.save(file, POINTS)
    MPI.COMM_WORLD.Barrier()
    with pytest.raises(ValueError, match=r"state\.npz is not a checkpoint"):
        Analysis(structure()).run(stages(), path)


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.999])
def test_truncated_file_is_refused(path, share):
    cut_short(path, 3)
    MPI.COMM_WORLD.Barrier()
    whole = path.read_bytes()
    MPI.COMM_WORLD.Barrier()
    write(path, whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=r"state\.npz is not a checkpoint"):
        Analysis(structure()).run(stages(), path)


# Files


def progress(factor=Fraction(1, 3)):
    iterations = (Iteration(0.0, 1e300, 0.0), Iteration(-1.25, 1 / 3, 1.0))
    shape = np.random.default_rng(1).normal(size=POINTS.shape)
    return {"lift": Progress(shape, factor, Fraction(1, 7), (Increment(1 / 3, iterations),))}


def test_what_is_saved_is_loaded_to_the_last_digit(tmp_path):
    path = tmp_path / "state"
    saved = progress()
    checkpoint.save(path, structure(), stages(), saved)
    loaded = checkpoint.load(path, structure(), stages())
    assert list(loaded) == ["lift"]
    assert np.array_equal(loaded["lift"].displacement, saved["lift"].displacement)
    assert (loaded["lift"].factor, loaded["lift"].size) == (Fraction(1, 3), Fraction(1, 7))
    assert loaded["lift"].increments == saved["lift"].increments
    assert isinstance(loaded["lift"].increments[0].iterations[0], Iteration)


def test_no_file_is_no_progress(tmp_path):
    assert checkpoint.load(tmp_path / "none", structure(), stages()) == {}


def test_process_that_ends_while_it_writes_leaves_the_state_before(tmp_path, monkeypatch):
    path = tmp_path / "state"
    checkpoint.save(path, structure(), stages(), progress())
    before = path.read_bytes()

    def half(file, **_):
        file.write(before[: len(before) // 2])
        raise Killed

    monkeypatch.setattr(np, "savez", half)
    with pytest.raises(Killed):
        checkpoint.save(path, structure(), stages(), progress(Fraction(2, 3)))
    assert path.read_bytes() == before
    assert checkpoint.load(path, structure(), stages())["lift"].factor == Fraction(1, 3)


def test_nothing_but_the_checkpoint_is_left_behind(path):
    Analysis(structure()).run(stages(), path)
    assert [file.name for file in path.parent.iterdir()] == ["state.npz"]
