"""Checkpoints: a run that was cut short goes on where it was, and nothing is computed twice."""

import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DeadLoad,
    Fabric,
    Membrane,
    Newton,
    OrthotropicFabric,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary,
    checkpoint,
    rectangle,
)
from fx_membrane.checkpoint import Progress
from fx_membrane.results import Increment
from fx_membrane.solver import Iteration

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
EDGE = np.unique(boundary(TRIANGLES))
RIDGE = np.column_stack([range(10, 14), range(11, 15)])
LIFT = PrescribedDisplacement(12, (0.01, 0, 0.1))


def structure(points=POINTS, prestress=1e3, stiffness=1e6):
    parts = {
        "fabric": Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3), prestress=prestress),
        "ridge": Cable(RIDGE, stiffness, 500.0),
    }
    return Structure(points, parts, [Support(EDGE)])


def stages(snow=-200.0, steps=3):
    return [
        Stage("lift", displacements=[LIFT], steps=2),
        Stage("snow", [DeadLoad((0, 0, snow), "fabric")], steps=steps, after="lift"),
        Stage("wind: 45°", [Pressure(300.0, "fabric"), PointLoad(6, (1.0, 2, 3))], steps=2, after="lift"),
    ]


class Killed(Exception):
    """Stands for the end of the process."""


def counted(analysis, most=10**6):
    """Counts the increments that are solved; ends the run in place of one too many."""
    solve, calls = analysis._solve, []

    def wrapped(x, *monitor):
        if len(calls) == most:
            raise Killed
        calls.append(1)
        return solve(x, *monitor)

    analysis._solve = wrapped
    return calls


@pytest.fixture
def path(tmp_path):
    """A file that all processes mean."""
    return MPI.COMM_WORLD.bcast(tmp_path / "results" / "state.npz")


@pytest.fixture(scope="module")
def expected():
    return Analysis(structure()).run(stages())


def assert_same(found, expected):
    assert list(found) == list(expected)
    for name, result in expected.items():
        mine = found[name]
        for field in ("displacement", "loads", "reactions"):
            values = getattr(result, field)
            assert getattr(mine, field) == pytest.approx(values, abs=1e-9 * np.abs(values).max()), field
        assert mine.energy == pytest.approx(result.energy, rel=1e-12)
        assert mine.membrane("fabric").principal == pytest.approx(result.membrane("fabric").principal, rel=1e-9)
        assert mine.cable("ridge").force == pytest.approx(result.cable("ridge").force, rel=1e-9)
        assert [factor for factor, _ in mine.history] == [factor for factor, _ in result.history]
        # Unbalanced forces at the end are rounding, in which processes differ.
        for (_, mine_entry), (_, entry) in zip(mine.history, result.history, strict=True):
            assert mine_entry == pytest.approx(entry, rel=1e-6, abs=1e-5)


def cut_short(path, most):
    analysis = Analysis(structure())
    calls = counted(analysis, most)
    with pytest.raises(Killed):
        analysis.run(stages(), path)
    assert len(calls) == most


def test_run_with_a_checkpoint_gives_what_one_without_gives(path, expected):
    assert_same(Analysis(structure()).run(stages(), path), expected)
    assert path.exists()


@pytest.mark.parametrize("most", [1, 2, 4, 6])
def test_run_cut_short_goes_on_and_computes_nothing_twice(path, expected, most):
    cut_short(path, most)
    analysis = Analysis(structure())
    calls = counted(analysis)
    assert_same(analysis.run(stages(), path), expected)
    assert len(calls) == 7 - most


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
    with pytest.raises(ValueError, match="another stage 'snow', which differs in: loads;"):
        again.run(stages(snow=-201.0), path)


def test_steps_may_change(path, expected):
    cut_short(path, 3)  # the first of three steps of snow is done
    finer = Analysis(structure())
    snow = finer.run(stages(steps=12)[:2], path)["snow"]
    factors = [increment.load_factor for increment in snow.increments]
    assert factors == pytest.approx([1 / 3 + k / 12 for k in range(9)])
    largest = np.abs(expected["snow"].displacement).max()
    assert snow.displacement == pytest.approx(expected["snow"].displacement, abs=1e-9 * largest)


def test_halved_increments_go_on_with_the_same_length(path):
    hard = [Stage("load", [PointLoad(6, (0, 0, -2e4))])]
    solver = Newton(max_iterations=4)
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


def test_failed_run_can_be_taken_up_by_a_better_solver(path, expected):
    analysis = Analysis(structure())
    calls = counted(analysis)
    with pytest.raises(RuntimeError):
        Analysis(structure(), Newton(max_iterations=1)).run(stages(), path)
    assert_same(analysis.run(stages(), path), expected)
    assert len(calls) == 7


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
        r"which differs in: kind of part 'ridge', cells of part 'ridge', axial_stiffness of part 'ridge' and 2 more;"
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


def test_only_the_first_process_writes(tmp_path, monkeypatch, expected):
    written = []
    save = checkpoint.save
    monkeypatch.setattr(checkpoint, "save", lambda path, *rest: (written.append(path), save(path, *rest)))
    mine = tmp_path / f"state {MPI.COMM_WORLD.rank}"  # each process has a name of its own
    found = Analysis(structure()).run(stages(), mine)
    assert len(written) == (7 if MPI.COMM_WORLD.rank == 0 else 0)
    assert mine.exists() == (MPI.COMM_WORLD.rank == 0)
    assert_same(found, expected)


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
import importlib.util
import os
import sys

spec = importlib.util.spec_from_file_location("model", sys.argv[1])
model = importlib.util.module_from_spec(spec)
spec.loader.exec_module(model)
analysis = model.Analysis(model.structure())
solve, left = analysis._solve, [int(sys.argv[3])]

def dying(x, *monitor):
    if not left[0]:
        os._exit(7)
    left[0] -= 1
    return solve(x, *monitor)

analysis._solve = dying
analysis.run(model.stages(), sys.argv[2])
"""


@pytest.mark.serial
def test_process_that_is_killed_goes_on(path, expected):
    command = [sys.executable, "-c", KILLED, str(Path(__file__)), str(path), "4"]
    assert subprocess.run(command, timeout=120, check=False).returncode == 7
    rest = Analysis(structure())
    calls = counted(rest)
    assert_same(rest.run(stages(), path), expected)
    assert len(calls) == 3
