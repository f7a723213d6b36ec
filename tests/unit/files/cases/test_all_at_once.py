"""Several faults of one table are told at once, each at its line and in words of the file."""

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
from fx_membrane.files.cases.wording import in_words_of_files

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
    text = roof_case.changed(text, *(faults[key] for key in keys), count=1)
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


@pytest.mark.parametrize(
    ("right", "wrong", "faults"),
    [
        ('kind = "plan"', 'kind = "temperature"', {"stages.1.loads.0.kind": "is not one of"}),
        ('kind = "cable"\nedges_of = "roof"', 'kind = "bungee"', {'parts."edge, left".kind': "is not one of"}),
        ('kind = "fabric"', 'kind = "steel"\nfy = 235', {"materials.pvc.kind": "is not one of"}),
        (
            'kind = "grid"\nwidth = "4 m"\nheight = 4.0\ncolumns = 4\nrows = 4',
            'width = "4 m"',
            {"geometry": "'kind' is missing"},
        ),
        ("nu = 0.3", "nu = 0.3\ncolumns = 3", {"materials.pvc.columns": "it belongs to another table"}),
        ('folder = "out"', 'colour = "red"', {"output.colour": "pictures"}),
        ('folder = "out"', "[limits]\nutilisation = 1", {"limits.utilisation": "limits.stress and limits.force"}),
        ("increments = 2", "increment = 2", {"stages.1.increment": "'increments' may be meant"}),
        ('folder = "out"', "sky = 2", {"output.sky": "correct or remove it"}),
    ],
)
def test_hints_are_of_the_table_and_nothing_follows_from_a_guess(right, wrong, faults, tmp_path):
    assert right in roof_case.ROOF
    found = told(tmp_path, roof_case.ROOF.replace(right, wrong, 1))
    assert found.keys() == faults.keys()
    for key, words in faults.items():
        assert words in found[key][1]


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


SAIL = """
format = 1
units = { force = "kN", length = "m" }
parts.roof = { kind = "membrane", group = "sail", material = "pvc", prestress = 2 }
materials.pvc = { kind = "fabric", Et = 600, nu = 0.3 }

[geometry]
kind = "sail"
corners = { A = [-6, -6], B = [6, -6], C = [6, 6], D = [-6, 6] }
size = 2
sag = { "A-B" = 0.1, "B-C" = 0.05 }
points.P = [3, 3, 2]
holes.ring = { centre = [0, 0, 4], radius = 0.8 }
holes.gap = [[-4, 3], [-3, 3], [-3, 4]]
lines.ridge = ["A", ["ring", 0.625]]
sizes.ring = 1
"""
SAILS = {
    "geometry.corners.D": ("D = [-6, 6]", "D = [-6]"),
    "geometry.size": ("size = 2", "size = -2"),
    "geometry.sag.A-C": ('"B-C" = 0.05', '"A-C" = 0.05'),
    "geometry.sag.A-B": ('"A-B" = 0.1', '"A-B" = 0.7'),
    "geometry.points.P": ("points.P = [3, 3, 2]", "points.P = [3]"),
    "geometry.holes.ring.centre": ("centre = [0, 0, 4]", "centre = [0, 0, 4, 4]"),
    "geometry.holes.ring.radius": ("radius = 0.8", "radius = -0.8"),
    "geometry.holes.gap": (", [-3, 4]]", "]"),
    "geometry.lines.ridge": ('lines.ridge = ["A"', 'lines.ridge = ["X"'),
    "geometry.sizes.rung": ("sizes.ring", "sizes.rung"),
    "materials.pvc.nu": ("nu = 0.3", "nu = 3"),
}


@pytest.mark.parametrize("seed", [None, *range(12)])
def test_all_faults_of_a_sail_are_told(seed, tmp_path):
    draw, text = random.Random(seed), SAIL
    keys = list(SAILS) if seed is None else draw.sample(list(SAILS), draw.randrange(2, 7))
    text = roof_case.changed(text, *(SAILS[key] for key in keys), count=1)
    lost = {"geometry.lines.ridge"} if {*keys} & {"geometry.holes.ring.centre", "geometry.holes.ring.radius"} else set()
    found = told(tmp_path, text)
    assert found.keys() == {*keys} - lost
    assert not [words for _, words in found.values() if re.search(r"\(x, y|RoundHole|shape \(", words)]


def test_places_of_a_sail_are_told_apart_where_its_corners_are_sound(tmp_path):
    text = SAIL.replace("P = [3, 3, 2]", "P = [30, 3]").replace("[-3, 3], [-3, 4]", "[-3, 3], [-30, 4]")
    assert told(tmp_path, text).keys() == {"geometry.points.P", "geometry.holes.gap"}


def test_a_sound_sail_has_no_fault(tmp_path):
    pytest.importorskip("gmsh")
    (tmp_path / "a.toml").write_text(SAIL, encoding="utf-8")
    assert read_case(tmp_path / "a.toml").structure.points[:, 2].max() == 4.0


def test_a_guessed_kind_makes_no_fault_of_its_part(tmp_path):
    text = roof_case.ROOF.replace('kind = "pressure"', 'kind = "snow"').replace('"-100 Pa"', '"-100 m"')
    found = told(tmp_path, text)
    assert "'plan' may be meant" in found["stages.1.loads.1.kind"][1]
    assert not [key for key in found if key.endswith("part")]


def test_names_of_nodes_and_directions_are_told_beside_other_faults(tmp_path):
    text = tent_case.TENT.replace("nu = 0.3", "nu = 3").replace(
        "constraints = [", 'constraints = [{ kind = "slide", nodes = [0] }, ', 1
    )
    found = told(tmp_path, text)
    assert found["form_finding.1.constraints.0"][1] == "give one of direction, normal"
    assert "materials.foil.nu" in found


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            "Membrane warp has shape (2,); give (3,) or (9, 3).",
            "is a list of length 2; give [x, y, z], or one for each",
        ),
        ("Slide normal has shape (2, 2); give (3,), or (4, 3) for one at each node.", "2 rows of length 2; give [x, y"),
        ("A Slide is on a line or on a plane; give one.", "nodes slide on a line or on a plane"),
        ("the limit is used up; allow more (WorkLimit), or", "allow more (the table work), or"),
        ("source is 'a.mesh'; give a file", "it is 'a.mesh'"),
        ("points has shape (2, 2); give (n, 3), one row x, y, z for each node.", "give rows [x, y, z], one for each"),
    ],
)
def test_messages_have_the_words_of_files(words, expected):
    assert expected in in_words_of_files(words)
