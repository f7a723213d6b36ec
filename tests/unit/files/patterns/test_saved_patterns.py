"""Archives of strips, cutting patterns and proofs: each bit comes back, and work goes on from them elsewhere."""

import dataclasses
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    DistributedLoad,
    Fabric,
    Form,
    Membrane,
    Structure,
    Support,
    boundary_edges,
    cut_strips,
    cutting_pattern,
    geodesic,
    load_results,
    prove_pattern,
    rectangle,
    save_results,
    with_copies,
    write_patterns,
    write_report,
)
from fx_membrane.files import archive
from fx_membrane.files.patterns.saved_patterns import assembly
from fx_membrane.patterns.stress_fit import StressErrors, StressFit
from fx_membrane.plot import contour_maps, cutting_patterns
from fx_membrane.plot.screen import obstacle
from same_data import same


@pytest.fixture(scope="module")
def proof():
    """Prove the pattern of a low vault of four strips, two of them copies, by the units of its form."""
    pytest.importorskip("potpourri3d")
    points, triangles = rectangle(6.0, 4.0, 9, 6)
    points[:, 2] = 0.02 * (36 - 4 * points[:, 0] ** 2) * (1 - points[:, 1] ** 2 / 4)
    rim = Support(np.unique(boundary_edges(triangles)))
    roof = Structure(points, {"roof": Membrane(triangles, Fabric(400.0, 0.3), 2.0, warp=(1, 0, 0))}, [rim])
    form = Form(points, {}, np.zeros_like(points), made=roof, force_unit="kN", length_unit="ft")
    seams = [geodesic(roof, (-3, y, 0), (3, y, 0)) for y in (-1, 0, 1)]
    strips = with_copies(cut_strips(form, seams))
    pattern = cutting_pattern(strips, decompensate=["seam 1", 0], transition=0.5)
    before, after = (StressErrors(*np.random.default_rng(3).random(6).tolist()) for _ in range(2))
    pattern = dataclasses.replace(pattern, fit=StressFit(before, after, 7, False, "no step lowers the error"))
    loads = [DistributedLoad((0, 0, 0.1), part=name) for name in strips.names]
    return prove_pattern(pattern, loads, strength={"strip 1": 6.0}, roll_width=1.5, progress=False)


@pytest.fixture
def empty_pictures(monkeypatch):
    """Call for pictures, which are empty files."""
    monkeypatch.setattr(contour_maps, "_draw", lambda subject, panels, look, file, *_: file.touch())
    monkeypatch.setattr(cutting_patterns, "save", lambda figure, file: file.touch())
    for name in ("_draw_roof", "_draw_flat"):
        monkeypatch.setattr(cutting_patterns, name, lambda *_: None)


@pytest.mark.mpi
@pytest.mark.parametrize("kind", ["strips", "pattern", "proof"])
def test_each_bit_comes_back(proof, tmp_path_factory, kind):
    folder = MPI.COMM_WORLD.bcast(str(tmp_path_factory.mktemp("archive")))
    saved = {"strips": proof.pattern.strips, "pattern": proof.pattern, "proof": proof}[kind]
    save_results(saved, f"{folder}/a/saved")
    found = load_results(f"{folder}/a/saved")
    assert type(found) is type(saved)
    assert same(saved, found)
    strips = {"strips": lambda: found, "pattern": lambda: found.strips, "proof": lambda: found.pattern.strips}[kind]()
    assert (strips.force_unit, strips.length_unit) == ("kN", "ft")
    assert strips.copies
    assert strips.mirrored == proof.pattern.strips.mirrored


def test_archive_holds_no_objects_of_python(proof, tmp_path):
    for name in ("one", "two"):
        save_results(proof, tmp_path / name)
    with zipfile.ZipFile(tmp_path / "one") as one, zipfile.ZipFile(tmp_path / "two") as two:
        assert one.namelist() == two.namelist()
        for name in one.namelist():
            assert one.read(name) == two.read(name)
            if name != archive.DOCUMENT:
                with one.open(name) as entry:
                    np.load(entry, allow_pickle=False)


def test_work_goes_on_in_another_process(proof, tmp_path):
    """Tables, files and the proof are the same as those of the pattern that was saved."""
    pytest.importorskip("shapely")
    save_results(proof, tmp_path / "saved")
    script = (
        "import sys\n"
        "from fx_membrane import load_results, prove_pattern, write_patterns\n"
        "proof = load_results('saved')\n"
        "write_patterns(proof.pattern, 'again.csv')\n"
        "write_patterns(proof.pattern, 'again.svg')\n"
        "anew = prove_pattern(proof.pattern, proof.loads, roll_width=proof.roll_width, progress=False)\n"
        "print(anew.shift.max() - proof.shift.max())\n"
        "print(proof)\n"
    )
    command = [sys.executable, "-c", script]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    difference, table = told.split("\n", 1)
    assert abs(float(difference)) < 1e-10
    assert table.strip() == str(proof).strip()
    for ending in ("csv", "svg"):
        write_patterns(proof.pattern, tmp_path / f"here.{ending}")
        assert (tmp_path / f"here.{ending}").read_bytes() == (tmp_path / f"again.{ending}").read_bytes()


def test_units_of_the_form_are_those_of_tables_and_files(proof, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    pytest.importorskip("shapely")
    assert "largest shift" in str(proof)
    assert "stress [kN/ft]" in str(proof)
    write_patterns(proof.pattern, tmp_path / "roof.dxf")
    lines = ezdxf.readfile(tmp_path / "roof.dxf").modelspace().query("LWPOLYLINE[layer=='sew']")
    x = np.array(lines[0].get_points("xy"))[:, 0]
    assert np.ptp(x) == pytest.approx(304.8 * proof.pattern.cloth["strip 1"].length)


def test_report_takes_the_archive_of_a_proof(proof, tmp_path, empty_pictures):
    pytest.importorskip("jinja2")
    save_results(proof, tmp_path / "proof.fxm")
    save_results(proof.pattern, tmp_path / "pattern.fxm")
    results = assembly(proof)
    write_report(results, tmp_path / "roof.html", pictures=False, patterns=tmp_path / "proof.fxm")
    assert "The cloth of 4 strips, sewn together" in (tmp_path / "roof.html").read_text()
    write_report(results, tmp_path / "drawn.html", patterns=proof)  # a proof has no folder with pictures
    drawn = (tmp_path / "drawn.html").read_text()
    assert ('alt="Stress error after assembly"' in drawn) is (not obstacle())
    assert "Utilisation" in drawn
    with pytest.raises(ValueError, match=r"pattern\.fxm holds a cutting pattern without a proof"):
        write_report(results, tmp_path / "roof.html", pictures=False, patterns=tmp_path / "pattern.fxm")
    with pytest.raises(ValueError, match=r"nothing.*no archive of a proof and no folder with proof\.json"):
        write_report(results, tmp_path / "roof.html", pictures=False, patterns=tmp_path / "nothing")


@pytest.mark.mpi
def test_chapter_is_drawn_by_one_process(proof, tmp_path_factory, empty_pictures):
    """Pictures within a report are no collective call of their own: messages of the next call would be taken for it."""
    pytest.importorskip("jinja2")
    folder = MPI.COMM_WORLD.bcast(str(tmp_path_factory.mktemp("report")))
    write_report(assembly(proof), f"{folder}/roof.html", patterns=proof)
    assert Path(f"{folder}/roof.html").exists()
    with pytest.raises(ValueError, match="folder"):
        save_results(proof, folder)
