"""Results of a run that failed: all files have the last state found of the stage that failed, and the reason."""

import json

import pytest

from fx_membrane import (
    Analysis,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    WorkLimit,
    boundary_edges,
    load_results,
    rectangle,
    save_results,
    write_report,
    write_scene,
    write_tables,
)
from fx_membrane.results.table_of_run import overview

REASON = "the limit of 12 iterations"


def failed(stages, iterations):
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    parts = {"roof": Membrane(triangles, Fabric(500e3, 0.3), prestress=1e3)}
    roof = Structure(points, parts, [Support(boundary_edges(triangles).ravel())])
    with pytest.raises(ConvergenceError) as error:
        Analysis(roof, limit=WorkLimit(iterations=iterations)).run(stages)
    return error.value


@pytest.fixture(scope="module")
def error():
    snow = Stage("snow", [DistributedLoad((0, 0, -600.0), "roof")])
    ice = Stage("ice", [DistributedLoad((0, 0, -60e3), "roof")], increments=4, after="snow")
    return failed([snow, ice], 12)


@pytest.fixture(scope="module")
def name(error):
    return f"ice, up to load factor {error.results.failure.last:.6g}"


def test_last_state_stands_beside_the_complete_ones(error, name):
    assert 0 < error.results.failure.last < 1
    assert list(error.results) == ["snow"]  # that of a whole stage is not mistaken for it
    assert list(error.results.states) == ["snow", name]
    assert (error.results.states[name].displacement == error.last.displacement).all()


def test_tables_and_screen_have_it(error, name, tmp_path):
    assert f"Stage {name!r}" in overview(error.results)
    write_tables(error.results, tmp_path)
    assert name in json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["stages"]
    assert f'"{name}",roof' in (tmp_path / "membranes.csv").read_text(encoding="utf-8")


def test_report_and_scene_of_the_archive_show_it_with_the_reason(error, name, tmp_path):
    pytest.importorskip("jinja2")
    pytest.importorskip("plotly")
    save_results(error.results, tmp_path / "roof.fxm")
    results = load_results(tmp_path / "roof.fxm")
    write_report(results, tmp_path / "roof.html")
    page = (tmp_path / "roof.html").read_text(encoding="utf-8")
    assert f"Stage {name}, deformed shape" in page
    assert "Distributed load (0, 0, -60000)" in page
    assert REASON in page
    write_scene(results, tmp_path / "scene.html")
    scene = (tmp_path / "scene.html").read_text(encoding="utf-8")
    assert name in scene
    assert REASON in scene


def test_first_stage_that_fails_at_once_is_shown_at_its_start(tmp_path):
    error = failed([Stage("ice", [DistributedLoad((0, 0, -60e3), "roof")])], 1)
    assert not error.results
    write_report(error.results, tmp_path / "roof.html", pictures=False)
    assert "ice, at its start" in (tmp_path / "roof.html").read_text(encoding="utf-8")
