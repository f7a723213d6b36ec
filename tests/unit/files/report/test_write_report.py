"""Reports: order of chapters, numbers, names that are no markup, and a page that asks for nothing."""

import logging
import os
import re
import subprocess
import sys
import time
import urllib.parse
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from by_command import leave_out_pictures, said
from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PointLoad,
    Pressure,
    Stage,
    StageResults,
    Structure,
    Support,
    boundary_edges,
    load_results,
    rectangle,
    save_results,
    write_report,
    write_tables,
)
from fx_membrane.files.report.template_values import content
from fx_membrane.files.scene.field_data import fields as scene_fields
from fx_membrane.files.scene.view_data import views
from fx_membrane.results.limits import Limits
from fx_membrane.solvers import progress
from models import masted_roof

pytest.importorskip("jinja2")
CHAPTERS = [
    "Verdict", "Model and materials", "Load cases", "Extremes", "Reactions", "Certificate", "Pictures", "Convergence",
    "Warnings", "Versions",
]  # fmt: skip
EVIL = "<script>alert(1)</script>"


@pytest.fixture(scope="module")
def results():
    wind = Stage("wind", [Pressure(50.0, EVIL), PointLoad(12, (0, 0, -5.0))], increments=2)
    gale = Stage("gale & co", [Pressure(90.0, EVIL)], after="wind")
    return Analysis(masted_roof((EVIL, "edge", "mast"))).run([wind, gale])


class Page(HTMLParser):
    """Chapters, tags and addresses of a page."""

    def __init__(self, text):
        super().__init__()
        self.chapters, self.addresses, self.tags, self._open = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self._open.append(tag)
        self.tags.append(tag)
        self.addresses += [value for name, value in attributes if name in ("src", "href")]

    def handle_data(self, data):
        if self._open and self._open[-1] == "h2" and data.strip():
            self.chapters.append(data)

    def handle_endtag(self, tag):
        while self._open and self._open.pop() != tag:
            pass


def test_certificate_has_the_moments():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    roof = {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}
    held = Structure(points, roof, [Support(np.unique(boundary_edges(triangles)))])
    found = Analysis(held, progress=False).run([Stage("push", [PointLoad(8, (0, 0, -5.0))])])
    row = content(found, "Roof", "N", "m")["stages"][0]["certificate"]
    balance = found["push"].equilibrium
    for shown, moment in (row["loads"], balance.load_moment), (row["reactions"], balance.reaction_moment):
        values = [float(word) for word in shown.strip("()").split(", ")]
        assert max(np.abs(values)) > 1.0
        assert values == pytest.approx(moment, rel=1e-4, abs=1e-8)
    assert row["stable"] == "yes"


def test_page(results, tmp_path):
    pytest.importorskip("pyvista")
    write_report(results, tmp_path / "new" / "report.html", title=f"Roof {EVIL}", force_unit="kN")
    text = (tmp_path / "new" / "report.html").read_text(encoding="utf-8")
    page = Page(text)
    assert page.chapters == CHAPTERS
    assert "script" not in page.tags
    assert all(address.startswith(("data:", "#")) for address in page.addresses)
    assert page.tags.count("img") == 6  # displacement, stress and forces of two stages
    wind = results["wind"]
    certificate = text[text.index("<h2>Certificate") : text.index("<h2>Pictures")]
    assert certificate.count("<td>yes</td>") == len(results)
    assert f"{wind.equilibrium.residual:.1e}" in certificate
    assert f"{wind.membrane(EVIL).principal[:, 0].max():.5g}" in text
    assert f"{wind.largest_displacement:.5g}" in text
    assert "gale &amp; co" in text
    assert "[kN]" in text
    vertical = wind.reactions[:-1, 2].sum()
    assert f'<td class="n">{vertical:.5g}</td>' in text


def test_title_units_and_words_of_the_results(results, tmp_path, capfd, monkeypatch):
    pytest.importorskip("pyvista")
    leave_out_pictures(monkeypatch)
    named = StageResults(results, results.stages)
    named.title, named.force_unit, named.length_unit = "Tent \udc80", "kN", "mm"
    write_report(named, tmp_path / "r.html")
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert "<title>Tent &#56448;</title>" in text
    assert "Units as given: kN, mm." in text
    assert capfd.readouterr().err.startswith("report: pictures of 2 stages, 0.0 s\n")
    write_report(results, tmp_path / "r.html", pictures=False)
    assert "<title>Structural analysis</title>" in (tmp_path / "r.html").read_text(encoding="utf-8")


