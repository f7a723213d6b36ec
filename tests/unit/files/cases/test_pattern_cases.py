"""Cutting patterns of case files: the command, its files, and the chapter of the report."""

import csv
import json
import shutil
from importlib.util import find_spec

import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")
pytest.importorskip("shapely.creation")  # of shapely 2
pytest.importorskip("ezdxf")

from by_command import leave_out_pictures, said
from fx_membrane.plot.proof_pictures import PICTURES
from fx_membrane.plot.screen import obstacle
from pattern_case import PATTERNS, case


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Folder of a case whose pattern is made, and what the command said."""
    folder = tmp_path_factory.mktemp("roof")
    return folder, said("patterns", case(folder))


@pytest.fixture
def undrawn(monkeypatch):
    """Commands without pictures and sheets."""
    leave_out_pictures(monkeypatch)


@pytest.fixture
def again(made, tmp_path, undrawn):
    """Copy of the folder whose pattern is made, to work on."""
    return shutil.copytree(made[0], tmp_path / "again")


def test_command_writes_all_files_and_tells_the_proof(made):
    folder, (code, words) = made
    assert code == 0
    assert "Proof of the cutting pattern: 2 strips" in words
    assert "stress [kN/m]" in words
    files = {path.name for path in (folder / "roof" / "patterns").iterdir()}
    assert files >= {
        "patterns.dxf",
        "patterns.pdf",
        "strips.csv",
        "strips_sides.csv",
        "sheets",
        "proof.json",
        "proof.txt",
        "pattern.fxm",
        "proof.fxm",
    }
    proof = json.loads((folder / "roof" / "patterns" / "proof.json").read_text())
    assert proof["units"] == {"force": "kN", "length": "m"}
    assert proof["roll width"] == pytest.approx(2.2 - 2 * 0.02)
    assert proof["stress error"] < 1e-6  # a flat sheet fits
    assert [strip["utilisation"] for strip in proof["strips"]] == pytest.approx([0.1, 0.1])
    with (folder / "roof" / "patterns" / "strips.csv").open(encoding="utf-8-sig", newline="") as stream:
        rows = list(csv.DictReader(stream))
    stretch = 1 + 2 * 0.7 / 500
    assert float(rows[0]["sewn area [m2]"]) == pytest.approx(12 / stretch**2, rel=1e-3)
    assert float(rows[-1]["width [m]"]) == 2.2


def test_proof_marks_strips_wider_than_the_roll_without_welds(tmp_path, undrawn):
    """Their edges have no allowance, so that they fit with one weld, not with two."""
    narrow = PATTERNS.replace("2.2 m", "2.03 m").replace('border = "50 mm"', "border = 0")
    code, words = said("patterns", case(tmp_path, narrow))
    assert code == 0
    assert "Wider than the roll without allowances, 1.99 m: strip 1, strip 2" in words


def test_earlier_pattern_is_replaced_on_demand_only(again):
    code, words = said("patterns", again / "roof.toml")
    assert code == 2
    assert "has an earlier cutting pattern; give --overwrite" in words
    assert said("patterns", again / "roof.toml", "--overwrite", "--quiet") == (0, "")


def test_report_has_a_chapter_on_the_pattern(again):
    pytest.importorskip("jinja2")
    pictures = set(PICTURES.values())
    if not find_spec("pyvista") or obstacle():
        pictures = set()
    assert said("run", again / "roof.toml", "--quiet")[0] == 0
    assert said("report", again / "roof", again / "report.html")[0] == 0
    page = (again / "report.html").read_text()
    assert "<h2>Cutting patterns</h2>" in page
    assert "The cloth of 2 strips, sewn together" in page
    assert page.count("<td>strip 2</td>") == 2
    assert "Error, mean / rms / largest [%]" in page
    assert "Fits the roll" in page
    assert '<th class="n">Utilisation</th>' in page
    for words in pictures:
        assert f"<figcaption>{words}</figcaption>" in page
    (again / "roof" / "patterns" / "proof.json").write_text("{}")
    code, words = said("report", again / "roof", again / "report.html")
    assert code == 2
    assert "is no proof of a cutting pattern" in words


def test_commands_know_archives_of_patterns(made, tmp_path, undrawn):
    folder, (_, table) = made
    patterns = folder / "roof" / "patterns"
    code, words = said("show", patterns / "proof.fxm")
    assert code == 0
    assert words.strip() in table
    assert said("show", patterns) == (0, words)
    assert "Cutting pattern: 2 strips, 2 of unlike shape, 1 seam" in said("show", patterns / "pattern.fxm")[1]
    assert "PatternProof" in said("info", patterns / "proof.fxm")[1].splitlines()[0]
    code, words = said("info", folder / "roof.toml")
    assert (code, "is no archive of results" in words) == (2, True)
    code, words = said("patterns", patterns / "proof.fxm")
    assert code == 2
    assert "it is an archive, as of results, and no case; `fx-membrane show`" in words
    pytest.importorskip("jinja2")
    assert said("report", patterns / "proof.fxm", tmp_path / "proof.html")[0] == 0
    assert "The cloth of 2 strips, sewn together" in (tmp_path / "proof.html").read_text()
    code, words = said("report", patterns / "pattern.fxm", tmp_path / "pattern.html")
    assert code == 2
    assert "holds a cutting pattern without a proof" in words


def test_outlines_move_to_the_nearest_stress(tmp_path, undrawn):
    """Factors that do not fit the prestress are mended; files, proof and report tell so."""
    pytest.importorskip("jinja2")
    wrong = PATTERNS + "compensation = [0.99, 0.998]\nnearest_stress = true\n"
    file = case(tmp_path, wrong)
    assert said("run", file, "--quiet")[0] == 0
    code, words = said("patterns", file)
    assert code == 0
    assert "Nearest stress: " in words
    folder = tmp_path / "roof" / "patterns"
    fit = json.loads((folder / "proof.json").read_text())["nearest stress"]
    assert fit["converged"]
    assert fit["before"]["rms tensor error"] > 0.5
    assert fit["after"]["rms tensor error"] < 0.03
    assert "Nearest stress: " in (folder / "proof.txt").read_text()
    with (folder / "strips.csv").open(encoding="utf-8-sig", newline="") as stream:
        area = float(next(csv.DictReader(stream))["sewn area [m2]"])
    assert area == pytest.approx(12 / (1 + 2 * 0.7 / 500) ** 2, rel=1e-3)
    assert said("report", tmp_path / "roof", tmp_path / "report.html")[0] == 0
    assert "Its outlines were moved towards the stress of the design" in (tmp_path / "report.html").read_text()


def test_run_anew_drops_the_proof_of_the_form_before(again):
    proof = [again / "roof" / "patterns" / name for name in ("proof.json", "proof.txt", "pattern.fxm", "proof.fxm")]
    assert all(file.exists() for file in proof)
    said("run", again / "roof.toml", "--overwrite", "--quiet")
    assert not any(file.exists() for file in proof)
    assert (again / "roof" / "patterns" / "patterns.dxf").exists()


def test_refused_pattern_leaves_nothing_to_overwrite(tmp_path):
    file = case(tmp_path, PATTERNS.replace("2.2 m", "1.5 m"))
    for _ in range(2):
        code, words = said("patterns", file)
        assert (code, "2 of 2 pieces are wider" in words) == (2, True)
    assert not (tmp_path / "roof" / "patterns").exists()


def test_limits_of_the_pattern_decide_the_exit_code(tmp_path, undrawn):
    """Factors that do not fit the prestress: told without a limit, an error with one; a strength is always one."""
    wrong = PATTERNS + "compensation = [0.99, 0.998]\n"
    file = case(tmp_path, wrong)
    code, words = said("patterns", file)
    assert code == 0
    assert "Stress is off by more than 10 % of its mean on 100 % of the area." in words
    code, words = said("patterns", case(tmp_path, wrong + "stress_error = 0.2\n"), "--overwrite", "--quiet")
    assert code == 1
    assert "Warning: Stress is off by more than 20 % of its mean" in words
    assert "Limits of the design are exceeded: stress is off by more than 20 %" in words
    assert (tmp_path / "roof" / "patterns" / "proof.fxm").exists()
    file.write_text(file.read_text().replace("roof = 20", "roof = 4"))
    assert "'strip 1' bears 1." in said("patterns", file, "--overwrite", "--quiet")[1]
