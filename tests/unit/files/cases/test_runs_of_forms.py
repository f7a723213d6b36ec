"""Cases that end with a form: their table, their files, and what the commands say to them."""

import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import said
from fx_membrane import load_results, structure_from_file

CASE = """
format = 1
title = "Film"
units = { force = "kN", length = "m" }
geometry = { kind = "grid", width = 4, height = 4, columns = 4, rows = 4 }
materials.foil = { kind = "fabric", Et = 600, nu = 0.3 }
parts.grid = { kind = "membrane", material = "foil", prestress = 2 }
supports = [{ rim_of = "grid" }]
form_finding = { method = "updated reference" }
output = { mesh = ["obj"], report = ["html"] }
"""


@pytest.fixture
def film(tmp_path, monkeypatch):
    """Folder with a case without stages, where commands run."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "film.toml").write_text(CASE, encoding="utf-8")
    return tmp_path


def test_form_is_told_with_its_files(film):
    code, words = said("run", "film.toml", "--log", "film.log")
    assert code == 0
    assert "grid: stress 2 to 2 kN/m, at most" in words
    assert "There are no stages for output.report" in words
    assert "Files in film: form.fxm, form.obj, form.sha256\n" in words
    assert "Next: fx-membrane show film; fx-membrane show film --html form.html" in words
    assert "grid: stress 2 to 2 kN/m" in (film / "film.log").read_text(encoding="utf-8")
    form = load_results("film/form.fxm")
    mesh = structure_from_file("film/form.obj", {"grid": lambda cells: form.structure.parts["grid"]})
    assert (mesh.points == form.points).all()


@pytest.mark.parametrize("place", ["film", "film/form.fxm"])
def test_form_is_shown_from_its_folder_and_its_archive(place, film):
    assert said("run", "film.toml", "--quiet") == (0, "")
    code, words = said("show", place)
    assert code == 0
    assert words.startswith("Form(Structure(25 points")
    code, words = said("report", place, "a.html")
    assert code == 2
    assert "holds a form, without stages" in words or "it has a form, without stages" in words


def test_form_becomes_a_scene(film):
    pytest.importorskip("plotly")
    assert said("run", "film.toml", "--quiet")[0] == 0
    assert said("show", "film", "--html", "a.html")[0] == 0
    assert (film / "a.html").stat().st_size > 1e6


def test_earlier_form_is_no_run_that_has_not_ended(film):
    assert said("run", "film.toml", "--quiet")[0] == 0
    code, words = said("run", "film.toml")
    assert code == 2
    assert "film has the form of an earlier run (form.fxm)" in words
    assert said("run", "film.toml", "--resume")[0] == 0
    assert said("run", "film.toml", "--overwrite")[0] == 0
