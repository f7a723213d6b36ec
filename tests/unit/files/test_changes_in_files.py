"""Natural shapes and changes in archives, summaries and reports."""

import json
import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    LengthChange,
    NaturalStretch,
    PrestressFactor,
    Stage,
    TemperatureChange,
    load_results,
    save_results,
    stability,
    write_report,
    write_tables,
)
from fx_membrane.files import archive, plain_data
from models import masted_roof

CHANGES = [
    TemperatureChange(-20.0, "roof", (1e-5, 2e-5)),
    LengthChange(0.01, "mast"),
    NaturalStretch(0.999, "edge", [0, 1]),
    PrestressFactor(0.9, "roof"),
]


@pytest.fixture(scope="module")
def results():
    structure = masted_roof(natural_stretch=(0.9995, 0.999))
    return Analysis(structure).run([Stage("cold", changes=CHANGES), Stage("plain", after="cold")])


def test_archive_keeps_natural_shapes_and_changes(results, tmp_path):
    save_results(results, tmp_path / "roof")
    found = load_results(tmp_path / "roof")
    assert found.stages == results.stages
    assert found["cold"].structure == results["cold"].structure
    for name, less in results["plain"].actions.natural.items():
        assert np.array_equal(found["plain"].actions.natural[name], less)
    assert np.array_equal(found["plain"].actions.prestress["roof"], results["plain"].actions.prestress["roof"])
    assert stability(found["plain"]).stiffnesses == pytest.approx(stability(results["plain"]).stiffnesses, rel=1e-9)


def test_archive_of_before_there_were_natural_shapes(results, tmp_path, monkeypatch):
    """Fields that it lacks have their defaults."""
    plain = Analysis(masted_roof()).run([Stage("plain")])
    fields = plain_data.Encoder._encoded

    def earlier(self, value):
        code = fields(self, value)
        for entry in self.objects[-1:]:
            for key in ("natural_stretch", "changes", "natural", *["prestress"] * (entry["class"] == "Actions")):
                entry["fields"].pop(key, None)
        return code

    monkeypatch.setattr(plain_data.Encoder, "_encoded", earlier)
    monkeypatch.setattr(archive, "FORMAT", 4)
    save_results(plain, tmp_path / "roof")
    monkeypatch.undo()
    found = load_results(tmp_path / "roof")
    assert found["plain"].structure == plain["plain"].structure
    assert found.stages == plain.stages
    assert not found["plain"].actions.natural
    assert not found["plain"].actions.changes_stress


def test_summary_tells_natural_stretch_and_factor(results, tmp_path):
    write_tables(results, tmp_path)
    told = json.loads((tmp_path / "summary.json").read_text())
    parts = next(stage for stage in _stages(told) if "roof" in stage["parts"])["parts"]
    assert parts["roof"]["prestress factor"] == [0.9, 0.9]
    length = results["cold"].structure.points[results["cold"].structure.parts["mast"].cells[0]]
    jacked = 1 + 0.01 / np.linalg.norm(length[1] - length[0])
    assert parts["mast"]["natural stretch"] == pytest.approx([jacked, jacked])
    assert parts["edge"]["natural stretch"] == pytest.approx([0.999, 1.0])


def _stages(told):
    """Tables of stages in a summary."""
    if isinstance(told, dict):
        if "parts" in told:
            yield told
        for value in told.values():
            yield from _stages(value)
    elif isinstance(told, list):
        for value in told:
            yield from _stages(value)


def test_report_tells_changes_with_units(results, tmp_path):
    write_report(results, tmp_path / "report.html", pictures=False)
    text = re.sub(r"<[^>]+>", " ", (tmp_path / "report.html").read_text())
    for line in (
        "Temperature change -20 K, expansion 1e-05 / 2e-05 1/K, of roof",
        "Change of unstressed length +0.01 m of mast",
        "Natural shape times 0.999 of edge, 2 cells",
        "Prestress times 0.9 of roof",
        "natural stretch 0.9995 / 0.999",
    ):
        assert line in text, line
