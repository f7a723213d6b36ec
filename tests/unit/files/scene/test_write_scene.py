"""Scenes as files: one page that asks for nothing, names that are no markup, and the numbers of NumPy inside."""

import base64
import json
import re
import sys
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    StageResults,
    Structure,
    Support,
    force_density,
    load_results,
    rectangle,
    save_results,
    updated_reference,
    write_scene,
)
from fx_membrane.files.scene import scene_data
from fx_membrane.files.scene.coarsening import coarser
from scene_models import EVIL, results, roof

pytest.importorskip("plotly")
STATES = ["taut", "wrinkled", "slack"]


@pytest.fixture(scope="module")
def found():
    return results()


class Page(HTMLParser):
    """Tags, addresses, scripts and texts of a page."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.addresses, self.scripts, self.title, self._open = [], [], [], "", []
        self.policy = ""
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self._open.append(tag)
        self.tags.append(tag)
        self.addresses += [value for name, value in attributes if name in ("src", "href", "action", "data")]
        if tag == "meta" and dict(attributes).get("http-equiv") == "Content-Security-Policy":
            self.policy = dict(attributes)["content"]

    def handle_data(self, data):
        if self._open and self._open[-1] == "script":
            self.scripts.append(data)
        if self._open and self._open[-1] == "title":
            self.title += data

    def handle_endtag(self, tag):
        while self._open and self._open.pop() != tag:
            pass


def opened(path):
    """Page of a file, and the data in it."""
    page = Page(path.read_text(encoding="utf-8"))
    return page, json.loads(page.scripts[0])


def numbers(text, kind="<f4"):
    return np.frombuffer(base64.b64decode(text), kind)


def entry(scene, stage, name):
    """Field of a stage, with its unit."""
    at = [field["name"] for field in scene["fields"]].index(name)
    return scene["stages"][stage]["fields"][at], scene["fields"][at]["unit"]


def test_page_asks_for_nothing_and_names_are_no_markup(found, tmp_path):
    write_scene(found, tmp_path / "new" / "scene.html", title=f"Roof {EVIL}")
    page, scene = opened(tmp_path / "new" / "scene.html")
    assert page.title == f"Roof {EVIL}"
    assert "img" not in page.tags
    assert page.tags.count("script") == 3
    assert page.addresses == ["data:,"]
    assert "default-src 'none'" in page.policy
    assert "connect-src" not in page.policy
    assert [part["name"] for part in scene["parts"]] == list(found["snow"].structure.parts)
    assert [stage["name"] for stage in scene["stages"]] == list(found)


def test_arrays_are_those_of_numpy(found, tmp_path):
    write_scene(found, tmp_path / "scene.html", force_unit="kN")
    _, scene = opened(tmp_path / "scene.html")
    structure = found["snow"].structure
    points = numbers(scene["points"]).reshape(-1, 3) + scene["origin"]
    np.testing.assert_allclose(points, structure.points, atol=1e-6)
    for part in scene["parts"]:
        cells = numbers(part["cells"], "<i4").reshape(len(structure.parts[part["name"]].cells), -1)
        np.testing.assert_array_equal(cells, structure.parts[part["name"]].cells)
    for number, state in enumerate(found.values()):
        moved = numbers(scene["stages"][number]["displacement"]).reshape(-1, 3)
        np.testing.assert_array_equal(moved, state.displacement.astype(np.float32))
        membrane = state.membrane(EVIL)
        expected = {
            "principal stress I": {EVIL: membrane.principal[:, 0]},
            "principal stress II": {EVIL: membrane.principal[:, 1]},
            "stress along warp": {EVIL: membrane.warp_weft_stress[:, 0]},
            "strain shear": {EVIL: membrane.strain[:, 0, 1]},
            "force": {name: part.force for name, part in state.parts.items() if part.dimension == 1},
        }
        for name, values in expected.items():
            told, unit = entry(scene, number, name)
            assert unit == {"force": "kN", "strain shear": "-"}.get(name, "kN/m")
            assert list(told["values"]) == list(values)
            for part, array in values.items():
                np.testing.assert_array_equal(numbers(told["values"][part]), array.astype(np.float32))
            joined = np.concatenate(list(values.values()))
            assert (told["least"], told["largest"]) == (joined.min(), joined.max())
        told, unit = entry(scene, number, "displacement")
        size = np.linalg.norm(state.displacement, axis=1)
        assert (told["least"], told["largest"], unit) == (size.min(), size.max(), "m")
        told, _ = entry(scene, number, "state")
        assert [STATES[row] for row in numbers(told["values"][EVIL], "u1")] == membrane.state.tolist()
        assert told["counts"][1] == (membrane.state == "wrinkled").sum()
    assert told["counts"][1] > 0


def test_size_is_that_of_the_numbers(tmp_path):
    """More cells add four bytes for each number, in base64: corners, cell number and four stresses of a cell."""
    lengths, bytes_ = [], []
    for columns, rows in [(8, 6), (32, 24)]:
        structure = roof(columns, rows)
        write_scene(structure, tmp_path / "scene.html")
        page, _ = opened(tmp_path / "scene.html")
        lengths.append(len(page.scripts[0]))
        cells = [len(part.cells) * (8 if part.dimension == 2 else 4) for part in structure.parts.values()]
        bytes_.append(4 * (sum(cells) + 5 * len(structure.points)))
    assert np.diff(lengths) < 4 / 3 * np.diff(bytes_) + 100


def test_archive_gives_the_same_page(found, tmp_path):
    save_results(found, tmp_path / "results.fxm")
    write_scene(found, tmp_path / "one.html")
    write_scene(load_results(tmp_path / "results.fxm"), tmp_path / "other.html")
    assert (tmp_path / "one.html").read_bytes() == (tmp_path / "other.html").read_bytes()


def test_units_and_title_are_those_of_the_results(found, tmp_path):
    named = StageResults(found)
    named.title, named.force_unit, named.length_unit = "Roof", "kip", "ft"
    write_scene(named, tmp_path / "scene.html")
    page, scene = opened(tmp_path / "scene.html")
    assert page.title == "Roof"
    assert {field["unit"] for field in scene["fields"]} == {"", "-", "ft", "kip", "kip/ft"}


def test_forms_structures_and_single_stages(found, tmp_path):
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 1)
    points[corners[:2], 2] = 0.5
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1)
    flat = Structure(points, {"film": Membrane(triangles, Fabric(6e5, 0.3), 2e3)}, [Support(rim)])
    form = updated_reference(flat)
    for shown, name in [(form, "form"), (form.structure, "structure"), (flat, "structure")]:
        write_scene(shown, tmp_path / "scene.html")
        _, scene = opened(tmp_path / "scene.html")
        assert [stage["name"] for stage in scene["stages"]] == [name]
        assert scene["stages"][0]["displacement"] is None
        told, _ = entry(scene, 0, "principal stress I")
        values = form.structure.parts["film"].prestress_tensors() if shown is not flat else 2e3 * np.eye(2)[None]
        assert told["largest"] == pytest.approx(np.linalg.eigvalsh(values).max(), rel=1e-12)
    write_scene(replace(form, force_unit="kN", length_unit="ft"), tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    assert (scene["force"], scene["length"]) == ("kN", "ft")
    write_scene(found["snow"], tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    assert [stage["name"] for stage in scene["stages"]] == ["snow"]


def test_structure_far_from_zero_keeps_its_shape(tmp_path):
    """Coordinates of a survey: float32 alone would round them to half a metre."""
    away = np.array([4.5e6, 5.3e6, 300.0])
    structure = roof(away=away)
    write_scene(structure, tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    points = numbers(scene["points"]).reshape(-1, 3) + (np.array(scene["origin"]) - away)
    np.testing.assert_allclose(points, roof().points, atol=1e-5)


def test_more_triangles_than_a_browser_turns_are_drawn_coarser(found, tmp_path, monkeypatch):
    monkeypatch.setattr(scene_data, "MAX_TRIANGLES", 40)
    write_scene(found, tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    membrane = found["snow"].membrane(EVIL)
    drawn = numbers(scene["parts"][0]["numbers"], "<i4")
    assert 10 < len(drawn) <= 40
    assert f"{len(drawn)} of {len(membrane.state)} triangles" in scene["coarse"]
    told, _ = entry(scene, 1, "principal stress I")
    assert told["largest"] == membrane.principal[:, 0].max()
    np.testing.assert_array_equal(numbers(told["values"][EVIL]), membrane.principal[drawn, 0].astype(np.float32))


def test_coarser_surface_covers_the_same_area():
    points, triangles = rectangle(4.0, 2.0, 80, 40)
    kept, corners = coarser(points, {"sheet": triangles}, 1000)["sheet"]
    assert 300 < len(kept) <= 1000
    sides = points[corners[:, 1:]] - points[corners[:, :1]]
    assert np.abs(np.cross(sides[:, 0], sides[:, 1])).sum() / 2 == pytest.approx(8.0, rel=0.15)


def test_refusals(found, tmp_path):
    for path in (tmp_path / "scene.txt", tmp_path):
        with pytest.raises(ValueError, match=r"\.html"):
            write_scene(found, path)
    with pytest.raises(ValueError, match="no stage"):
        write_scene(StageResults(), tmp_path / "scene.html")
    with pytest.raises(ValueError, match=r"stiffness.*Structure"):
        write_scene(force_density([(0, 0, 0), (1, 0, 0)], [(0, 1)], 1.0, [Support([0, 1])]), tmp_path / "scene.html")
    finer = StageResults(found | {"finer": results(roof(10, 6))["snow"]})
    with pytest.raises(ValueError, match="different structures"):
        write_scene(finer, tmp_path / "scene.html")
    assert list(tmp_path.iterdir()) == []


def test_missing_plotly_is_one_sentence_and_an_earlier_page_stays(found, tmp_path, monkeypatch):
    (tmp_path / "scene.html").write_text("earlier")
    monkeypatch.setitem(sys.modules, "plotly.offline", None)
    with pytest.raises(ImportError, match=r"^A scene needs the package plotly: pip install 'fx-membrane\[scene\]'\.$"):
        write_scene(found, tmp_path / "scene.html")
    assert (tmp_path / "scene.html").read_text() == "earlier"


def test_library_and_policy_need_no_address(found, tmp_path):
    """Outside the library, which has addresses of maps in its texts, no address is in the page."""
    write_scene(found, tmp_path / "scene.html")
    page, _ = opened(tmp_path / "scene.html")
    text = (tmp_path / "scene.html").read_text(encoding="utf-8").replace(page.scripts[1], "")
    assert not re.search(r"https?:|//[a-z]+\.", text)


@pytest.mark.mpi
def test_first_process_writes(tmp_path_factory):
    folder = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("scene"))
    rope = Structure([(0, 0, 0), (1, 0, 0), (2, 0, 0)], {"rope": Cable([(0, 1), (1, 2)], 1e6, 10.0)}, [Support([0, 2])])
    write_scene(rope, folder / "scene.html")
    MPI.COMM_WORLD.Barrier()
    assert (folder / "scene.html").exists()


def test_stage_names_are_those_of_the_dictionary(found, tmp_path):
    """Stages that a user has renamed keep the new names."""
    write_scene(StageResults({"winter": found["snow"]}), tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    assert scene["stages"][0]["name"] == "winter"


def test_values_that_are_no_numbers_have_no_extremes(found, tmp_path):
    """As in the start of a solve that failed."""
    state = found["snow"]
    fabric = state.membrane(EVIL)
    principal = fabric.principal.copy()
    principal[3] = np.nan
    none = np.full_like(state.displacement, np.nan)
    parts = {**state.parts, EVIL: replace(fabric, principal=principal, strain=np.full_like(fabric.strain, np.nan))}
    write_scene(replace(state, parts=parts, displacement=none, loads=none), tmp_path / "scene.html")
    _, scene = opened(tmp_path / "scene.html")
    for name in ("displacement", "strain warp"):
        assert entry(scene, 0, name)[0]["least"] is None
    assert entry(scene, 0, "principal stress I")[0]["largest"] == np.nanmax(principal[:, 0])


def test_units_may_be_empty_or_have_brackets(found, tmp_path):
    write_scene(found, tmp_path / "scene.html", force_unit="", length_unit="m [x]")
    _, scene = opened(tmp_path / "scene.html")
    told, unit = entry(scene, 1, "force")
    assert (unit, told["largest"]) == ("", max(found["snow"].cable(name).force.max() for name in ("cable", "stay")))
    told, unit = entry(scene, 1, "principal stress I")
    assert (unit, told["largest"]) == ("/m [x]", found["snow"].membrane(EVIL).principal[:, 0].max())
