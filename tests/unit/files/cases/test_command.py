"""The command: what it writes, prints and returns, in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import time
import warnings
from pathlib import Path

import numpy as np
import pytest

import launch
from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import said
from fx_membrane import Analysis, load_results
from fx_membrane.files.cases.case import read_case

COMMAND = ["-c", "from fx_membrane.cli import main; main()"]
WITHOUT_SERIES = ROOF + "paraview = false\n"  # which takes each process that writes it seconds to load pyvista
IN_TURN = """\
import sys
from fx_membrane.cli import main
for words in sys.argv[1:]:
    try:
        main(words.split())
    except SystemExit as end:
        print(f"ended with {end.code}")
"""


def run(folder, *arguments, processes=1, script=COMMAND[1], module=False):
    """Run the command, as a script or a module, in its own processes in a folder: exit code, stdout, stderr."""
    several = [launch.launcher(), "-n", str(processes)] if processes > 1 else []
    environment = dict(os.environ) | launch.ENVIRONMENT | {"PYTHONPATH": str(Path(__file__).parents[4])}
    command = [*several, sys.executable, *(["-m", "fx_membrane.cli"] if module else ["-c", script]), *arguments]
    ended = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    return ended.returncode, ended.stdout, ended.stderr


@pytest.fixture(scope="module")
def by_two(tmp_path_factory):
    """Folder in which two processes ran some commands, one after the other, their exit code, stdout and stderr."""
    folder = tmp_path_factory.mktemp("two")
    (folder / "roof.toml").write_text(WITHOUT_SERIES, encoding="utf-8")
    commands = "init a.toml", "init a.toml", "demo tilted_masts", "run roof.toml"
    return folder, *run(folder, *commands, processes=2, script=IN_TURN)


def test_first_case_from_nothing_to_results(tmp_path):
    code, words = said("init", tmp_path / "case.toml")
    assert code == 0
    assert "case.toml" in words
    assert json.loads((tmp_path / "fx-membrane.schema.json").read_text())["type"] == "object"
    assert said("check", tmp_path / "case.toml")[0] == 0
    command = ["run", "case.toml", "--quiet", "--log", "table.txt"]
    assert run(tmp_path, *command, module=True)[:2] == (0, "")
    assert "PASS" in (tmp_path / "table.txt").read_text()
    names = {path.name for path in (tmp_path / "case").iterdir()}
    assert names >= {"checkpoint.sqlite", "results.fxm", "summary.json", "nodes.csv", "membranes.csv"}
    assert said("init", tmp_path / "case.toml")[0] == 2


def test_results_are_kept_unless_told_otherwise(by_two):
    folder, code, words, _ = by_two
    case = read_case(folder / "roof.toml")
    expected = Analysis(case.structure, case.solver).run(case.stages)["snow"].displacement
    assert code == 0
    assert words.count("Stage 'snow'") == 1
    found = load_results(folder / "out" / "results.fxm")["snow"].displacement
    assert np.allclose(found, expected, rtol=0, atol=1e-12)
    code, complaint = said("run", folder / "roof.toml")
    assert code == 2
    assert "--resume" in complaint
    assert said("run", folder / "roof.toml", "--resume", "--quiet") == (0, "")
    assert said("run", folder / "roof.toml", "--overwrite", "--quiet") == (0, "")


def test_failed_stage_leaves_the_results_before_it(tmp_path):
    (tmp_path / "roof.toml").write_text(
        WITHOUT_SERIES.replace("rtol = 1e-11", "rtol = 1e-11\nmax_iterations = 2"), encoding="utf-8"
    )
    code, complaint = said("run", tmp_path / "roof.toml")
    assert code == 1
    assert "max_iterations" in complaint


def test_faults_are_told_and_end_with_two(tmp_path):
    (tmp_path / "roof.toml").write_text(ROOF.replace("nu = 0.3", "nue = 0.3"), encoding="utf-8")
    for command in ("check", "run"):
        code, complaint = said(command, tmp_path / "roof.toml")
        assert code == 2
        assert "roof.toml:15: materials.pvc.nue: " in complaint
    assert said("fly")[0] == 2


def test_sigterm_and_ctrl_c_end_with_words_and_the_run_goes_on(tmp_path):
    long = WITHOUT_SERIES.replace("increments = 2", "increments = 20000")
    (tmp_path / "roof.toml").write_text(long, encoding="utf-8")
    environment = dict(os.environ) | launch.ENVIRONMENT | {"PYTHONPATH": str(Path(__file__).parents[4])}
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); "  # a background shell ignores it
    command = [sys.executable, "-c", heed + COMMAND[1], "run", "roof.toml", "--resume"]
    for by, code, words in ((signal.SIGTERM, 143, "Ended by SIGTERM."), (signal.SIGINT, 130, "Stopped.")):
        before = _kept(tmp_path / "out")
        with subprocess.Popen(command, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True) as process:
            try:
                while _kept(tmp_path / "out") == before:
                    assert process.poll() is None
                    time.sleep(0.2)
                process.send_signal(by)
                complaint = process.communicate(timeout=120)[1]
            finally:
                process.kill()
        assert (process.returncode, words in complaint, "--resume" in complaint) == (code, True, True)
    (tmp_path / "roof.toml").write_text(WITHOUT_SERIES, encoding="utf-8")
    assert said("run", tmp_path / "roof.toml", "--resume", "--quiet") == (0, "")


def _kept(folder):
    """Time at which an increment of the long stage was kept; zero before the first."""
    state = folder / "unfinished" / "0001.fxm"
    return state.stat().st_mtime_ns if state.exists() else 0


def test_conversion(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng sail\nf 1 2 3 4\ng edge\nl 1 2\n")
    assert said("convert", tmp_path / "a.obj", tmp_path / "a.msh")[0] == 0
    assert run(tmp_path, "convert", "a.msh", "b.obj")[0] == 0
    assert (tmp_path / "b.obj").read_text().count("\nf ") == 2
    code, complaint = said("convert", tmp_path / "a.obj", tmp_path / "a.step")
    assert code == 2
    assert ".dxf" in complaint


def test_warnings_are_lines_of_the_command(tmp_path):
    stiff = WITHOUT_SERIES.replace('prestress = ["1 kN/m", 1500e-3]', 'prestress = "90 kN/m"')
    (tmp_path / "roof.toml").write_text(stiff, encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        code, words = said("check", tmp_path / "roof.toml")
    assert code == 0
    *told, last = words.splitlines()
    assert told
    assert all(line.startswith("Warning: ") for line in told)
    assert last.endswith("; no faults")


def test_schema():
    code, words = said("schema")
    assert code == 0
    assert "parts" in json.loads(words)["properties"]


def complaint_with(output, folder, *arguments):
    """Exit code and stderr of a command whose stdout is a given file."""
    environment = dict(os.environ) | launch.ENVIRONMENT | {"PYTHONPATH": str(Path(__file__).parents[4])}
    command = [sys.executable, *COMMAND, *arguments]
    ended = subprocess.run(
        command, cwd=folder, env=environment, stdout=output, stderr=subprocess.PIPE, text=True, check=False
    )
    return ended.returncode, ended.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device")
@pytest.mark.parametrize("arguments", [["schema"], ["--help"]])
def test_full_disk_at_the_output_is_one_sentence(arguments, tmp_path):
    with Path("/dev/full").open("w") as full:
        code, words = complaint_with(full, tmp_path, *arguments)
    assert code == 2
    assert words == "The output cannot be written (No space left on device); make room, or send it elsewhere.\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device")
def test_full_disk_at_the_log_is_one_sentence(tmp_path):
    (tmp_path / "roof.toml").write_text(WITHOUT_SERIES, encoding="utf-8")
    code, complaint = said("run", tmp_path / "roof.toml", "--quiet", "--log", "/dev/full")
    assert code == 2
    assert complaint.splitlines()[-1].startswith("'/dev/full' cannot be written (No space left on device)")


def test_closed_pipe_is_silent(tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    words = complaint_with(writer, tmp_path, "schema")[1]
    os.close(writer)
    assert words == ""


def test_files_to_begin_with_are_written_once_by_several_processes(by_two):
    _, code, words, complaint = by_two
    assert [words.count(f"ended with {end}") for end in (code, 2)] == [6, 2]
    assert [words.count(f"Wrote {files}") for files in ("a.toml", "tilted_masts.toml, tilted_masts.obj")] == [1, 1]
    assert complaint.count("a.toml exists") == 1
