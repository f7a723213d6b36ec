"""Case files: they say what scripts say, and their faults come all at once, with line, key and remedy."""

import json
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import fx_membrane
from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Newton,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    edges_where,
    projected_stress,
    rectangle,
    write_mesh,
)
from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError
from fx_membrane.files.cases.lines import line_of
from fx_membrane.files.cases.schema import json_schema


def write(path, text):
    path.write_text(text, encoding="utf-8")
    return path


def script():
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    left = edges_where(points, triangles, lambda x: np.isclose(x[0], -2))
    parts = {
        "roof": Membrane(triangles, Fabric(500.0, 0.3), (1.0, 1.5), warp=(1, 0, 0)),
        "edge, left": Cable(left, 12e3, 20.0),
    }
    south = np.flatnonzero(np.isclose(points[:, 1], -2))
    supports = [Support(np.unique(boundary_edges(triangles)), "z"), Support(south), Support([20, 24])]
    structure = Structure(points, parts, supports)
    east = np.flatnonzero(points[triangles].mean(axis=1)[:, 0] >= 0)
    loads = [
        PlanLoad((0, 0, -0.6), "roof"),
        Pressure(-0.1, "roof", east),
        PointLoad([12], (0, 0, -0.05)),
        DistributedLoad((0.01, 0, 0), "roof", [0, 1]),
    ]
    lift = Stage("lift", displacements=[PrescribedDisplacement([24], (0, 0, 0))])
    return Analysis(structure, Newton(rtol=1e-11)).run([lift, Stage("snow", loads, after="lift", increments=2)])


def test_case_gives_the_numbers_of_the_script(tmp_path):
    case = read_case(write(tmp_path / "roof.toml", ROOF))
    found = Analysis(case.structure, case.solver).run(case.stages)["snow"]
    expected = script()["snow"]
    assert np.array_equal(found.displacement, expected.displacement)
    assert (case.title, case.force_unit, case.length_unit) == ("Roof", "kN", "m")


def test_case_of_a_mesh_file_with_form_finding(tmp_path):
    points, triangles = rectangle(4.0, 4.0, 6, 6)
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = points[rim, 0] * points[rim, 1] / 4
    film = Membrane(triangles, Fabric(500.0, 0.3), (2.0, 1.0), warp=(1, 0, 0))
    structure = Structure(points, {"film": film}, [Support(rim)])
    write_mesh(structure, tmp_path / "meshes" / "film.msh")
    text = """
        format = 1
        geometry = { kind = "file", file = "meshes/film.msh" }
        materials.pvc = { kind = "fabric", Et = 500, nu = 0.3 }
        parts.film = { kind = "membrane", material = "pvc", prestress = [2, 1], warp = [1, 0, 0] }
        supports = [{ group = "support 0 xyz" }]
        [form_finding]
        method = "projected stress"
        loads = [{ kind = "pressure", part = "film", pressure = 0.01 }]
    """
    case = read_case(write(tmp_path / "film.toml", text))
    expected = projected_stress(structure, [Pressure(0.01, "film")])
    assert np.array_equal(case.form().points, expected.points)


FAULTS = {
    "nu = 0.3": ("nue = 0.3", {"materials.pvc.nue": "'nu' may be meant", "materials.pvc.nu": "missing"}, 15),
    'Et = "500 kN/m"': ('Et = "500 kN/m2"', {"materials.pvc.Et": "no unit of this quantity"}, 14),
    'kind = "cable"': ('kind = "cabel"', {'parts."edge, left".kind': "'cable' may be meant"}, 25),
    'pressure = "-100 Pa"': ('pressure = "-100,5 Pa"', {"stages.1.loads.1.pressure": "comma"}, 62),
    "increments = 2": ("increments = 2.5", {"stages.1.increments": "integer"}, 52),
    'units = { force = "kN", length = "m" }': (
        'units = { force = "kN", length = "s" }',
        {"units.length": "no unit of length"},
        3,
    ),
    "format = 1": ("format = 2", {"format": "1"}, 1),
    "columns = 4": ('columns = "four"', {"geometry.columns": "integer"}, 9),
}


def test_all_faults_come_at_once_with_their_lines(tmp_path):
    text = ROOF
    for right, (wrong, _, _) in FAULTS.items():
        text = text.replace(right, wrong, 1)
    with pytest.raises(CaseError) as caught:
        read_case(write(tmp_path / "roof.toml", text))
    for _, told, number in FAULTS.values():
        for key, words in told.items():
            line = next(line for line in caught.value.lines if f": {key}: " in line)
            assert words in line
            if "missing" not in words:
                assert line.startswith(f"{tmp_path / 'roof.toml'}:{number}: ")


