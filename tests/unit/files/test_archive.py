"""Archives of results: what comes back, what is refused, and what stays when writing fails."""

import dataclasses
import errno
import json
import random
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from mpi4py import MPI
from ufl import inner, tr

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    load_results,
    polyline,
    rectangle,
    report,
    save_results,
    stability,
    updated_reference,
)
from fx_membrane.files import archive
from models import HEAD, POINTS, masted_roof
from same_data import same


@pytest.fixture(scope="module")
def results():
    structure = masted_roof(
        ("roof", "edge", 'mäst, "=1"'),
        foot="xy",
        edge_prestress=np.linspace(1e2, 2e2, 16),
        separate=[("roof", "edge")],
        material=OrthotropicFabric(6e5, 4e5, 0.3, 2e4),
        warp=(1, 0.2, 0),
        mass=1.0,
    )
    lift = Stage("lift", displacements=[PrescribedDisplacement(len(POINTS), (0, 0, 0.01))])
    loads = [Pressure(50.0, "roof", cells=[0, 3]), PointLoad(HEAD, (0, 0, -5))]
    return Analysis(structure).run([lift, Stage("wind", loads, after="lift", increments=2)])


def test_everything_comes_back_to_the_last_bit(results, tmp_path):
    save_results(results, tmp_path / "a" / "roof.fxm")
    found = load_results(tmp_path / "a" / "roof.fxm")
    assert list(found) == ["lift", "wind"]
    assert same(dict(results), dict(found))
    assert same(results.stages, found.stages)
    assert found["lift"].structure is found["wind"].structure
    assert [remark.category for remark in found["wind"].remarks] == [
        remark.category for remark in results["wind"].remarks
    ]
    assert not list(tmp_path.rglob("*.part"))


def test_states_of_an_archive_go_on(results, tmp_path):
    save_results(results, tmp_path / "roof")
    state = load_results(tmp_path / "roof")["wind"]
    assert report(state) == report(results["wind"])
    assert np.allclose(stability(state, count=1).stiffnesses, stability(results["wind"], count=1).stiffnesses)


def test_archive_is_opened_in_another_process(results, tmp_path):
    save_results(results, tmp_path / "roof")
    script = (
        f"from fx_membrane import load_results, report; print(report(load_results({str(tmp_path / 'roof')!r})['wind']))"
    )
    shown = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert shown.strip() == report(results["wind"]).strip()


def test_remarks_keep_their_kind(tmp_path):
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    rim = np.unique(boundary_edges(triangles))
    structure = Structure(points, {"roof": Membrane(triangles, Fabric(1e3, 0.3), 1.0)}, [Support(rim)])
    found = Analysis(structure).run([Stage("gale", [PointLoad(4, (0, 0, -900.0))])])
    assert found["gale"].remarks
    save_results(found, tmp_path / "x")
    again = load_results(tmp_path / "x")["gale"].remarks
    assert [(str(one), one.category) for one in again] == [(str(one), one.category) for one in found["gale"].remarks]


def test_form(tmp_path):
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = points[:, 0] * points[:, 1]
    rim = np.unique(boundary_edges(triangles))
    form = updated_reference(Structure(points, {"film": Membrane(triangles, Fabric(4e5, 0.3), 2e3)}, [Support(rim)]))
    form = dataclasses.replace(form, force_unit="kN", length_unit="ft")
    save_results(form, tmp_path / "form")
    again = load_results(tmp_path / "form")
    assert same(form, again)
    assert (again.force_unit, again.length_unit) == ("kN", "ft")
    changed(
        tmp_path / "form", lambda document: [without("Form", f"{kind}_unit")(document) for kind in ("force", "length")]
    )
    again = load_results(tmp_path / "form")  # of a version without them
    assert (again.force_unit, again.length_unit) == ("N", "m")


@dataclasses.dataclass(frozen=True)
class Foam:
    stiffness: float

    def energy(self, E, sigma0, parameters):
        return inner(sigma0, E) + parameters.stiffness * (inner(E, E) + tr(E) ** 2) / 2  # compiled as that of Foil


def test_own_law_needs_its_class(tmp_path):
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    rim = np.unique(boundary_edges(triangles))
    structure = Structure(points, {"roof": Membrane(triangles, Foam(1e3), 10.0)}, [Support(rim)])
    found = Analysis(structure).run([Stage("rest")])
    save_results(found, tmp_path / "x")
    with pytest.raises(
        ValueError, match=r"x holds objects of classes that no.*Foam: import.*load_results\(path, classes=\[Foam\]\)"
    ):
        load_results(tmp_path / "x")
    other = dataclasses.make_dataclass("Foam", ["k"], frozen=True)
    with pytest.raises(ValueError, match="a field 'stiffness', which the Foam of this program does not have"):
        load_results(tmp_path / "x", classes=[other])
    picky = dataclasses.make_dataclass("Foam", ["stiffness"], namespace={"__post_init__": lambda self: 1 / 0})
    with pytest.raises(ValueError, match="its Foam is refused: division by zero"):
        load_results(tmp_path / "x", classes=[picky])
    assert load_results(tmp_path / "x", classes=[Foam])["rest"].structure.parts["roof"].material == Foam(1e3)
    with pytest.raises(ValueError, match="Fabric"):
        load_results(tmp_path / "x", classes=[Fabric])


def test_full_disk_keeps_the_earlier_archive(results, tmp_path, monkeypatch):
    save_results(results, tmp_path / "roof")
    before = (tmp_path / "roof").read_bytes()

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "save", full)
    with pytest.raises(ValueError, match="No space left"):
        save_results(results, tmp_path / "roof")
    assert (tmp_path / "roof").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["roof"]


