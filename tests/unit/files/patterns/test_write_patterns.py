"""Files of cutting patterns, read back: areas and lengths, texts, reproducible bytes, and refusals."""

import csv
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest

from cone_gores import cone_gores
from fx_membrane import Allowances, LengthUnitWarning, cut_pieces, laid_on_roll, write_patterns
from fx_membrane.files.patterns import write
from fx_membrane.files.patterns.sheet_plans import Head
from fx_membrane.geometry.length_units import METRES

pytest.importorskip("shapely.creation")  # of shapely 2
ALLOWANCES = Allowances(seam=0.03, border=0.08)


@pytest.fixture(scope="module")
def pattern():
    return cone_gores(12, copies=True)


@pytest.fixture
def empty_pdf(monkeypatch):
    """Leave the sheets of the PDF out, which are those of the SVG in the same folder."""
    monkeypatch.setattr(write, "write_pdf", lambda pieces, sheets, file, *_: file.touch())


def area(points):
    x, y = np.asarray(points).T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_drawing_has_all_pieces_in_millimetres(pattern, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_patterns(pattern, tmp_path / "new" / "cone.dxf", ALLOWANCES, roll_width=6.5)
    document = ezdxf.readfile(tmp_path / "new" / "cone.dxf")
    assert document.header["$INSUNITS"] == 4
    assert not document.audit().errors
    space = document.modelspace()
    piece = cut_pieces(pattern, ALLOWANCES)["gore 1"]
    for layer, wanted in (("cut", piece.cut_area), ("sew", piece.sewn_area)):
        lines = list(space.query(f"LWPOLYLINE[layer=='{layer}']"))
        assert len(lines) == 12
        assert all(line.closed for line in lines)
        areas = [area(np.array(line.get_points("xy")) / 1000) for line in lines]
        np.testing.assert_allclose(areas, wanted, rtol=1e-9)
    perimeter = np.linalg.norm(np.diff(np.vstack([piece.sewing, piece.sewing[:1]]), axis=0), axis=1).sum()
    sewn = np.array(lines[0].get_points("xy"))
    assert np.linalg.norm(sewn - np.roll(sewn, 1, axis=0), axis=1).sum() == pytest.approx(1000 * perimeter, rel=1e-9)
    assert len(space.query("LINE[layer=='marks']")) == 12 * len(piece.marks)
    assert len(space.query("LWPOLYLINE[layer=='warp']")) == 12
    words = {entity.dxf.text for entity in space.query("TEXT[layer=='text']")}
    assert {"gore 1 (12 times)", "seam 2 / gore 2", "1", "gore 5 (as gore 1)"} <= words
    assert {"cut", "sew", "warp", "marks", "text"} <= {layer.dxf.name for layer in document.layers}
    ends = np.vstack([np.array(line.get_points("xy")) for line in space.query("LWPOLYLINE[layer=='cut']")])
    layout = laid_on_roll({"gore 1": piece}, 6.5)
    np.testing.assert_allclose(ends.max(axis=0)[0], 1000 * layout.length, rtol=1e-9)
    assert ends.max(axis=0)[1] <= 6500 * (1 + 1e-9)


def test_drawing_of_a_pattern_in_feet_is_in_millimetres(pattern, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_patterns(pattern, tmp_path / "cone.dxf", Allowances(0.0, 0.0), length_unit="ft")
    sewn = next(iter(ezdxf.readfile(tmp_path / "cone.dxf").modelspace().query("LWPOLYLINE[layer=='sew']")))
    wanted = cut_pieces(pattern)["gore 1"].sewn_area * 304.8**2
    assert area(sewn.get_points("xy")) == pytest.approx(wanted, rel=1e-9)


def test_names_of_users_are_texts_in_every_file(tmp_path, empty_pdf):
    ezdxf = pytest.importorskip("ezdxf")
    pattern = cone_gores(3, names="=$Süd%%c^J <{}>\n")
    write_patterns(pattern, tmp_path / "out", project="=SUM(A1) & <b>")
    space = ezdxf.readfile(tmp_path / "out" / "patterns.dxf").modelspace()
    # Three per cent signs are one, and a caret before a space is one; plain_text of ezdxf 1.4.1 reads a diameter there.
    assert "=$Süd%%%%%%c^ J <1>" in {entity.dxf.text for entity in space.query("TEXT")}
    assert (tmp_path / "out" / "strips.csv").read_text("utf-8-sig").splitlines()[1].startswith("\"'=$Süd")
    sheet = next((tmp_path / "out" / "sheets").glob("01-*.svg"))
    assert sheet.name == "01-sud-c-j-1.svg"
    assert "=$Süd%%c^J <1>" in texts(sheet)
    assert "=SUM(A1) & <b>" in texts(sheet)


def texts(file):
    return ["".join(entry.itertext()).strip() for entry in ET.parse(file).iter("{http://www.w3.org/2000/svg}text")]


def outline(file, name):
    """Corners of a line of an SVG of matplotlib, upwards [mm]."""
    root = ET.parse(file).getroot()
    entry = next(entry for entry in root.iter("{http://www.w3.org/2000/svg}g") if entry.get("id") == name)
    numbers = re.findall(r"-?[\d.]+", entry[0].get("d"))
    points = np.array(numbers, dtype=float).reshape(-1, 2) * (1, -1) * 25.4 / 72
    return points[:-1] if np.allclose(points[0], points[-1]) else points


def test_sheet_is_to_scale_with_its_title_block(pattern, tmp_path, empty_pdf):
    write_patterns(pattern, tmp_path / "out", ALLOWANCES, project="Cone", material="PVC II", date="2026-03-01")
    (sheet,) = (tmp_path / "out" / "sheets").iterdir()
    words = texts(sheet)
    assert {"Cone", "PVC II", "2026-03-01", "1:20", "gore 1", "gore 1 (12 times)", "12"} <= set(words)
    piece = cut_pieces(pattern, ALLOWANCES)["gore 1"]
    assert f"{piece.sewn_area:.4g} / {piece.cut_area:.4g}" in words
    for name, wanted in (("cut gore 1", piece.cut), ("sew gore 1", piece.sewing)):
        found = outline(sheet, name)
        assert len(found) == len(wanted)
        moved = wanted * 1000 / 20 - (wanted[0] * 1000 / 20 - found[0])
        np.testing.assert_allclose(found, moved, atol=1e-3)
    root = ET.parse(sheet).getroot()
    assert float(root.get("width").removesuffix("pt")) * 25.4 / 72 == pytest.approx(420, abs=1e-3)


def test_sheet_of_a_narrow_strip_names_its_edges_outside(tmp_path, empty_pdf):
    """At 1:100 texts within a strip of 0.2 m could not be read; numbers of all marks and edges are beside it."""
    narrow = cone_gores(60, copies=True)
    write_patterns(narrow, tmp_path / "out", scale=100)
    (sheet,) = (tmp_path / "out" / "sheets").iterdir()
    found = texts(sheet)
    assert {"seam 1 / gore 60", "seam 2 / gore 2", "base 1", "ring 1 / ring"} <= set(found)
    assert found.count("1") >= 2
    write_patterns(narrow, tmp_path / "roll.svg", roll_width=3.0, scale=100, paper="A0")
    assert "seam 1 / gore 60" not in texts(tmp_path / "roll.svg")  # there it would cross other strips


@pytest.mark.parametrize(("paper", "scale"), [("A4", "1:50"), ("A3", "1:20"), ("A1", "1:10"), ("A0", "1:10")])
def test_scale_is_chosen_for_the_paper(pattern, tmp_path, paper, scale):
    write_patterns(pattern, tmp_path / "cone.svg", paper=paper)
    assert scale in texts(tmp_path / "cone.svg")


def test_long_roll_is_drawn_in_bands(tmp_path):
    write_patterns(cone_gores(12), tmp_path / "cone.svg", roll_width=5.0)
    assert {f"gore {number}" for number in range(1, 13)} <= set(texts(tmp_path / "cone.svg"))
    outlines = [outline(tmp_path / "cone.svg", f"cut gore {number}") for number in range(1, 13)]
    low = {np.round(line[:, 1].min(), 3) for line in outlines}
    assert len(low) == 3
    ends = np.vstack(outlines)
    assert np.ptp(ends[:, 0]) < 400
    assert np.ptp(ends[:, 1]) < 270


def test_pages_of_the_pdf_have_text(tmp_path):
    if not shutil.which("pdftotext"):
        pytest.skip("needs pdftotext")
    write_patterns(cone_gores(8), tmp_path / "cone.pdf", project="Große Halle", roll_width=8.0)
    told = subprocess.run(["pdftotext", tmp_path / "cone.pdf", "-"], capture_output=True, text=True, check=True).stdout
    pages = told.rstrip("\f").split("\f")
    assert len(pages) == 9
    assert all("Große Halle" in page for page in pages)
    assert "Waste" in pages[0]
    assert all(f"gore {number}" in pages[number] for number in (1, 2, 3))


def test_roll_of_many_sheets_is_several_pages(tmp_path):
    many = cone_gores(12, copies=True)
    write_patterns(many, tmp_path / "cone.pdf", roll_width=5.0, paper="A4", scale=50)
    pages = re.search(rb"/Count (\d+)", (tmp_path / "cone.pdf").read_bytes())
    assert int(pages[1]) >= 1 + 6
    with pytest.raises(ValueError, match=r"takes \d+ sheets A4 at 1:50, and an SVG is one"):
        write_patterns(many, tmp_path / "cone.svg", roll_width=5.0, paper="A4", scale=50)


def rows(file):
    with file.open(encoding="utf-8-sig", newline="") as stream:
        return list(csv.DictReader(stream))


def test_tables_have_areas_lengths_and_the_cloth(pattern, tmp_path):
    write_patterns(pattern, tmp_path / "cone.csv", ALLOWANCES, roll_width=6.5)
    pieces = cut_pieces(pattern, ALLOWANCES)
    piece, layout = pieces["gore 1"], laid_on_roll(pieces, 6.5)
    strip, total, cloth = rows(tmp_path / "cone.csv")
    assert strip["strip"] == "gore 1"
    assert strip["number"] == "12"
    assert float(strip["sewn area [m2]"]) == piece.sewn_area
    assert float(strip["width [m]"]) == piece.width
    assert strip["cut like it"].startswith("gore 2; gore 3")
    assert float(total["cut area [m2]"]) == pytest.approx(12 * piece.cut_area, rel=1e-14)
    assert float(cloth["cut area [m2]"]) == layout.area
    assert float(cloth["length [m]"]) == layout.length
    sides = rows(tmp_path / "cone_sides.csv")
    assert [side["edge"] for side in sides] == ["base 1", "seam 2", "ring 1", "seam 1"]
    assert [float(side["length [m]"]) for side in sides] == [side.length for side in piece.sides]
    assert [float(side["allowance [m]"]) for side in sides] == [0.08, 0.03, 0.08, 0.03]


def test_files_of_equal_patterns_are_equal(pattern, tmp_path):
    for folder in ("one", "two"):
        write_patterns(pattern, tmp_path / folder, project="Cone", date="March")
    files = sorted(path.relative_to(tmp_path / "one") for path in (tmp_path / "one").rglob("*.*"))
    assert {str(file) for file in files} >= {"patterns.pdf", "strips.csv", "strips_sides.csv", "patterns.dxf"}
    for file in files:
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes(), file


@pytest.mark.parametrize("name", ["roof.v2", "2026.03", "Dach.Süd", "cone.dxf", "a.b/c.d"])
def test_folders_may_have_dots(pattern, tmp_path, name, empty_pdf):
    if name == "cone.dxf":
        (tmp_path / name).mkdir()  # a folder that is there is one
    write_patterns(pattern, tmp_path / name)
    files = {path.name for path in (tmp_path / name).iterdir()}
    assert files == {"patterns.dxf", "patterns.pdf", "strips.csv", "strips_sides.csv", "sheets"}


def test_path_that_ends_with_a_slash_is_a_folder(pattern, tmp_path, empty_pdf):
    write_patterns(pattern, f"{tmp_path}/plans.csv/")
    assert (tmp_path / "plans.csv" / "strips.csv").is_file()


@pytest.mark.parametrize(
    ("path", "given", "words"),
    [
        ("cone.doc", {}, r"'.*cone.doc'; give a name that ends in .dxf, .pdf, .svg, .csv"),
        ("cone.dxf", {"roll_width": 3.0}, "width of the roll is 3.*'gore 1' with 3.*wider roll"),
        ("cone.svg", {"paper": "A9"}, "'A9'; give one of A0"),
        ("cone.svg", {"scale": 1}, "does not fit on A3 at 1:1; give 1:20, or larger paper"),
        ("cone.svg", {"length_unit": "furlong"}, "furlong"),
        ("cone.svg", {"mark_spacing": 0}, "mark_spacing"),
    ],
)
def test_wrong_input_is_refused(pattern, tmp_path, path, given, words):
    with pytest.raises(ValueError, match=words):
        write_patterns(pattern, tmp_path / path, **given)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("unit", ["km", "mm"])
def test_unit_that_no_roof_has_is_doubted(pattern, tmp_path, unit):
    """A form in millimetres whose unit was not named had a drawing 8 km wide."""
    length = cut_pieces(pattern)["gore 1"].length
    with pytest.warns(LengthUnitWarning, match=rf"'gore 1' is {length:.4g} {unit} long.*length_unit") as told:
        write_patterns(pattern, tmp_path / "cone.csv", length_unit=unit)
    assert told[0].filename == __file__


def test_usual_allowances_and_marks_have_the_unit_of_the_pattern(pattern, tmp_path):
    """A pattern in millimetres had welds of 0.02 mm, and ten thousands of marks."""
    points = 1000 * pattern.strips.structure.points
    scaled = replace(
        pattern,
        strips=replace(pattern.strips, structure=replace(pattern.strips.structure, points=points), length_unit="mm"),
        flat={name: replace(flat, points=1000 * flat.points) for name, flat in pattern.flat.items()},
        cloth={name: replace(flat, points=1000 * flat.points) for name, flat in pattern.cloth.items()},
    )
    metres, millimetres = cut_pieces(pattern)["gore 1"], cut_pieces(scaled)["gore 1"]
    assert [side.allowance for side in millimetres.sides] == [50.0, 20.0, 50.0, 20.0]
    np.testing.assert_allclose(millimetres.cut, 1000 * metres.cut, rtol=1e-9, atol=1e-6)
    assert len(millimetres.marks) == len(metres.marks)
    partly = cut_pieces(scaled, Allowances(seam=30.0))["gore 1"]
    assert [side.allowance for side in partly.sides] == [50.0, 30.0, 50.0, 30.0]
    with pytest.warns(LengthUnitWarning, match=r"allowance of .* is 0.02 mm, too narrow for a weld or a hem; give"):
        write_patterns(scaled, tmp_path / "cone.csv", Allowances(seam=0.02))


@pytest.mark.parametrize(
    ("unit", "length", "area"),
    [("m", "12.746", "123.46"), ("mm", "13", "123"), ("ft", "12.746", "123.46"), ("cm", "12.7", "123")],
)
def test_lengths_on_sheets_are_told_to_a_millimetre(unit, length, area):
    """Four digits left 10 mm of a strip of 12 m, and wrote 1.08e+07 mm2."""
    head = Head("", "", "", unit, 1000 * METRES[unit])
    assert (head.length(12.7456), head.area(123.456)) == (length, area)