@pytest.mark.parametrize(
    ("right", "wrong", "key", "words"),
    [
        ("nu = 0.3", "nu = 3", "materials.pvc.nu", "Poisson"),
        ('edges_of = "roof"', 'edges_of = "rof"', 'parts."edge, left".edges_of', "'roof' may be meant"),
        ('material = "pvc"', 'material = "pcv"', "parts.roof.material", "'pvc' may be meant"),
        ('group = "grid"', 'group = "grit"', "parts.roof.group", "grid"),
        ('group = "grid"', 'group = "grid"\ncells = [[0, 1, 2]]', "parts.roof", "one of"),
        ('components = "z"', 'components = "q"', "supports.0.components", "x, y and z"),
        ("nodes = [20, 24]", "nodes = [20, 99]", "supports.2.nodes.1", "99"),
        ('y = "-2 m"', "y = 7", "supports.1.where", "no node"),
        ('rim_of = "roof"', 'rim_of = "edge, left"', "supports.0.rim_of", "no membrane"),
        (
            '  part = "roof"\n  load = [0, 0, "-0.6',
            '  part = "rof"\n  load = [0, 0, "-0.6',
            "stages.1.loads.0.part",
            "'roof' may",
        ),
        ("cells = [0, 1]", "cells = [0, 1000]", "stages.1.loads.3.cells.1", "1000"),
        ('after = "lift"', 'after = "left"', "stages.1.after", "left"),
        ("rtol = 1e-11", "rtol = -1", "solver.rtol", "positive"),
        ("where = { x = [0, 2] }", "where = { x = [7, 9] }", "stages.1.loads.1.where", "no cell"),
        ('units = { force = "kN", length = "m" }', "", "geometry.width", "units"),
    ],
)
def test_fault_is_told_by_line_and_key(right, wrong, key, words, tmp_path):
    assert right in ROOF
    with pytest.raises(CaseError) as caught:
        read_case(write(tmp_path / "roof.toml", ROOF.replace(right, wrong, 1)))
    assert any(
        re.search(rf"roof\.toml:\d+: {re.escape(key)}: .*{re.escape(words)}", line) for line in caught.value.lines
    )


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xfe",
        b"x = [",
        b"a = 1\na = 2",
        b"[" * 5000 + b"]" * 5000,
        b"x = " + b"[" * 3000,
        b"\0",
        b"format = 1\n[geometry",
    ],
)
def test_what_is_no_toml(content, tmp_path):
    (tmp_path / "a.toml").write_bytes(content)
    with pytest.raises(CaseError, match=r"a\.toml:\d+: file: "):
        read_case(tmp_path / "a.toml")


def test_missing_file(tmp_path):
    with pytest.raises(ValueError, match="No such file"):
        read_case(tmp_path / "a.toml")


def test_lines():
    assert line_of(ROOF, ("materials", "pvc", "nu")) == 15
    assert line_of(ROOF, ("parts", "edge, left", "prestress")) == 29
    assert line_of(ROOF, ("stages", 1, "loads", 2, "force")) == 68
    assert line_of(ROOF, ("geometry", "nothing")) == 5
    assert line_of(ROOF, ("nothing",)) == 1


def test_schema_is_plain_json():
    schema = json.loads(json.dumps(json_schema()))
    assert schema["properties"]["format"]["const"] == 1
    assert set(schema["required"]) == {"format", "geometry", "parts"}


def resolved(entry, schema):
    return schema["$defs"][entry["$ref"].rsplit("/", 1)[-1]] if "$ref" in entry else entry


def test_alternatives_of_the_schema_exclude_each_other():
    """A value of one of several kinds, which no key tells apart, has one JSON type in each."""
    schema, entries, several = json_schema(), [json_schema()], 0
    while entries:
        entry = entries.pop()
        entries += entry.values() if isinstance(entry, dict) else entry if isinstance(entry, list) else []
        if isinstance(entry, dict) and "discriminator" not in entry and "oneOf" in entry:
            several += 1
            types = [resolved(one, schema)["type"] for one in entry["oneOf"]]
            types = [kind for one in types for kind in ([one] if isinstance(one, str) else one)]
            assert len(set(types)) == len(types), entry
    assert several > 3


def test_validator_of_schemas_takes_the_demos():
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft202012Validator.check_schema(json_schema())
    validator = jsonschema.Draft202012Validator(json_schema())
    for file in (Path(fx_membrane.__file__).parent / "files" / "demos").glob("*.toml"):
        assert [error.message for error in validator.iter_errors(tomllib.loads(file.read_text()))] == []
    assert list(validator.iter_errors({"format": 1, "geometry": {"kind": "sail"}, "parts": {}, "more": 1}))
