"""Runs and demos by command, in this process: files, screen, exit codes, and faults of the disk."""

import errno
import os
import re
from types import SimpleNamespace

import pytest

from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import leave_out_pictures, said
from fx_membrane import load_results
from fx_membrane.plot import windows

PLAIN = ROOF + "paraview = false\n"


@pytest.fixture
def roof(tmp_path, monkeypatch):
    """Case file in an empty working folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "roof.toml").write_text(PLAIN, encoding="utf-8")
    return tmp_path


def test_demo_is_listed_written_and_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, listed = said("demo")
    assert code == 0
    assert {line.split()[0] for line in listed.split("\n\n")[0].splitlines()} >= {"cone", "square_membrane"}
    assert "own_law" in listed
    titles = [re.search(r"\S+ +(\S)", line).start(1) for line in listed.split("\n\n")[0].splitlines()]
    assert len(set(titles)) == 1, "the titles are one column"
    code, words = said("demo", "square_membrane", "--run")
    assert code == 0
    assert "Stage 'point load': 1 increment, 6 iterations" in words
    assert "Next: fx-membrane show square_membrane" in words
    assert {path.name for path in tmp_path.iterdir()} == {
        "square_membrane.toml", "square_membrane", "fx-membrane.schema.json",
    }  # fmt: skip
    assert round(load_results("square_membrane/results.fxm")["point load"].largest_displacement, 3) == 6.626
    code, words = said("demo", "square_membrane")
    assert code == 2
    assert "exists" in words


def test_demo_comes_with_its_mesh_and_passes_its_check(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, words = said("demo", "tilted_masts")
    assert code == 0
    assert "tilted_masts.obj" in words
    code, words = said("check", "tilted_masts.toml")
    assert code == 0
    assert "2 steps of form finding, 3 stages; no faults" in words


@pytest.mark.parametrize("name", ["rain", "rain_stiff"])
def test_demo_of_rain_is_written_and_is_sound(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert said("demo", name)[0] == 0
    assert {path.name for path in tmp_path.glob("*.toml")} == {f"{name}.toml"}
    code, words = said("check", f"{name}.toml")
    assert code == 0
    assert "no faults" in words


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("own_law", "is a script (a law of one's own is a class in Python)"),
        ("solvers", "it compares solvers, and a case file has one"),
        ("cones", "There is no demo 'cones'"),
    ],
)
def test_demo_that_is_no_case_is_refused(name, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code, output = said("demo", name)
    assert code == 2
    assert words in output
    assert "tilted_masts" in output


def test_quiet_run_says_nothing_and_logs(roof):
    held = PLAIN.replace('components = "z"', 'components = "xyz"')
    (roof / "roof.toml").write_text(held.replace("[solver]", '[form_finding]\nmethod = "projected stress"\n[solver]'))
    text = said("run", "roof.toml", "--quiet", "--log", "run.txt")
    assert text == (0, "")
    assert "Stage 'snow': 2 increments" in (roof / "run.txt").read_text()


@pytest.mark.filterwarnings("default")
def test_warnings_are_lines_of_words(roof):
    (roof / "roof.toml").write_text(PLAIN.replace('prestress = ["1 kN/m", 1500e-3]', 'prestress = "90 kN/m"'))
    code, words = said("run", "roof.toml")
    assert code == 0
    assert "Warning: Part 'roof' is prestressed by" in words
    assert ".py:" not in words


def test_failed_stage_shows_the_stages_before_it(roof):
    text = PLAIN.replace("[solver]", "[work]\niterations = 6\n[solver]").replace("increments = 2", "increments = 10")
    (roof / "roof.toml").write_text(text)
    code, words = said("run", "roof.toml", "--log", "run.txt")
    assert code == 1
    assert "Stage 'lift': 1 increment" in words
    assert words.count("allow more (the table work)") == 1
    assert "the table work" in (roof / "run.txt").read_text()
    assert list(load_results("out/results.fxm")) == ["lift"]


def test_pictures_and_reports_are_written(roof, monkeypatch):
    pytest.importorskip("pyvista")
    pytest.importorskip("jinja2")
    leave_out_pictures(monkeypatch)  # of the report
    monkeypatch.setattr(windows, "LONGER", 200)
    wanted = 'pictures = ["displacement", "principal stress I", "axial force"]\nreport = ["html"]\nmesh = ["obj"]\n'
    (roof / "roof.toml").write_text(PLAIN + wanted)
    assert said("run", "roof.toml", "--quiet")[0] == 0
    names = {path.name for path in (roof / "out").iterdir()}
    quantities = ("displacement", "principal-stress-i", "axial-force")
    pictures = {f"{stage}-{quantity}.png" for stage in ("00-lift", "01-snow") for quantity in quantities}
    assert names >= pictures | {"report.html", "00-lift.obj", "01-snow.obj"}


def test_full_disk_is_told_and_the_run_goes_on_from_its_checkpoint(roof, monkeypatch):
    def full(_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as disk:
        disk.setattr("fx_membrane.files.whole_file.os", SimpleNamespace(fsync=full))
        code, words = said("run", "roof.toml")
    assert code == 2
    assert words.count("No space left on device") >= 2  # archive and tables
    assert "--resume" in words
    assert not (roof / "out" / "results.fxm").exists()
    code, words = said("run", "roof.toml", "--resume")
    assert code == 0
    assert "load factor" not in words  # nothing is computed again
    assert (roof / "out" / "results.fxm").exists()


@pytest.mark.parametrize("command", [["check"], ["run"], ["show"], ["report", "none", "a.html"], ["convert", "a.obj"]])
def test_missing_files_end_with_two(command, roof):
    code, words = said(command[0], *(command[1:] or ["none.toml"]), *(["b.obj"] if command[0] == "convert" else []))
    assert code == 2
    assert len(words) > 10


@pytest.mark.parametrize("command", ["check", "run", "show"])
def test_binary_rubbish_ends_with_two(command, roof):
    (roof / "a.toml").write_bytes(bytes(range(256)) * 9)
    code, words = said(command, "a.toml")
    assert code == 2
    assert "a.toml" in words


def test_places_that_cannot_be_written_are_refused_before_anything_is_computed(roof):
    (roof / "out").write_text("a file in the place of the folder")
    (roof / "log").mkdir()
    for arguments in (["roof.toml"], ["roof.toml", "--log", "out/run.txt"], ["roof.toml", "--log", "log"]):
        code, words = said("run", *arguments)
        assert code == 2
        assert "load factor" not in words
    assert said("init", "out/case.toml")[0] == 2


def test_unwritable_folder_is_refused(roof, monkeypatch):
    closed = SimpleNamespace(**vars(os) | {"access": lambda *_: False})
    monkeypatch.setattr("fx_membrane.checks.paths.os", closed)
    code, words = said("run", "roof.toml")
    assert code == 2
    assert "nothing may be written" in words


def test_form_of_another_case_is_not_taken_over(roof):
    formed = PLAIN.replace("[solver]", '[form_finding]\nmethod = "natural force density"\n[solver]')
    (roof / "roof.toml").write_text(formed)
    assert said("run", "roof.toml", "--quiet")[0] == 0
    found = load_results("out/form.fxm").points
    (roof / "roof.toml").write_text(formed.replace("rtol = 1e-11", "rtol = 1e-10"))
    code, words = said("run", "roof.toml", "--resume")
    assert code == 0
    assert "form finding" not in words
    (roof / "roof.toml").write_text(formed.replace("1500e-3", "3500e-3"))
    code, words = said("run", "roof.toml", "--resume")
    assert code == 2
    assert "--overwrite" in words
    assert said("run", "roof.toml", "--overwrite", "--quiet")[0] == 0
    assert load_results("out/form.fxm").points.shape == found.shape


def test_limits_of_a_case_are_in_the_table_in_its_archive_and_in_the_report(roof, monkeypatch):
    limits = '[limits]\ndisplacement = "1 mm"\nstress = { roof = "50 kN/m" }\nforce = { "edge, left" = 500 }\n[solver]'
    (roof / "roof.toml").write_text(PLAIN.replace("[solver]", limits))
    code, words = said("run", "roof.toml")
    assert code == 1
    assert "FAIL  displacement" in words.split("limits of the design:")[1]
    assert re.search(r"Limits of the design are exceeded: displacement in stage '\w+', \S+ of 0\.001", words)
    assert "PASS  utilisation of 'roof'" in words
    assert "PASS  utilisation of 'edge, left'" in words
    assert "FAIL  displacement" in said("show", "out")[1]
    pytest.importorskip("jinja2")
    leave_out_pictures(monkeypatch)
    assert said("report", "out", "a.html")[0] == 0
    page = (roof / "a.html").read_text()
    assert "Design: limits are exceeded, by displacement in " in page
    assert "are not to be used" not in page
    assert '<p class="verdict FAIL">Computation' not in page
    (roof / "roof.toml").write_text(PLAIN.replace("[solver]", limits.replace("roof =", "rof =")))
    code, words = said("check", "roof.toml")
    assert code == 2
    assert "limits.stress.rof: there is no part 'rof'; 'roof' may be meant" in words


def test_run_that_was_killed_early_is_told_with_its_remedies(roof):
    assert said("run", "roof.toml", "--quiet")[0] == 0
    code, words = said("run", "roof.toml")
    assert code == 2
    assert "has the results of an earlier run" in words
    (roof / "out" / "results.fxm").unlink()  # as after a kill in the first stage
    for command in (["run", "roof.toml"], ["show", "out"], ["report", "out", "a.html"]):
        code, words = said(*command)
        assert code == 2
        assert "has not ended" in words
        assert "--resume" in words
        assert "--overwrite" in words
    assert said("run", "roof.toml", "--resume", "--quiet")[0] == 0
    assert (roof / "out" / "results.fxm").exists()


def test_a_run_is_resumed_or_overwritten_but_not_both(roof):
    assert said("run", "roof.toml", "--quiet")[0] == 0
    code, words = said("run", "roof.toml", "--resume", "--overwrite")
    assert code == 2
    assert "give one of them" in words


def test_structure_without_supports_is_found_by_check(roof):
    lines = PLAIN.splitlines(keepends=True)
    begin = next(row for row, line in enumerate(lines) if line.startswith("[[supports]]"))
    rest = (row for row, line in enumerate(lines) if row > begin and line.startswith("[") and "supports" not in line)
    (roof / "roof.toml").write_text("".join(lines[:begin] + lines[next(rest) :]))
    code, words = said("check", "roof.toml")
    assert code == 2
    assert "not supported enough" in words
