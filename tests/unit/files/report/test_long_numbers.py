"""Reports with long numbers: whole on the pages of a PDF, and without exponents."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PointLoad,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    write_report,
)
from fx_membrane.files.report.template_values import content

pytest.importorskip("jinja2")


def laid_out(box):
    """Boxes within a box of weasyprint, and the box itself."""
    yield box
    for child in getattr(box, "children", ()):
        yield from laid_out(child)


def far_away():
    """State of a sheet far from the origin, under a large force: its numbers are long."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    sheet = {"sheet over the main entrance": Membrane(triangles, Fabric(1.2e8, 0.3), 1.2e6)}
    held = Structure(
        points + np.array([2345.6, -3456.7, 456.7]), sheet, [Support(np.unique(boundary_edges(triangles)))]
    )
    wind = Stage("wind from the north-west, doors open", [PointLoad(8, (12345.6, -23456.7, -34567.8))])
    return Analysis(held, progress=False).run([wind])


def test_pages_of_a_pdf_show_every_word_whole(tmp_path):
    """Columns on the right lay beyond the paper, and words of one letter a line within narrow ones."""
    try:
        import weasyprint  # noqa: PLC0415
    except (ImportError, OSError) as error:
        pytest.skip(str(error).splitlines()[0])
    found = far_away()
    write_report(found, tmp_path / "r.html", pictures=False)
    shown = []
    for page in weasyprint.HTML(tmp_path / "r.html").render().pages:
        every = [box for box in laid_out(page._page_box) if getattr(box, "text", "").strip()]
        assert max(box.position_x + box.width for box in every) < page.width
        shown += [box.text.strip() for box in every]
    text = "\n".join(shown)
    assert "Stable" in text
    assert "PASS" in shown
    assert [words for words in shown if re.search(r"[a-z]/$", words)] == []  # of a unit
    assert any(words.endswith(" m deep") for words in shown)
    row = content(found, "Roof", "N", "m")["stages"][0]
    vectors = [row["certificate"]["loads"], *row["sums"].values()]
    numbers = [entry[end] for entry in row["extremes"] for end in ("least", "largest")]
    for words in [*" ".join(vectors).split(), *numbers]:
        assert words in text


def test_numbers_of_parts_have_no_exponent():
    part = content(far_away(), "Roof", "N", "m")["parts"][0]
    assert part["prestress"] == "1200000 / 1200000 N/m"
    assert part["material"] == "Fabric: Et = 120000000 N/m, nu = 0.3"
