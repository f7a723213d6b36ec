"""Ponds and ropes in archives, tables, reports and checkpoints."""

import csv
import json
import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    FixedLength,
    GivenForce,
    Membrane,
    Pond,
    Rope,
    Stage,
    Structure,
    Support,
    equilibrium_path,
    load_results,
    rectangle,
    report,
    save_results,
    stability,
    write_report,
    write_tables,
)

STAGES = [
    Stage("rain", [Pond("roof", rain=0.05)]),
    Stage("more", [Pond("roof", rain=0.05)], after="rain"),
    Stage("jack", changes=[GivenForce(3e4, "edge")], after="more"),
    Stage("fixed", changes=[FixedLength("edge")], after="jack"),
]


def roof():
    points, triangles = rectangle(8.0, 8.0, 4, 4)
    points[:, 1] += np.where(points[:, 1] == -4, 0.4 * (1 - points[:, 0] ** 2 / 16), 0.0)
    rope = np.flatnonzero(points[:, 1] < -3)
    rim = np.flatnonzero((np.abs(points[:, 0]) == 4) | (points[:, 1] == 4))
    parts = {"roof": Membrane(triangles, Fabric(6e5, 0.3), 2e3), "edge": Rope(rope, 5e6, 4e4)}
    return Structure(points, parts, [Support(rim), Support(rope, "z")])


@pytest.fixture(scope="module")
def results():
    return Analysis(roof(), progress=False).run(STAGES)


def test_archive_keeps_water_and_ropes(results, tmp_path):
    save_results(results, tmp_path / "roof")
    found = load_results(tmp_path / "roof")
    assert found.stages == results.stages
    for name, state in results.items():
        assert found[name].rope("edge").length == state.rope("edge").length
        assert found[name].ponds[0].level == state.ponds[0].level
        assert np.array_equal(found[name].ponds[0].depth, state.ponds[0].depth)
    assert stability(found["fixed"]).stiffnesses == pytest.approx(stability(results["fixed"]).stiffnesses, rel=1e-9)


def test_tables_and_report(results, tmp_path):
    write_tables(results, tmp_path)
    rows = list(csv.DictReader((tmp_path / "ropes.csv").open(encoding="utf-8-sig")))
    assert len(rows) == 4 * 4
    assert float(rows[-1]["force [N]"]) == results["fixed"].rope("edge").force[-1]
    told = json.loads((tmp_path / "summary.json").read_text())["stages"]["fixed"]
    assert told["ponds"][0]["volume"] == results["fixed"].ponds[0].volume
    assert told["parts"]["edge"]["length"] == results["fixed"].rope("edge").length
    text = report(results["fixed"])
    assert "tension of the rope" in text
    assert "Pond on 'roof': level" in text
    write_report(results, tmp_path / "r.html", pictures=False)
    page = re.sub("<.*?>", "", (tmp_path / "r.html").read_text())
    assert "Water, rain 0.05 m, weight 9810 N/m3, on roof" in page
    assert "Given force 30000 N of edge" in page
    assert "Length fixed as it is of edge" in page


def test_run_goes_on_from_its_checkpoint(results, tmp_path):
    Analysis(roof(), progress=False).run(STAGES[:3], tmp_path / "run")
    again = Analysis(roof(), progress=False).run(STAGES, tmp_path / "run")
    np.testing.assert_array_equal(again["jack"].displacement, again["jack"].displacement)
    np.testing.assert_allclose(again["fixed"].displacement, results["fixed"].displacement, atol=1e-9)
    assert again["fixed"].ponds[0].level == pytest.approx(results["fixed"].ponds[0].level)


def test_path_of_rain_ends_in_the_state_of_the_stage(results):
    """The border of a pond, and its change with the load factor, are in the tangent of paths."""
    stage = Stage("more", [Pond("roof", rain=0.05)], after="rain", increments=3)
    path = equilibrium_path(results["rain"], stage, load_factor=1.0)
    end = path.points[-1]
    np.testing.assert_allclose(end.displacement, results["more"].displacement, atol=1e-6)
