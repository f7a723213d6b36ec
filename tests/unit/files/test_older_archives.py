"""Archives of an earlier format lack quantities: they are left out of every file, report, picture and scene."""

import json
import zipfile

import numpy as np
import pytest

from by_command import leave_out_pictures
from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    Rope,
    Stage,
    Structure,
    Support,
    boundary_edges,
    load_results,
    rectangle,
    report,
    save_results,
    to_dolfinx,
    write_paraview,
    write_report,
    write_scene,
    write_tables,
)
from fx_membrane.files import archive

LACKING = ("warp_weft_stress", "cauchy_projected")


@pytest.fixture(scope="module")
def older(tmp_path_factory):
    """Results from an archive whose membranes lack quantities."""
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    parts = {
        "roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3),
        "edge": Cable([[0, 1], [1, 2]], 1e6, 1e3),
        "rope": Rope([3, 4, 5], 1e6, 1e3),
    }
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    folder = tmp_path_factory.mktemp("older")
    save_results(Analysis(structure, progress=False).run([Stage("rest")]), folder / "new")
    with zipfile.ZipFile(folder / "new") as new, zipfile.ZipFile(folder / "old", "w") as old:
        for name in new.namelist():
            content: bytes | str = new.read(name)
            if name == archive.DOCUMENT:
                document = json.loads(content) | {"format": archive.FORMAT - 1}
                for entry in document["objects"]:
                    if entry["class"] == "MembraneResult":
                        entry["fields"] = {key: code for key, code in entry["fields"].items() if key not in LACKING}
                content = json.dumps(document)
            old.writestr(name, content)
    return load_results(folder / "old")


def scene(results, folder):
    pytest.importorskip("plotly")
    write_scene(results, folder / "roof.html")
    return (folder / "roof.html").read_text()


def page(results, folder):
    pytest.importorskip("jinja2")
    write_report(results, folder / "roof.html")
    return (folder / "roof.html").read_text()


def paraview(results, folder):
    pytest.importorskip("pyvista")
    write_paraview(results, folder)
    return "".join(path.read_text() for path in folder.rglob("*.vtu"))


def frame(results, folder):
    pytest.importorskip("pandas")
    return " ".join(results["rest"].to_dataframe("roof").columns)


def tables(results, folder):
    write_tables(results, folder)
    return (folder / "membranes.csv").read_text()


def functions(results, folder):
    return " ".join(name for part in ("roof", "edge", "rope") for name in to_dolfinx(results["rest"], part).cells)


@pytest.mark.parametrize(
    ("write", "kept"),
    [
        (tables, "principal stress I"),
        (paraview, "principal stress I"),
        (scene, "principal stress I"),
        (page, "principal stress I"),
        (frame, "principal stress I"),
        (functions, "principal"),
        (lambda results, folder: report(results["rest"]), "principal stress I"),
        (lambda results, folder: results["rest"].parts["roof"]._repr_html_(), "principal stress I"),
    ],
    ids=["tables", "paraview", "scene", "report", "dataframe", "dolfinx", "text", "notebook"],
)
def test_what_an_archive_lacks_is_left_out(older, write, kept, tmp_path, monkeypatch):
    leave_out_pictures(monkeypatch)
    assert older["rest"].parts["roof"].warp_weft_stress is None
    text = write(older, tmp_path)
    assert kept in text
    assert not any(words in text for words in ("stress along", *LACKING))


def test_states_of_unlike_archives_fill_one_table(older, tmp_path):
    structure = older["rest"].structure
    newer = Analysis(structure, progress=False).run([Stage("new")])
    newer["old"] = older["rest"]
    write_tables(newer, tmp_path)
    rows = [line.split(",") for line in (tmp_path / "membranes.csv").read_text().splitlines()]
    assert len({len(row) for row in rows}) == 1
    assert [value for head, value in zip(rows[0], rows[-1], strict=True) if "along" in head] == ["", ""]