def test_links_into_the_scene(results, tmp_path):
    """From the folder of the report, with names of stages that have letters of addresses in them."""
    (tmp_path / "my scenes").mkdir()
    scene = tmp_path / "my scenes" / "s.html"
    with pytest.raises(ValueError, match="does not exist; write it first"):
        write_report(results, tmp_path / "new" / "r.html", pictures=False, scene=scene)
    scene.touch()
    write_report(results, tmp_path / "new" / "r.html", pictures=False, scene=scene)
    page = Page((tmp_path / "new" / "r.html").read_text(encoding="utf-8"))
    links = [urllib.parse.urlsplit(address) for address in page.addresses if not address.startswith("#")]
    assert {urllib.parse.unquote(link.path) for link in links} == {"../my scenes/s.html"}
    assert not any(link.scheme or link.netloc or link.query for link in links)
    wanted = [urllib.parse.parse_qs(link.fragment) for link in links if link.fragment]
    fields = ["displacement", "principal stress I", "principal stress II", "stress along warp", "stress along weft"]
    for stage in ("wind", "gale & co"):
        for field in [*fields, "force"]:
            assert {"stage": [stage], "field": [field]} in wanted
    known = {field.name for field in scene_fields(*views(results, "N", "m"), "m")}
    assert {field for link in wanted for field in link["field"]} <= known


def test_unstable_state_is_a_warning(tmp_path):
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    structure = Structure(
        points, {"roof": Membrane(triangles, Fabric(1e3, 0.3), 1.0)}, [Support(np.unique(boundary_edges(triangles)))]
    )
    found = Analysis(structure).run([Stage("gale", [PointLoad(4, (0, 0, -900.0))])])
    write_report(found, tmp_path / "r.html", pictures=False)
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    assert '<p class="verdict WARN">' in text
    assert re.search(r"gale: .*strained", text)


def test_pdf_tells_its_pages_while_they_are_laid_out(results, tmp_path, capfd, monkeypatch):
    """Many stages and parts take minutes, in which nothing was written."""
    try:
        import weasyprint  # noqa: F401, PLC0415
    except (ImportError, OSError) as error:
        pytest.skip(str(error).splitlines()[0])
    monkeypatch.setattr(progress, "SILENCE", 0.02)
    pages = logging.getLogger("weasyprint.progress")

    def slow(record: logging.LogRecord) -> bool:
        """Let each step and page take longer than the silence, as those of a long report do."""
        time.sleep(0.2)
        return True

    pages.addFilter(slow)
    try:
        write_report(results, tmp_path / "r.pdf", pictures=False)
    finally:
        pages.removeFilter(slow)
    assert (tmp_path / "r.pdf").read_bytes()[:5] == b"%PDF-"
    told = capfd.readouterr().err
    assert "r.pdf: styles of the PDF, " in told
    assert re.search(r"r\.pdf: page \d of the PDF, ", told)
    time.sleep(0.1)
    assert capfd.readouterr().err == ""  # it has ended


def renamed(results, names):
    """Give other names to stages and their states."""
    return StageResults({name: replace(state, name=name) for name, state in zip(names, results.values(), strict=True)})


def test_each_table_of_a_stage_has_its_name_in_its_head(results, tmp_path):
    """A head is repeated on each page: a column of stages left the second page without one."""
    long = "snow_and_wind_from_the_north_" * 4
    write_report(renamed(results, [long, "\u98a8 2"]), tmp_path / "r.html", pictures=False)
    text = (tmp_path / "r.html").read_text(encoding="utf-8")
    checks, designed = text.split("Checks of the computation")[1].split("Limits of the design")[:2]
    for chapter in (checks, designed, text.split("<h2>Extremes</h2>")[1]):
        heads = re.findall(r'<thead><tr><th class="stage" colspan="\d">(.*?)</th></tr>', chapter.split("<h2>")[0])
        assert [re.sub("<wbr>", "", head) for head in heads] == [long, "\u98a8 2"]
    broken = re.search(r'<th class="stage" colspan="5">(snow.*?)</th>', text)[1]
    assert max(map(len, broken.split("<wbr>"))) < 25


