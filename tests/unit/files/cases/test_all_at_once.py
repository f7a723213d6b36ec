"""Several faults of one table are told at once, each at the line of its key and in words of the file."""

import random
import re
import tomllib
from pathlib import Path

import pytest

import fx_membrane
import roof_case
import tent_case

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError
from fx_membrane.files.cases.lines import line_of
from fx_membrane.files.cases.units import Units

ROOF = {  # by key: the right text, and one with a fault of this key alone
    "geometry.columns": ("columns = 4", "columns = 0"),
    "materials.pvc.Et": ('Et = "500 kN/m"', 'Et = "-500 kN/m"'),
    "materials.pvc.nu": ("nu = 0.3", "nu = 3"),
    "parts.roof.material": ('material = "pvc"', 'material = "pcv"'),
    "parts.roof.wrap": ("warp = [1, 0, 0]", "wrap = [1, 0, 0]"),
    'parts."edge, left".axial_stiffness': ('axial_stiffness = "12 MN"', "axial_stiffness = -3"),
    'parts."edge, left".edges_of': ('edges_of = "roof"', 'edges_of = "rof"'),
    "supports.0.rim_of": ('rim_of = "roof"', 'rim_of = "rof"'),
    "supports.0.components": ('components = "z"', 'components = "q"'),
    "solver.rtol": ("rtol = 1e-11", "rtol = -1"),
    "stages.0.displacements.0.displacement": ("displacement = [0, 0, 0]", 'displacement = [0, 0, 0, "1 m"]'),
    "stages.1.after": ('after = "lift"', 'after = "lif"'),
    "stages.1.increments": ("increments = 2", "increments = 0"),
    "stages.1.loads.1.pressure": ('"-100 Pa"', '"-100 PA m"'),
    "stages.1.loads.2.force.2": ('"-50 N"', '"-50 KN/M"'),
}
TENT = {
    "materials.foil.thickness": ('thickness = "1 mm"', 'thickness = "-1 mm"'),
    "materials.foil.nu": ("nu = 0.3", "nu = 3"),
    "parts.edge.area": ('area = "1 cm2"', 'area = "-1 cm2"'),
    "parts.edge.mass": ("prestress = 40", "prestress = 40\nmass = -1"),
    "form_finding.1.direction": ("direction = [0, 0, 1]\nstress", "direction = [0, 0, 0]\nstress"),
    "form_finding.1.stress.film.terms.0.at": ('at = "1 m"', "at = 0"),
    "form_finding.1.constraints.0.part": ('part = "edge", force', 'part = "film", force'),
    "form_finding.1.constraints.1.normal": ("normal = [0, 0, 1] }", "normal = [0, 0, 0] }"),
    "form_finding.2.bars.mast.axial_stiffness": ('axial_stiffness = "20 MN"', "axial_stiffness = 0"),
    "form_finding.3.size": ('size = "1 m"', "size = -1"),
    "form_finding.3.sise": ("keep = {", "sise = 1\nkeep = {"),
    "work.iterations": ("iterations = 100", "iterations = 0"),
    "work.seconds": ("seconds = 60", "seconds = -1"),
    "limits.stress.film": ('film = "20 kN/m"', 'film = "-20 kN/m"'),
    "stages.0.loads.0.part": ('kind = "line", part = "edge"', 'kind = "line", part = "film"'),
    "output.folders": ("[output]", '[output]\nfolders = "x"'),
}


def told(folder, text):
    """Lines and words of the faults of a text, by key."""
    (folder / "a.toml").write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        read_case(folder / "a.toml")
    found = [re.fullmatch(r".*a\.toml:(\d+): ((?:\"[^\"]*\"|[^:\"])+): (.*)", line) for line in caught.value.lines]
    return {line[2]: (int(line[1]), line[3]) for line in found}


@pytest.mark.parametrize(("text", "faults"), [(roof_case.ROOF, ROOF), (tent_case.TENT, TENT)], ids=["roof", "tent"])
@pytest.mark.parametrize("seed", [None, *range(25)])
def test_all_faults_are_told_and_no_others(text, faults, seed, tmp_path):
    draw = random.Random(seed)
    keys = list(faults) if seed is None else draw.sample(list(faults), draw.randrange(2, 9))
    for key in keys:
        right, wrong = faults[key]
        assert right in text
        text = text.replace(right, wrong, 1)
    found = told(tmp_path, text)
    assert found.keys() == set(keys)
    for key, (number, words) in found.items():
        assert re.split(r"[.\"]", re.sub(r"(\.\d+)+$", "", key).rstrip('"'))[-1] in text.splitlines()[number - 1]
        assert not re.search(r"[A-Z][a-z]+[A-Z]|\b(Fabric|Membrane|Cable|Mast|Support|Newton|Slide|None|True)\b", words)


def test_a_wrong_kind_does_not_hide_the_other_keys(tmp_path):
    text = roof_case.ROOF.replace('kind = "cable"', 'kind = "cabel"').replace('"12 MN"', '"12 MM"')
    assert told(tmp_path, text).keys() == {'parts."edge, left".kind', 'parts."edge, left".axial_stiffness'}
    text = roof_case.ROOF.replace('kind = "pressure"\n', "").replace('"-100 Pa"', '"-100 m"')
    assert told(tmp_path, text).keys() == {"stages.1.loads.1", "stages.1.loads.1.pressure"} or told(
        tmp_path, text
    ).keys() == {"stages.1.loads.1.kind", "stages.1.loads.1.pressure"}


def test_faults_of_the_second_stage_are_at_its_lines(tmp_path):
    text = roof_case.ROOF.replace('name = "snow"', 'name = "lift"').replace(
        "nodes = [12]", "nodes = [\n    12,\n    99]"
    )
    found = told(tmp_path, text)
    rows = text.splitlines()
    assert rows[found["stages.1.name"][0] - 1] == 'name = "lift"'
    assert found["stages.1.name"][0] > rows.index('name = "lift"') + 1
    assert rows[found["stages.1.loads.2.nodes.1"][0] - 1].strip() == "99]"


def test_every_key_has_its_line():
    texts = [file.read_text() for file in (Path(fx_membrane.__file__).parent / "files" / "demos").glob("*.toml")]
    for text in [roof_case.ROOF, tent_case.TENT, *texts]:
        rows = text.splitlines()
        for path in leaves(tomllib.loads(text)):
            if isinstance(path[-1], str):
                assert path[-1] in rows[line_of(text, path) - 1]


def leaves(data, path=()):
    """Paths of all keys and rows."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from leaves(value, (*path, key))


@pytest.mark.parametrize(
    ("name", "right", "dimension"),
    [
        ("KN/m", "kN/m", "F/L"),
        ("Kn/M", "kN/m", "F/L"),
        ("kn/m2", "kN/m2", "F/L^2"),  # knots, for pint
        ("mpa", "MPa", "F/L^2"),
        ("KN", "kN", "F"),
        ("KG/m", "kg/m", "F T^2/L^2"),
    ],
)
def test_wrong_capitals_are_spelled_rightly(name, right, dimension):
    with pytest.raises(ValueError, match=f"'{right}' may be meant"):
        Units("kN", "m").number(f"3 {name}", dimension)
