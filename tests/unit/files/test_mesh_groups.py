"""Groups of mesh files: names, points and supports that are kept, and what is left out or damaged, which is told."""

import numpy as np
import pytest

from fx_membrane import Structure, Support, structure_from_file, write_mesh
from fx_membrane.files.conversion import convert
from fx_membrane.files.mesh_files import drawing_of
from square_roofs import PARTS, POINTS, RIM, TRIANGLES

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n"
)
membrane, cable = PARTS["Dach süd"], PARTS["edge"]


def test_faces_of_obj_are_in_all_groups_of_their_line(tmp_path):
    (tmp_path / "a.obj").write_text(f"{SQUARE}g roof wall\nf 1 2 3\ng roof\nf 1 3 4\n")
    for names, counts in ({"roof": 2}, {"roof": 2}), ({"wall": 1}, {"wall": 1}), ({"roof wall": 1}, {"roof wall": 1}):
        found = structure_from_file(tmp_path / "a.obj", dict.fromkeys(names, membrane))
        assert {name: len(part.cells) for name, part in found.parts.items()} == counts
    convert(tmp_path / "a.obj", tmp_path / "b.obj")
    assert drawing_of(tmp_path / "b.obj", None, None).names == ["roof", "wall"]
    with pytest.raises(ValueError, match=r"it has \['roof', 'wall'\]"):
        structure_from_file(tmp_path / "a.obj", {"floor": membrane})


def test_name_with_spaces_whose_words_are_no_groups_is_one_group(tmp_path):
    (tmp_path / "a.obj").write_text(f"{SQUARE}g south roof\nf 1 2 3\nf 1 3 4\n")
    convert(tmp_path / "a.obj", tmp_path / "b.obj")
    assert drawing_of(tmp_path / "b.obj", None, None).names == ["south roof"]


@pytest.mark.parametrize("names", [("ring of the fabric", "fabric"), ("fabric #1", "edge # 2"), ("g", "o p")])
def test_names_of_own_obj_come_back(names, tmp_path):
    first, second = names
    write_mesh(Structure(POINTS, {first: membrane(TRIANGLES), second: cable(RIM)}), tmp_path / "a.obj")
    found = structure_from_file(tmp_path / "a.obj", {first: membrane, second: cable})
    assert np.array_equal(found.parts[first].cells, TRIANGLES)
    assert np.array_equal(found.parts[second].cells, RIM)


@pytest.mark.parametrize("name", ["a  b", " a", "a ", "a\\"])
def test_names_that_obj_cannot_have_are_refused(name, tmp_path):
    with pytest.raises(ValueError, match="obj files cannot have; name it otherwise"):
        write_mesh(Structure(POINTS, {name: membrane(TRIANGLES)}), tmp_path / "a.obj")
    assert not (tmp_path / "a.obj").exists()


@pytest.mark.parametrize("ending", ["obj", "msh", "dxf"])
def test_points_are_converted_too(ending, tmp_path):
    if ending == "dxf":
        pytest.importorskip("ezdxf")
    (tmp_path / "a.obj").write_text(f"{SQUARE}o roof\nf 1 2 3\nf 1 3 4\no feet\np 1 3\n")
    convert(tmp_path / "a.obj", tmp_path / f"b.{ending}")
    found = structure_from_file(tmp_path / f"b.{ending}", {"roof": membrane}, {"feet": "xy"})
    held = found.points[found.supported.any(axis=1)]
    assert sorted(held.tolist()) == [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]


def test_dxf_keeps_the_components_of_supports(tmp_path):
    pytest.importorskip("ezdxf")
    edge = np.unique(RIM)
    supports = [Support(edge[:3], "xy"), Support(edge[2:4], "z"), Support(edge[4:6])]
    roof = Structure(POINTS, {"Dach süd": membrane(TRIANGLES)}, supports)
    write_mesh(roof, tmp_path / "a.dxf")
    layers = {"supports": "xyz", "supports xy": "xy", "supports z": "z"}
    found = structure_from_file(tmp_path / "a.dxf", {"Dach süd": membrane}, layers)
    for axes in np.eye(3, dtype=bool):
        assert sorted(found.points[found.supported[:, axes].all(axis=1)].tolist()) == sorted(
            POINTS[roof.supported[:, axes].all(axis=1)].tolist()
        )


def test_file_is_not_converted_to_itself(tmp_path):
    (tmp_path / "a.obj").write_text(SQUARE + "f 1 2 3\n")
    (tmp_path / "b.obj").symlink_to(tmp_path / "a.obj")
    for target in (tmp_path / "a.obj", tmp_path / "b.obj", tmp_path / "." / "a.obj"):
        with pytest.raises(ValueError, match="is the file to convert"):
            convert(tmp_path / "a.obj", target)
    assert (tmp_path / "a.obj").read_text() == SQUARE + "f 1 2 3\n"


def test_entities_left_out_of_a_conversion_are_told(tmp_path, capfd):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=6)
    space = document.modelspace()
    for height in (1, 2):
        space.add_text("Plan", height=height)
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(ValueError, match=r"no faces, lines or points, only 2 TEXT"):
        convert(tmp_path / "a.dxf", tmp_path / "a.obj")
    space.add_3dface([(0, 0, 0), (1, 0, 0), (0, 1, 0)], dxfattribs={"layer": "roof"})
    document.saveas(tmp_path / "a.dxf")
    capfd.readouterr()
    convert(tmp_path / "a.dxf", tmp_path / "a.obj")
    assert "2 TEXT left out" in capfd.readouterr().err
    space.delete_all_entities()
    space.add_circle((0, 0), 1, dxfattribs={"layer": "ring"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(ValueError, match="nothing that can be converted"):
        convert(tmp_path / "a.dxf", tmp_path / "none.obj")
    assert not (tmp_path / "none.obj").exists()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "has no faces, lines or points"),
        (SQUARE, "has no faces, lines or points"),
        (SQUARE + "f 1 2 3\nf 1 3 3\n", r"a\.obj:6: 'f 1 3 3'.*same corner twice"),
        (SQUARE + "v 2 0 0\nf 1 2 3\nf 1 2 5\n", r"a\.obj:7: 'f 1 2 5' is a face without area"),
    ],
)
def test_faults_of_obj_have_their_line(text, words, tmp_path):
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(ValueError, match=words):
        structure_from_file(tmp_path / "a.obj", {"default": membrane})
    with pytest.raises(ValueError, match=words):
        convert(tmp_path / "a.obj", tmp_path / "b.obj")


def test_unit_of_a_file_without_one_is_told(tmp_path, capfd):
    write_mesh(Structure(POINTS, {"roof": membrane(TRIANGLES)}), tmp_path / "a.obj")
    structure_from_file(tmp_path / "a.obj", {"roof": membrane})
    assert "unit" not in capfd.readouterr().err
    structure_from_file(tmp_path / "a.obj", {"roof": membrane}, unit="mm")
    assert "a.obj names no unit of length; its numbers are taken in mm.\n" in capfd.readouterr().err


def test_ply_that_ends_too_early_is_refused(tmp_path):
    pytest.importorskip("pyvista")
    for length in (len(PLY) - 3, len(PLY) - 9, PLY.index("1 1 0")):
        (tmp_path / "a.ply").write_text(PLY[:length])
        with pytest.raises(ValueError, match=r"ends too early.*4 vertices and 2 faces"):
            structure_from_file(tmp_path / "a.ply", {"a": membrane})
    (tmp_path / "a.ply").write_text(PLY)
    assert len(structure_from_file(tmp_path / "a.ply", {"a": membrane}).parts["a"].cells) == 2
