"""Code in the how-tos of the site runs as it stands, in a fresh folder."""

import re
from pathlib import Path

import pytest

PAGES = Path(__file__).parents[2] / ".ci" / "site" / "how-to"
CELL = re.compile(r"```\{code-cell\} ipython3\n(.*?)```", re.DOTALL)
NOTEBOOK_ONLY = re.compile(r"^(from IPython.*|Image\(.*)$", re.MULTILINE)


@pytest.mark.parametrize(
    "page", [page for page in sorted(PAGES.glob("*.md")) if CELL.search(page.read_text())], ids=lambda page: page.stem
)
def test_cells_of_a_page(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    code = "\n".join(CELL.findall(page.read_text()))
    exec(compile(NOTEBOOK_ONLY.sub("", code), page.name, "exec"), {"__name__": "page"})
