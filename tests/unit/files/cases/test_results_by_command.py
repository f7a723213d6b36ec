"""Commands on results and mesh files, in this process."""

import json

import numpy as np
import pytest

from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import leave_out_pictures, said
from fx_membrane import load_results


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folder of a case that has run."""
    place = tmp_path_factory.mktemp("roof")
    (place / "roof.toml").write_text(ROOF + "paraview = false\n", encoding="utf-8")
    assert said("run", place / "roof.toml", "--quiet") == (0, "")
    return place


def test_folder_of_a_run_is_as_good_as_its_archive(folder):
    shown = said("show", folder / "out")
    assert shown[0] == 0
    assert shown == said("show", folder / "out" / "results.fxm")


def test_folder_without_results_is_refused_with_the_way_to_some(folder):
    code, words = said("show", folder)
    assert code == 2
    assert "fx-membrane run" in words


def test_one_stage_is_no_stages(tmp_path):
    text = ROOF.split("[[stages]]")[0] + '[[stages]]\nname = "rest"\n'
    (tmp_path / "roof.toml").write_text(text, encoding="utf-8")
    code, words = said("check", tmp_path / "roof.toml")
    assert code == 0
    assert "1 stage;" in words
    (tmp_path / "roof.toml").write_text(ROOF, encoding="utf-8")
    assert "2 stages;" in said("check", tmp_path / "roof.toml")[1]


def test_conversion_of_units(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=4)  # mm
    document.modelspace().add_3dface([(0, 0, 0), (1000, 0, 0), (0, 2000, 0)], dxfattribs={"layer": "roof"})
    document.saveas(tmp_path / "a.dxf")
    code, words = said("convert", tmp_path / "a.dxf", tmp_path / "a.obj")
    assert code == 0
    assert "names no unit of length; its numbers are in mm" in words
    assert "unit=" not in words
    code, words = said("convert", tmp_path / "a.dxf", tmp_path / "b.obj", "--unit", "m")
    assert code == 0
    assert set(words.splitlines()) == {  # click 8.2 keeps the order of both streams
        f"Wrote {tmp_path / 'b.obj'}",
        f"{tmp_path / 'b.obj'} names no unit of length; its numbers are in m.",
    }
    points = [np.loadtxt(tmp_path / f"{name}.obj", usecols=(1, 2, 3), max_rows=3) for name in "ab"]
    assert np.array_equal(points[0], 1000 * points[1])
    code, words = said("convert", tmp_path / "b.obj", tmp_path / "c.obj", "--unit", "m")
    assert code == 2
    assert "no unit" in words
    assert said("convert", tmp_path / "a.dxf", tmp_path / "c.obj", "--unit", "smoot")[0] == 2


def test_written_dxf_claims_no_unit(tmp_path):
    """It has the numbers of the structure, whose unit is not known."""
    pytest.importorskip("ezdxf")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\ng roof\nf 1 2 3\n")
    assert said("convert", tmp_path / "a.obj", tmp_path / "a.dxf")[0] == 0
    assert "is in" not in said("convert", tmp_path / "a.dxf", tmp_path / "b.obj")[1]


def test_failed_run_is_told_by_its_table_and_all_its_files(tmp_path, monkeypatch):
    pytest.importorskip("jinja2")
    later = '\n[[stages]]\nname = "wind"\nafter = "snow"\n'
    text = ROOF.replace("[[stages]]", "[work]\niterations = 8\n\n[[stages]]", 1) + "paraview = false\n"
    text = text.replace("increments = 2", "increments = 40").replace("\n[output]", later + "\n[output]")
    (tmp_path / "roof.toml").write_text(text, encoding="utf-8")
    code, told = said("run", tmp_path / "roof.toml")
    assert code == 1
    failure = load_results(tmp_path / "out" / "results.fxm").failure
    words = f"snow: no equilibrium at load factor {failure.factor:.6g}, last found at {failure.last:.6g}"
    assert 0 < failure.last < failure.factor < 1
    assert f"FAIL  {words}" in told
    assert "FAIL  wind: not computed" in told
    shown = said("show", tmp_path / "out")[1]
    assert f"FAIL  {words}" in shown
    assert "FAIL  wind: not computed" in shown
    rows = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["unfinished"]
    assert [(row["verdict"], row["check"]) for row in rows] == [("FAIL", words), ("FAIL", "wind: not computed")]
    leave_out_pictures(monkeypatch)
    assert said("report", tmp_path / "out", tmp_path / "roof.html")[0] == 0
    page = (tmp_path / "roof.html").read_text(encoding="utf-8")
    assert f'<p class="verdict FAIL">The run is incomplete: {words}; wind: not computed.' in page


def test_run_without_any_complete_stage_is_told_by_its_files(tmp_path):
    head, stages = ROOF.split("[[stages]]", 1)
    text = head + "[work]\niterations = 1\n\n[[stages]]" + stages + "paraview = false\n"
    (tmp_path / "roof.toml").write_text(text, encoding="utf-8")
    code, told = said("run", tmp_path / "roof.toml")
    assert code == 1
    assert "FAIL  lift: no equilibrium at load factor 1, last found at 0" in told
    assert "FAIL  snow: not computed" in told
    assert "FAIL  snow: not computed" in said("show", tmp_path / "out")[1]
    rows = json.loads((tmp_path / "out" / "summary.json").read_text(encoding="utf-8"))["unfinished"]
    assert len(rows) == 2


@pytest.mark.parametrize("text", ["", "\n\n", "# nothing yet\n\n# to come\n"])
def test_empty_case_is_told_the_keys_that_it_needs(text, tmp_path):
    (tmp_path / "roof.toml").write_text(text, encoding="utf-8")
    code, words = said("check", tmp_path / "roof.toml")
    assert code == 2
    for key in ("format", "geometry", "parts"):
        assert f"roof.toml:1: {key}: the key is missing; add it" in words


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("where = { x = -2 }", "where = {}", "give a range of x, y or z"),
        ('where = { x = [-2, "200 cm"], y = "-2 m" }', "where = {}", "give a range of x, y or z"),
        ('folder = "out"', 'paraview = "yes"', "'yes': give true or false"),
        ('folder = "out"', "tables = 1", "1: give true or false"),
        ('method = "newton"', 'method = "newton"\nline_search = "on"', "'on': give true or false"),
    ],
)
def test_value_of_another_kind_is_refused_in_words(old, new, words, tmp_path):
    (tmp_path / "roof.toml").write_text(ROOF.replace(old, new), encoding="utf-8")
    code, told = said("check", tmp_path / "roof.toml")
    assert code == 2
    assert words in told


@pytest.mark.parametrize("weld", ["-1", "0", '"-1 mm"'])
def test_weld_that_is_no_distance_is_refused(weld, tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\ng grid\nf 1 2 3\nf 1 3 4\n")
    head, rest = ROOF.split("[geometry]")[0], ROOF[ROOF.index("[materials") :]
    text = f'{head}[geometry]\nkind = "file"\nfile = "a.obj"\nweld = {weld}\n\n{rest}'
    (tmp_path / "roof.toml").write_text(text, encoding="utf-8")
    code, told = said("check", tmp_path / "roof.toml")
    assert code == 2
    assert "weld is" in told
