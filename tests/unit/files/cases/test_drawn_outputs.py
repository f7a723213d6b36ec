"""Scene, moving picture and reports that a case asks for."""

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
def said(tmp_path_factory):
    folder = tmp_path_factory.mktemp("roof")
    (folder / "roof.toml").write_text(ROOF + OUTPUTS, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(windows, "LONGER", 200)
        run_case(read_case(folder / "roof.toml"))
    return folder / "out"


def test_report_links_into_the_scene(said):
    page = (said / "report.html").read_text(encoding="utf-8")
    assert 'href="scene.html#stage=snow' in page
    assert "<title>Roof</title>" in (said / "scene.html").read_text(encoding="utf-8")
    assert (said / "report.pdf").read_bytes().startswith(b"%PDF")


def test_frames_of_the_stages_have_one_size(said):
    with PIL.Image.open(said / "stages.gif") as movie:
        sizes = [frame.size for frame in PIL.ImageSequence.Iterator(movie)]
    assert len(sizes) == 2
    assert len(set(sizes)) == 1


def test_pictures_of_two_reports_are_drawn_once(tmp_path, monkeypatch, capfd):
    (tmp_path / "roof.toml").write_text(ROOF + OUTPUTS.replace("true", "false").replace('animation = "gif"\n', ""))
    monkeypatch.setattr(windows, "LONGER", 200)
    run_case(read_case(tmp_path / "roof.toml"))
    assert capfd.readouterr().err.count("report: pictures of") == 1