def changed(path, change):
    """Rewrite the document of an archive."""
    with zipfile.ZipFile(path) as old:
        entries = {name: old.read(name) for name in old.namelist()}
    document = json.loads(entries[archive.DOCUMENT])
    change(document)
    entries[archive.DOCUMENT] = json.dumps(document).encode()
    with zipfile.ZipFile(path, "w") as new:
        for name, content in entries.items():
            new.writestr(name, content)


def entries_of(document, name):
    found = [entry["fields"] for entry in document["objects"] if entry["class"] == name]
    assert found
    return found


def without(name, field):
    """Change of a document: a class without a field."""
    return lambda document: [entry.pop(field) for entry in entries_of(document, name)]


@pytest.mark.parametrize(
    ("change", "absent"),
    [
        (lambda document: document["content"].pop("names"), lambda state: None),
        (without("MembraneResult", "warp_weft_stress"), lambda state: state.membrane("roof").warp_weft_stress),
        (without("BarResult", "slack"), lambda state: state.cable("edge").slack),
        (without("Equilibrium", "unbalanced"), lambda state: state.equilibrium.unbalanced),
        (without("StageResult", "terms"), lambda state: state.terms or None),
        (without("Increment", "fallen"), lambda state: state.increments[0].fallen or None),
    ],
)
def test_archive_of_an_earlier_format(results, tmp_path, change, absent):
    save_results(results, tmp_path / "roof")
    changed(tmp_path / "roof", lambda document: (document.update(format=1), change(document)))
    found = load_results(tmp_path / "roof")
    assert absent(found["wind"]) is None
    assert np.array_equal(found["wind"].displacement, results["wind"].displacement)
    assert same(found["wind"].structure, results["wind"].structure)


def test_file_that_cannot_be_understood_names_its_format(results, tmp_path):
    def spoilt(change):
        save_results(results, tmp_path / "roof")
        changed(tmp_path / "roof", lambda document: (document.update(format=1), change(document)))
        return pytest.raises(
            ValueError, match=rf"field.*\(format 1, by fx_membrane .*reads formats 1 to {archive.FORMAT}\)\.$"
        )

    with spoilt(without("Membrane", "cells")):
        load_results(tmp_path / "roof")
    with spoilt(lambda document: [entry.update(steps=2) for entry in entries_of(document, "Stage")]):
        load_results(tmp_path / "roof")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda path: path.unlink(), "does not exist"),
        (lambda path: path.write_bytes(b""), "no archive"),
        (lambda path: path.write_bytes(b"\x80\x04pickle" * 9), "no archive"),
        (lambda path: path.write_bytes(path.read_bytes()[:-200]), "no archive"),
        (lambda path: path.write_bytes(path.read_bytes()[:3000] + b"x" * 50 + path.read_bytes()[3050:]), "no archive"),
        (lambda path: changed(path, lambda document: document.update(kind="other")), "no archive"),
        (
            lambda path: changed(path, lambda document: document.update(format=99)),
            rf"archive of results of a later version \(format 99, .* 1 to {archive.FORMAT}\): install a newer one",
        ),
        (lambda path: changed(path, lambda document: document.update(format="x")), "archive"),
        (
            lambda path: (
                changed(path, lambda document: document.update(versions=None))
                or changed(path, lambda d: d.update(format=99))
            ),
            "archive",
        ),
        (lambda path: changed(path, lambda document: document["objects"][0].update({"class": "Popen"})), "Popen"),
        (lambda path: changed(path, lambda document: document.pop("objects")), "no archive"),
        (lambda path: changed(path, lambda document: document["objects"].reverse()), "no archive"),
    ],
)
def test_spoilt_archive_is_refused(results, tmp_path, spoil, words):
    save_results(results, tmp_path / "roof")
    spoil(tmp_path / "roof")
    with pytest.raises(ValueError, match=words):
        load_results(tmp_path / "roof")


def test_bad_arguments(results, tmp_path):
    with pytest.raises(ValueError, match="StageResults or Form"):
        save_results(results["wind"], tmp_path / "x")
    with pytest.raises(ValueError, match="folder"):
        save_results(results, tmp_path)
    with pytest.raises(ValueError, match="zero bytes"):
        load_results("")


@pytest.mark.mpi
def test_on_several_processes(results, tmp_path_factory):
    folder = MPI.COMM_WORLD.bcast(str(tmp_path_factory.mktemp("archive")))
    save_results(results, f"{folder}/roof")
    assert same(dict(results), dict(load_results(f"{folder}/roof")))
    with pytest.raises(ValueError, match="folder"):
        save_results(results, folder)


def test_flipped_bits_are_told_or_harmless(tmp_path):
    """The arrays and the document have check sums; names and sizes of the zip file are compared."""
    points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
    rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
    save_results(Analysis(rope).run([Stage("rest")]), tmp_path / "a")
    content, expected = (tmp_path / "a").read_bytes(), load_results(tmp_path / "a")["rest"]
    draw, refused = random.Random(3), 0
    for _ in range(400):
        flipped, place = bytearray(content), draw.randrange(len(content))
        flipped[place] ^= 1 << draw.randrange(8)
        (tmp_path / "b").write_bytes(flipped)
        try:
            found = load_results(tmp_path / "b")["rest"]
        except ValueError:
            refused += 1
            continue
        assert np.array_equal(found.displacement, expected.displacement)
        assert np.array_equal(found.cable("rope").force, expected.cable("rope").force)
    assert refused > 200
