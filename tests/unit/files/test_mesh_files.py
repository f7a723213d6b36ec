"""Structures from DXF, OBJ, STL, PLY and msh files, and meshes that are written and read back."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    OrthotropicFabric,
    Pressure,
    Stage,
    Structure,
    structure_from_file,
    write_mesh,
)
from fx_membrane.files import mesh_files
from fx_membrane.files.drawing import Drawing
from square_roofs import PARTS, POINTS, TRIANGLES, roof


def in_space(structure):
    """Cells of each part as sorted corners in space, independent of the numbers of nodes."""
    return {
        name: np.array(
            sorted(np.sort(structure.points[part.cells].round(12), axis=1).reshape(len(part.cells), -1).tolist())
        )
        for name, part in structure.parts.items()
    }


def assert_same_cells(one, other, tolerance=0.0):
    assert one.parts.keys() == other.parts.keys()
    for name, cells in in_space(one).items():
        assert np.allclose(cells, in_space(other)[name], rtol=0, atol=tolerance)


@pytest.mark.parametrize("ending", ["msh", "obj", "dxf"])
def test_mesh_comes_back(ending, tmp_path):
    if ending == "dxf":
        pytest.importorskip("ezdxf")
    state = Analysis(roof()).run([Stage("air", [Pressure(50.0, "Dach süd")])])["air"]
    supports = {"msh": {"support 0 xyz": "xyz"}, "dxf": {"supports": "xyz"}, "obj": {"edge": "xyz"}}[ending]
    file = tmp_path / "new" / f"roof.{ending}"
    write_mesh(state, file)
    found = structure_from_file(file, PARTS, supports)
    deformed = Structure(state.position, state.structure.parts, state.structure.supports)
    assert_same_cells(found, deformed)
    assert len(found.points) == len(state.position)
    assert found.supported.sum() == deformed.supported.sum()
    if ending != "dxf":  # which numbers nodes in the order of its entities
        assert np.array_equal(found.points, state.position)


def test_part_may_depend_on_place(tmp_path):
    write_mesh(roof(), tmp_path / "roof.msh")

    def radial(cells, points):
        centre = points[cells].mean(axis=1)
        return Membrane(cells, OrthotropicFabric(6e5, 4e5, 0.3, 2e4), (2e3, 1e3), warp=centre)

    found = structure_from_file(tmp_path / "roof.msh", {"Dach süd": radial})
    membrane = found.parts["Dach süd"]
    assert np.array_equal(membrane.warp, found.points[membrane.cells].mean(axis=1))
    with_default = structure_from_file(
        tmp_path / "roof.msh", {"Dach süd": lambda cells, stress=7.0: Membrane(cells, Fabric(4e5, 0.3), stress)}
    )
    assert with_default.parts["Dach süd"].prestress == 7.0


def test_obj_by_hand(tmp_path):
    (tmp_path / "a.obj").write_text(
        "# by hand\no thing\nv 0 0 0\nv 2 0 0 1.0\nv 2 1 0\nv 0 1 0 # corner\nvn 0 0 1\n"
        "g Dach süd\nf 1//1 2//1 3//1 4//1\n"
        "g edge\nl 1 2 \\\n 3\nl -1 1\n",
        encoding="utf-8",
    )
    found = structure_from_file(tmp_path / "a.obj", PARTS, {"edge": "z"}, split_quadrilaterals=True)
    assert found.parts["edge"].cells.tolist() == [[0, 1], [1, 2], [3, 0]]
    assert found.parts["Dach süd"].cells.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("ending", ["stl", "ply"])
def test_surface(ending, tmp_path):
    pyvista = pytest.importorskip("pyvista")
    faces = np.column_stack([np.full(len(TRIANGLES), 3), TRIANGLES])
    pyvista.PolyData(POINTS, faces.ravel()).save(tmp_path / f"roof.{ending}")
    found = structure_from_file(tmp_path / f"roof.{ending}", {"roof": PARTS["Dach süd"]})
    assert_same_cells(found, Structure(POINTS, {"roof": PARTS["Dach süd"](TRIANGLES)}), tolerance=1e-6)
    assert len(found.points) == len(POINTS)


def test_quadrilaterals_are_split_along_the_shorter_diagonal(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 3 1 0\nv 4 2 0\nv 0 1 0\nf 1 2 3 4\n")
    found = structure_from_file(tmp_path / "a.obj", {"default": PARTS["Dach süd"]}, split_quadrilaterals=True)
    edges = {
        tuple(sorted(pair))
        for cell in found.parts["default"].cells.tolist()
        for pair in zip(cell, cell[1:] + cell[:1], strict=True)
    }
    assert (1, 3) in edges
    assert (0, 2) not in edges


def test_weld_that_collapses_a_cell_is_refused(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 0.01 0\nf 1 2 3\n")
    with pytest.raises(ValueError, match=r"'default'.*1 of 1 triangles.*weld"):
        structure_from_file(tmp_path / "a.obj", {"default": PARTS["Dach süd"]}, weld=0.1)


RUBBISH = np.random.default_rng(1).integers(0, 256, 3000, dtype=np.uint8).tobytes()
HEAD = (
    b"ply\nformat binary_little_endian 1.0\nelement vertex 99\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 5\nproperty list uchar int vertex_indices\nend_header\n"
)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.dxf", RUBBISH),
        ("a.dxf", b"0\nSECTION\n"),
        ("a.obj", RUBBISH),
        ("a.obj", b"v 1 2\n"),
        ("a.obj", b"v 0 0 0\nf 1 2 3\n"),
        ("a.obj", b"f 0 1 2\n"),
        ("a.obj", b""),
        ("a.stl", RUBBISH),
        ("a.stl", b"solid x\nfacet normal\n"),
        ("a.ply", RUBBISH),
        ("a.ply", HEAD + RUBBISH),
        ("a.json", RUBBISH),
        ("a.json", b"[" * 100000),
        ("a.json", b'{"data": 5}'),
        ("a.json", b'{"node": {"0": {"x": "a"}}}'),
        ("a.json", b'{"node": {"0": {}}, "edge": {"0": {"7": {}}}}'),
        ("a.msh", RUBBISH),
        ("a.step", b""),
    ],
)
def test_rubbish_is_refused_in_a_sentence(name, content, tmp_path):
    if name.endswith("dxf"):
        pytest.importorskip("ezdxf")
    (tmp_path / name).write_bytes(content)
    with pytest.raises(ValueError, match=name):
        structure_from_file(tmp_path / name, {"default": PARTS["Dach süd"]})


def test_bad_arguments(tmp_path):
    with pytest.raises(ValueError, match="no file"):
        structure_from_file(tmp_path / "none.obj", PARTS)
    write_mesh(roof(), tmp_path / "roof.obj")
    for given, words in [({"weld": -1.0}, "weld"), ({"unit": "mile"}, "unit"), ({"split_quadrilaterals": 2}, "split")]:
        with pytest.raises(ValueError, match=words):
            structure_from_file(tmp_path / "roof.obj", PARTS, **given)
    with pytest.raises(ValueError, match=r"\.msh"):
        write_mesh(roof(), tmp_path / "roof.step")
    with pytest.raises(ValueError, match="Structure"):
        write_mesh(POINTS, tmp_path / "roof.obj")
    slashed = Structure(POINTS, {'a"b': PARTS["Dach süd"](TRIANGLES)})
    with pytest.raises(ValueError, match="name"):
        write_mesh(slashed, tmp_path / "roof.msh")


@pytest.mark.mpi
def test_on_several_processes(tmp_path_factory):
    from mpi4py import MPI  # noqa: PLC0415

    folder = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("meshes"))
    write_mesh(roof(), folder / "roof.obj")
    found = structure_from_file(folder / "roof.obj", PARTS)
    assert np.array_equal(found.points, roof().points)


@pytest.mark.parametrize("turn", range(4))
@pytest.mark.parametrize("backwards", [False, True])
def test_concave_quadrilateral_is_split_within(turn, backwards, tmp_path):
    corners = np.roll([1, 2, 3, 4], turn)[:: -1 if backwards else 1]
    places = "v 0 0 0\nv 4 0 0\nv 0.5 0.5 0\nv 0 4 0\n"  # its outer diagonal is the longer one
    for reach in (places, "v 0 0 0\nv 1 -9 0\nv 0 -8 0\nv -1 -9 0\n"):  # and here the shorter one
        (tmp_path / "a.obj").write_text(f"{reach}g sail\nf {' '.join(map(str, corners))}\n")
        found = structure_from_file(tmp_path / "a.obj", {"sail": PARTS["Dach süd"]}, split_quadrilaterals=True)
        a, b, c = (found.points[found.parts["sail"].cells][:, row] for row in range(3))
        normals = np.cross(b - a, c - a)[:, 2]
        assert normals[0] * normals[1] > 0


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("v 0 0", "a vertex needs three numbers"),
        ("v a b c", "a vertex needs three numbers"),
        ("v nan 0 0", "a vertex needs three numbers"),
        ("v 0 0 0\nl x 1", "'x' is no number of a vertex"),
        ("v 0 0 0\nl 0 1", "numbers begin with 1"),
    ],
)
def test_damaged_obj_is_told_in_words_of_the_file(text, words, tmp_path):
    (tmp_path / "a.obj").write_text(text)
    with pytest.raises(ValueError, match=words) as told:
        structure_from_file(tmp_path / "a.obj", PARTS)
    assert "unpack" not in str(told.value)


@pytest.mark.parametrize(
    ("points", "face", "words"),
    [
        (3, [0, 1, 9], r"a\.off: group 'all', cell 0 of its triangles, has the corner 9, .* 3 points, from 0\. Mend"),
        (3, [0, 1, -1], r"corner -1, which does not exist"),
        (5, [0, 1, 2, 3, 4], r"a\.off: group 'all' has cells with 5 corners; give triangles or quadrilaterals"),
        (np.nan, [0, 1, 2], r"a\.off: point 0 is \[nan, .*; give finite numbers"),
    ],
)
def test_cells_of_any_reader_are_checked(points, face, words, tmp_path, monkeypatch):
    """By the recipe of README, a reader returns what its file has."""
    places = np.full((3, 3), points) if np.isnan(points) else np.eye(points)[:, :3]
    read = Drawing("a.off", "group", places, {"all": {len(face): np.array([face])}})
    monkeypatch.setitem(mesh_files.READERS, ".off", lambda file: read)
    (tmp_path / "a.off").touch()
    with pytest.raises(ValueError, match=words):
        structure_from_file(tmp_path / "a.off", {"all": PARTS["Dach süd"]})
