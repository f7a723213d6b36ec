"""Runs that are stopped: what they have found can be shown, and goes on."""

import os
import signal

import numpy as np
import pytest

from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import leave_out_pictures, said
from fx_membrane import load_results
from fx_membrane.files.cases import run
from fx_membrane.files.unfinished_run import KeptStates

CASE = ROOF.replace("increments = 2", "increments = 4") + "paraview = false\n[limits]\ndisplacement = 1\n"


def stopped(monkeypatch, stage, by):
    """Let the signal come after the second increment of a stage."""

    class Stopped(KeptStates):
        def __call__(self, state):
            super().__call__(state)
            if state.name == stage and len(state.increments) == 2:
                os.kill(os.getpid(), by)

    monkeypatch.setattr(run, "KeptStates", Stopped)


@pytest.mark.parametrize(
    ("by", "code", "words"), [(signal.SIGTERM, 143, "Ended by SIGTERM."), (signal.SIGINT, 130, "")]
)
def test_stopped_run_can_be_shown_and_goes_on(by, code, words, tmp_path, monkeypatch):
    (tmp_path / "roof.toml").write_text(CASE, encoding="utf-8")
    before = signal.getsignal(signal.SIGTERM)
    with monkeypatch.context() as context:
        stopped(context, "snow", by)
        found, told = said("run", tmp_path / "roof.toml")
    assert (found, signal.getsignal(signal.SIGTERM)) == (code, before)
    assert words in told
    assert "--resume" in told
    assert "Traceback" not in told
    code, told = said("show", tmp_path / "out")
    assert code == 0
    assert "has not ended" in told
    assert "Stage 'lift'" in told
    assert "Stage 'snow, up to load factor 0.5'" in told
    assert "FAIL  snow: stopped at load factor 0.5" in told
    assert "displacement" in told  # the limit of the case
    pytest.importorskip("jinja2")
    leave_out_pictures(monkeypatch)
    assert said("report", tmp_path / "out", tmp_path / "a.html")[0] == 0
    assert "The run is incomplete: snow: stopped at load factor 0.5" in (tmp_path / "a.html").read_text(
        encoding="utf-8"
    )
    assert said("run", tmp_path / "roof.toml", "--resume", "--quiet") == (0, "")
    assert not (tmp_path / "out" / "unfinished").exists()
    (tmp_path / "whole.toml").write_text(CASE.replace('"out"', '"whole"'), encoding="utf-8")
    assert said("run", tmp_path / "whole.toml", "--quiet") == (0, "")
    for name, state in load_results(tmp_path / "whole" / "results.fxm").items():
        again = load_results(tmp_path / "out" / "results.fxm")[name]
        assert np.allclose(again.displacement, state.displacement, rtol=0, atol=1e-12)
        assert [str(remark) for remark in again.remarks] == [str(remark) for remark in state.remarks]


def test_killed_run_has_its_first_increment(tmp_path, monkeypatch):
    """kill -9: nothing of the run's own comes after it."""
    (tmp_path / "roof.toml").write_text(CASE, encoding="utf-8")
    with monkeypatch.context() as context:
        stopped(context, "snow", signal.SIGINT)
        context.setattr(KeptStates, "keep_last", _first_only(KeptStates.keep_last))
        assert said("run", tmp_path / "roof.toml")[0] == 130
    assert "FAIL  snow: stopped at load factor 0.25" in said("show", tmp_path / "out")[1]


def _first_only(keep):
    def kept(states):
        if len(states._left.increments) < 2:
            keep(states)

    return kept


def test_run_stopped_before_its_first_state_is_told(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "checkpoint.sqlite").touch()
    code, told = said("show", tmp_path / "out")
    assert (code, "--resume" in told) == (2, True)


def test_new_run_forgets_what_an_earlier_one_has_left(tmp_path):
    (tmp_path / "roof.toml").write_text(CASE, encoding="utf-8")
    folder = tmp_path / "out"
    (folder / "unfinished").mkdir(parents=True)
    (folder / "unfinished" / "0007.fxm").write_text("of another run")
    (folder / "masts.csv").write_text("of another run")
    (folder / "notes.txt").write_text("of the user")
    code, told = said("run", tmp_path / "roof.toml", "--overwrite")
    assert code == 0
    assert {path.name for path in folder.iterdir()} == {
        *("cables.csv", "checkpoint.sqlite", "membranes.csv", "nodes.csv", "notes.txt", "results.fxm", "summary.json")
    }
    assert "nodes.csv" in told
    assert "notes.txt" not in told


def test_series_of_a_new_run_has_no_steps_of_an_earlier_one(tmp_path):
    pyvista = pytest.importorskip("pyvista")
    (tmp_path / "roof.toml").write_text(CASE.replace("paraview = false", "paraview = true"), encoding="utf-8")
    folder = tmp_path / "out" / "paraview"
    (folder / "0041").mkdir(parents=True)
    for name in ("0041.vtm", "0041/0041_0.vtu", "series.pvd", "own.vtm"):
        (folder / name).write_text("of another run")
    assert said("run", tmp_path / "roof.toml", "--overwrite", "--quiet")[0] == 0
    steps = {f"{number:04d}" for number in range(1, 6)}
    assert {path.name for path in folder.iterdir()} == {"own.vtm", "series.pvd", *steps, *(f"{s}.vtm" for s in steps)}
    assert len(pyvista.PVDReader(str(folder / "series.pvd")).time_values) == 5
