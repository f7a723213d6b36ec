"""Code in the how-tos of the site runs as it stands, in a fresh folder; pictures of proofs are left out."""

import importlib
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import fx_membrane
from by_command import leave_out_pictures

PAGES = Path(__file__).parents[2] / ".ci" / "site" / "how-to"
CELL = re.compile(r"```\{code-cell\} ipython3\n(.*?)```", re.DOTALL)
NOTEBOOK_ONLY = re.compile(r"^(from IPython.*|Image\(.*)$", re.MULTILINE)


@pytest.mark.parametrize(
    "page", [page for page in sorted(PAGES.glob("*.md")) if CELL.search(page.read_text())], ids=lambda page: page.stem
)
def test_cells_of_a_page(page, tmp_path, monkeypatch):
    if page.stem == "cutting-patterns":
        pytest.importorskip("potpourri3d")
    monkeypatch.chdir(tmp_path)
    leave_out_pictures(monkeypatch)
    code = "\n".join(CELL.findall(page.read_text()))
    exec(compile(NOTEBOOK_ONLY.sub("", code), page.name, "exec"), {"__name__": "page"})


def test_api_pages_have_all_public_names(monkeypatch):
    monkeypatch.syspath_prepend(PAGES.parent)
    api_pages = importlib.import_module("api_pages")
    found = api_pages.names_by_folder()
    assert set(found) <= set(api_pages.TITLES)
    shown = {name.partition(".")[0] for names in found.values() for name in names}
    assert shown - {"forms"} == set(fx_membrane.__all__)


def test_gallery_has_all_demos(monkeypatch, tmp_path):
    pytest.importorskip("jupytext")
    monkeypatch.syspath_prepend(PAGES.parent)
    demos = PAGES.parents[2] / "demos"
    importlib.import_module("gallery_pages").write(demos, tmp_path, run=False)
    listed = (tmp_path / "index.md").read_text().split()
    assert {demo.stem for demo in demos.glob("*.py")} <= set(listed)
    assert {f"cookbook-{demo.stem}" for demo in demos.glob("cookbook/*.py")} <= set(listed)


def test_build_that_was_stopped_is_made_anew(monkeypatch, tmp_path):
    """Sphinx has no index of the pages that it wrote before: it failed in all later builds."""
    monkeypatch.syspath_prepend(PAGES.parent)
    pages = SimpleNamespace(write=lambda *given, **named: None)
    monkeypatch.setitem(sys.modules, "gallery_pages", pages)  # needs jupytext, which writes its own pages
    build, commands = importlib.import_module("build"), []
    monkeypatch.setattr(build, "SOURCE", tmp_path / "source")
    monkeypatch.setattr(build, "SITE", tmp_path / "site")
    monkeypatch.setattr(build, "verification", lambda reports: "")
    monkeypatch.setattr(sys, "argv", ["build.py"])

    def ended(command, **options):
        commands.append(command)
        return subprocess.CompletedProcess(command, 0)

    monkeypatch.setattr(build, "subprocess", SimpleNamespace(run=ended))
    for index in (False, True):
        if index:
            (tmp_path / "site").mkdir()
            (tmp_path / "site" / "searchindex.js").touch()
        with pytest.raises(SystemExit, match="0"):
            build.main()
    assert ["-a" in command for command in commands] == [True, False]
