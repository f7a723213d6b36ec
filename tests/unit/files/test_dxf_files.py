"""Structures from DXF: blocks, layers, curves and units."""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Mast,
    Membrane,
    structure_from_file,
    write_mesh,
)
from fx_membrane.files.conversion import convert
from square_roofs import PARTS, roof


def test_dxf_of_a_drawing_office(tmp_path, capfd):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.header["$INSUNITS"] = 4  # mm
    space, block = document.modelspace(), document.blocks.new("bay")
    block.add_3dface([(0, 0, 0), (1000, 0, 0), (1000, 1000, 0), (0, 1000, 0)], dxfattribs={"layer": "roof"})
    space.add_blockref("bay", (0, 0, 0))
    space.add_blockref("bay", (1000.0001, 0, 0))
    space.add_lwpolyline([(0, 0), (1000, 0), (2000, 0)], dxfattribs={"layer": "edge"})
    space.add_line((0, 1000, 0), (0, 1000, 2000), dxfattribs={"layer": "mast"})
    mesh = space.add_mesh(dxfattribs={"layer": "wall"})
    with mesh.edit_data() as data:
        data.vertices = [(0, 0, 0), (0, 1000, 0), (0, 0, 1000)]
        data.faces = [(0, 1, 2)]
    space.add_point((0, 0, 0), dxfattribs={"layer": "feet"})
    document.saveas(tmp_path / "a.DXF")
    parts = {
        "roof": lambda cells: Membrane(cells, Fabric(4e5, 0.3)),
        "wall": lambda cells: Membrane(cells, Fabric(4e5, 0.3)),
        "edge": lambda cells: Cable(cells, 1e6),
        "mast": lambda cells: Mast(cells, 1e7),
    }
    found = structure_from_file(
        tmp_path / "a.DXF", parts, {"feet": "xyz"}, weld=1e-3, split_quadrilaterals=True, unit="m"
    )
    assert len(found.points) == 3 * 2 + 1 + 1
    assert "joined" in capfd.readouterr().err
    assert [len(part.cells) for part in found.parts.values()] == [4, 1, 2, 1]
    assert np.ptp(found.points, axis=0) == pytest.approx([2.0, 1.0, 2.0], abs=1e-6)
    assert found.points[found.supported.any(axis=1)].tolist() == [[0.0, 0.0, 0.0]]
    with pytest.raises(ValueError, match=r"roof.*quadrilaterals"):
        structure_from_file(tmp_path / "a.DXF", {"roof": parts["roof"]})
    with pytest.raises(ValueError, match=r"'Roof'.*edge.*wall"):
        structure_from_file(tmp_path / "a.DXF", {"Roof": parts["roof"]})
    structure_from_file(tmp_path / "a.DXF", {"wall": parts["wall"]})
    assert "mm" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("code", "unit", "told"), [(6, "m", False), (6, None, False), (4, "mm", False), (4, None, True)]
)
def test_unit_is_told_only_where_it_differs(code, unit, told, tmp_path, capfd):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new(units=code)
    document.modelspace().add_line((0, 0, 0), (1, 0, 0), dxfattribs={"layer": "edge"})
    document.saveas(tmp_path / "a.dxf")
    structure_from_file(tmp_path / "a.dxf", {"edge": lambda cells: Cable(cells, 1e6)}, unit=unit)
    assert ("taken as they are" in capfd.readouterr().err) == told


