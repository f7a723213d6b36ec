"""Scene, moving picture and reports that a case asks for."""

import logging
import logging.handlers
from contextlib import redirect_stderr
from io import StringIO

import PIL.Image
import PIL.ImageSequence
import pytest

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.run import run_case
from fx_membrane.plot import windows
from roof_case import ROOF

OUTPUTS = """\
paraview = false
scene = true
animation = "gif"
report = ["html", "pdf"]
"""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """Folder of a run, its words on stderr, and warnings of weasyprint."""
    for package in ("plotly", "jinja2", "weasyprint"):
        pytest.importorskip(package)
    folder = tmp_path_factory.mktemp("roof")
    (folder / "roof.toml").write_text(ROOF + OUTPUTS, encoding="utf-8")
    handler = logging.handlers.BufferingHandler(1000)
    handler.setLevel(logging.WARNING)
    logging.getLogger("weasyprint").addHandler(handler)
    with pytest.MonkeyPatch.context() as patch, redirect_stderr(StringIO()) as words:
        patch.setattr(windows, "LONGER", 200)
        run_case(read_case(folder / "roof.toml"))
    logging.getLogger("weasyprint").removeHandler(handler)
    return folder / "out", words.getvalue(), [record.getMessage() for record in handler.buffer]


def test_report_links_into_the_scene(drawn):
    folder = drawn[0]
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert 'href="scene.html#stage=snow' in page
    assert "<title>Roof</title>" in (folder / "scene.html").read_text(encoding="utf-8")
    assert (folder / "report.pdf").read_bytes().startswith(b"%PDF")


def test_frames_of_the_stages_have_one_size(drawn):
    with PIL.Image.open(drawn[0] / "stages.gif") as movie:
        sizes = [frame.size for frame in PIL.ImageSequence.Iterator(movie)]
    assert len(sizes) == 2
    assert len(set(sizes)) == 1


def test_pictures_of_two_reports_are_drawn_once(drawn):
    assert drawn[1].count("report: pictures of") == 1


def test_page_as_pdf_has_no_warnings(drawn):
    assert drawn[2] == []