def test_letters_without_a_font_are_told_once(results, tmp_path, caplog):
    try:
        import weasyprint  # noqa: PLC0415
    except (ImportError, OSError) as error:
        pytest.skip(str(error).splitlines()[0])
    if int(weasyprint.__version__.split(".")[0]) < 63:
        pytest.skip("this weasyprint leaves letters without a font out, without a word")
    odd = "\U0001d300\ue123"  # the second is for private use: no font has it
    with pytest.warns(UserWarning, match=r"No font of this machine has .* letters? of names .*: the PDF shows boxes"):
        write_report(renamed(results, [odd, odd * 2]), tmp_path / "r.pdf", pictures=False)
    assert not [record for record in caplog.records if "notdef" in record.getMessage()]


def test_command(results, tmp_path):
    """In a process of its own, which has loaded nothing before; pictures are those of `test_page`."""
    save_results(results, tmp_path / "results.fxm")
    command = [sys.executable, "-c", "from fx_membrane.cli import main; main()", "show", "results.fxm"]
    sources = str(Path(__file__).parents[4])  # where the package is not installed
    options = {"cwd": tmp_path, "env": os.environ | {"PYTHONPATH": sources}}
    shown = subprocess.run(command, capture_output=True, text=True, check=True, **options)
    assert shown.stdout.count("PASS") >= 10


def test_command_writes_scenes(results, tmp_path, monkeypatch):
    pytest.importorskip("plotly")
    leave_out_pictures(monkeypatch)
    monkeypatch.chdir(tmp_path)
    save_results(results, "results.fxm")
    assert said("show", "results.fxm", "--html", "scene.html") == (0, "Wrote scene.html\n")
    assert '"name":"gale & co"' in Path("scene.html").read_text(encoding="utf-8")
    code, words = said("report", "results.fxm", "r.html", "--scene", "turn.html")
    assert (code, "Wrote r.html" in words) == (0, True)
    assert Path("turn.html").exists()
    assert 'href="turn.html#' in Path("r.html").read_text(encoding="utf-8")


def test_refusals(results, tmp_path):
    for path, words in [(tmp_path / "r.doc", r"\.pdf"), (tmp_path, r"\.pdf")]:
        with pytest.raises(ValueError, match=words):
            write_report(results, path)
    with pytest.raises(ValueError, match="no stage"):
        write_report(StageResults(), tmp_path / "r.html")


def test_units_of_the_results_are_taken_where_none_are_given(results, tmp_path):
    results.force_unit, results.length_unit = "kN", "mm"
    save_results(results, tmp_path / "results.fxm")
    found = load_results(tmp_path / "results.fxm")
    write_report(found, tmp_path / "r.html", pictures=False)
    write_tables(found, tmp_path)
    page = (tmp_path / "r.html").read_text()
    assert "Units as given: kN, mm." in page
    assert " kN/mm2 on " in page or " kN on " in page
    assert "kN/mm, nu = 0.3" in re.sub("</?span[^>]*>", "", page)
    assert "displacement x [mm]" in (tmp_path / "nodes.csv").read_text(encoding="utf-8-sig").splitlines()[0]
    results.force_unit, results.length_unit = "N", "m"


def test_design_is_judged_apart_from_the_computation(results, tmp_path):
    results.limits = Limits(displacement=1e-9)
    write_report(results, tmp_path / "r.html", pictures=False)
    results.limits = None
    page = (tmp_path / "r.html").read_text()
    assert '<p class="verdict FAIL">Design: limits are exceeded, by displacement in ' in page
    assert '<p class="verdict FAIL">Computation' not in page
    before, after = page.split("<h3>Limits of the design</h3>")
    assert ">displacement</td>" not in before
    assert ">displacement</td>" in after.split("<h2>")[0]


def test_iterations_are_the_same_everywhere(results, tmp_path, capsys):
    write_report(results, tmp_path / "r.html", pictures=False)
    page = (tmp_path / "r.html").read_text().split("<h2>Convergence</h2>")[1]
    counts = [increment.total_iterations for state in results.values() for increment in state.increments]
    rows = re.findall(r'<td>[^<]*</td><td class="n">[^<]*</td><td>[^<]*</td><td class="n">(\d+)</td>', page)
    assert [int(row) for row in rows] == counts