def test_curves_and_mixed_layers_are_refused(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    document.modelspace().add_3dface([(0, 0, 0), (1, 0, 0), (1, 1, 0)], dxfattribs={"layer": "mixed"})
    document.modelspace().add_line((0, 0, 0), (1, 0, 0), dxfattribs={"layer": "mixed"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(ValueError, match=r"'mixed'.*lines and faces"):
        structure_from_file(tmp_path / "a.dxf", {"mixed": PARTS["edge"]})
    document.modelspace().add_arc((0, 0, 0), 1, 0, 90, dxfattribs={"layer": "arc"})
    document.saveas(tmp_path / "a.dxf")
    with pytest.raises(ValueError, match=r"'arc'.*ARC"):
        structure_from_file(tmp_path / "a.dxf", {"arc": PARTS["edge"]})


def test_curve_on_another_layer_is_no_obstacle(tmp_path, capfd):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    space = document.modelspace()
    space.add_line((0, 0, 0), (1, 0, 0), dxfattribs={"layer": "edge"})
    space.add_circle((0, 0, 0), 1, dxfattribs={"layer": "notes"})
    space.add_spline([(0, 0, 0), (1, 1, 0), (2, 0, 0)], dxfattribs={"layer": "sketch"})
    space.add_lwpolyline([(0, 0, 0, 0, 1), (1, 1, 0, 0, 0)], dxfattribs={"layer": "bulge"})
    document.saveas(tmp_path / "a.dxf")
    assert len(structure_from_file(tmp_path / "a.dxf", {"edge": PARTS["edge"]}).parts["edge"].cells) == 1
    for layer in ("notes", "sketch", "bulge"):
        with pytest.raises(ValueError, match=rf"'{layer}' has a (curve|polyline with arcs)"):
            structure_from_file(tmp_path / "a.dxf", {"edge": PARTS["edge"]}, {layer: "xyz"})
    capfd.readouterr()
    convert(tmp_path / "a.dxf", tmp_path / "a.obj")
    told = capfd.readouterr().err
    assert all(f"layer '{layer}' has a" in told for layer in ("notes", "sketch", "bulge"))
    assert len(structure_from_file(tmp_path / "a.obj", {"edge": PARTS["edge"]}).parts["edge"].cells) == 1


@pytest.mark.parametrize(("unit", "code"), [("m", 6), ("mm", 4), ("ft", 2), ("", 0), ("furlong", 0)])
def test_dxf_has_its_unit(unit, code, tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_mesh(roof(), tmp_path / "a.dxf", length_unit=unit)
    document = ezdxf.readfile(tmp_path / "a.dxf")
    assert document.header["$INSUNITS"] == code
    assert {"Dach süd", "edge", "supports"} <= {entity.dxf.layer for entity in document.modelspace()}
    found = structure_from_file(tmp_path / "a.dxf", PARTS, unit="mm" if code else None)
    assert np.ptp(found.points) == pytest.approx(
        np.ptp(roof().points) * {"m": 1000, "ft": 304.8}.get(unit, 1), rel=1e-12
    )


def test_convert_keeps_the_unit_of_dxf(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    write_mesh(roof(), tmp_path / "a.dxf", length_unit="mm")
    for name, unit, code in (("same", None, 4), ("metres", "m", 6)):
        convert(tmp_path / "a.dxf", tmp_path / f"{name}.dxf", unit)
        assert ezdxf.readfile(tmp_path / f"{name}.dxf").header["$INSUNITS"] == code
    write_mesh(roof(), tmp_path / "a.obj")
    convert(tmp_path / "a.obj", tmp_path / "none.dxf")
    assert ezdxf.readfile(tmp_path / "none.dxf").header["$INSUNITS"] == 0


def test_convert_tells_the_unit_where_the_target_has_none(tmp_path, capfd):
    pytest.importorskip("ezdxf")
    write_mesh(roof(), tmp_path / "a.dxf", length_unit="mm")
    for target, unit, told in [("b.dxf", None, ""), ("b.obj", None, "mm"), ("c.obj", "m", "m"), ("c.dxf", "m", "")]:
        convert(tmp_path / "a.dxf", tmp_path / target, unit)
        said = f"{tmp_path / target} names no unit of length; its numbers are in {told}.\n" if told else ""
        assert capfd.readouterr().err == said


def test_layer_0_in_blocks_is_that_of_the_insert(tmp_path):
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new()
    space, bay, pair = document.modelspace(), document.blocks.new("bay"), document.blocks.new("pair")
    bay.add_3dface([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    bay.add_line((0, 0, 0), (1, 0, 0), dxfattribs={"layer": "edge"})
    pair.add_blockref("bay", (0, 0, 0))
    pair.add_blockref("bay", (0, 0, 5), dxfattribs={"layer": "upper"})
    pair.add_blockref("pair", (0, 0, 0))  # within itself
    space.add_blockref("bay", (10, 0, 0), dxfattribs={"layer": "roof"})
    space.add_blockref("pair", (20, 0, 0), dxfattribs={"layer": "roof"})
    rows = space.add_blockref("bay", (30, 0, 0), dxfattribs={"layer": "row"})
    rows.grid((1, 3), (0, 2))
    space.add_line((0, 0, 0), (0, 0, 1))  # on layer 0 itself
    document.saveas(tmp_path / "a.dxf")
    membranes = dict.fromkeys(("roof", "upper", "row"), lambda cells: Membrane(cells, Fabric(4e5, 0.3)))
    bars = dict.fromkeys(("edge", "0"), lambda cells: Cable(cells, 1e6))
    found = structure_from_file(tmp_path / "a.dxf", membranes | bars, unit="m")
    counts = {name: len(part.cells) for name, part in found.parts.items()}
    assert counts == {"roof": 2, "upper": 1, "row": 3, "edge": 6, "0": 1}
    lowest = found.points[found.parts["row"].cells].min(axis=(0, 1))
    assert lowest.tolist() == [30, 0, 0]
