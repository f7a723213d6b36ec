"""Tables of cutting patterns in case files: ways to ask for them, and faults with their lines."""

import numpy as np
import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")
pytest.importorskip("shapely.creation")  # of shapely 2
pytest.importorskip("ezdxf")

from by_command import said
from fx_membrane import prove_pattern
from fx_membrane.files.cases.case import read_case
from pattern_case import PATTERNS, case


def test_case_without_patterns_is_refused(tmp_path):
    code, words = said("patterns", case(tmp_path, ""))
    assert code == 2
    assert "asks for no cutting pattern; add a table [patterns]" in words


def test_strip_wider_than_the_roll_is_refused_by_name(tmp_path):
    code, words = said("patterns", case(tmp_path, PATTERNS.replace("2.2 m", "1.5 m")))
    assert code == 2
    assert "roof.toml: patterns: The width of the roll is 1.5, and 2 of 2 pieces are wider: 'strip 1' with 2.0" in words


BETWEEN = '\n[patterns]\nbetween = [{ first = "rim", last = "edge", strips = 4 }]\n'


@pytest.mark.parametrize(
    ("old", "new", "fault"),
    [
        ('kind = "grid"', 'kind = "file"\nfile = "gone.obj"', "geometry.file: There is no file"),
        ("nu = 0.3", "nu = 3", "materials.pvc.nu: nu is 3.0"),
    ],
)
def test_borders_are_not_judged_beside_faults_of_their_geometry(tmp_path, old, new, fault):
    """A border may be a group of the geometry that cannot be read, or a part that has a fault."""
    file = case(tmp_path, BETWEEN)
    file.write_text(file.read_text().replace(old, new, 1))
    with pytest.raises(ValueError, match="roof") as caught:
        read_case(file)
    assert fault in str(caught.value)
    assert "there is no part" not in str(caught.value)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("roll_width = 3", "35: patterns: there are no seams; give geodesics, planes, between or cables"),
        ("geodesics = [[0, 99]]", "36: patterns.geodesics.0: 99 is not there; the numbers go from 0 to 34"),
        ("geodesics = [[0]]", "36: patterns.geodesics.0: a geodesic has two ends"),
        ('cables = ["edge"]', "36: patterns.cables.0: there is no part 'edge'"),
        ('planes = [{ point = [0, 0, 0], normal = [0, 1, 0] }]\npaper = "A9"', "37: patterns.paper: paper is 'A9'"),
        ("planes = [{ point = [0, 0, 0] }]", "36: patterns.planes.0.normal"),
        ("planes = []\nallowances = { seam = -1 }", "37: patterns.allowances.seam"),
        ('planes = []\nsize = "2 kN"', "37: patterns.size"),
        (
            'between = [{ first = "rim", last = [3, 4] }]',
            "36: patterns.between.0.first: the geometry has no group 'rim'",
        ),
        ("colour = 3", "36: patterns.colour: there is no key of that name"),
        (
            "between = [{ first = [0, 7], last = [6, 13], roll_width = 2 }]",
            "36: patterns.between.0.roll_width: there is no key of that name here; it belongs to another table, patt",
        ),
        (
            "planes = []\ntransition = 0.5",
            "37: patterns.transition: nothing is decompensated; give decompensate as well",
        ),
        (
            "planes = []\ntransition = 0.5\ndecompensate = ['border 1', 99]",
            "38: patterns.decompensate.1: 99 is not there; the numbers go from 0 to 34",
        ),
        (
            "planes = []\ncompensation = 0.5",
            "37: patterns.compensation: compensation is [0.5, 0.5]; give ratios of cloth",
        ),
        (
            "planes = []\ncompensation = { 'strip 2' = [0.99, 0.015] }",
            '37: patterns.compensation."strip 2": compensation is [0.99, 0.015]; give ratios',
        ),
        (
            'planes = []\ndecompensate = ["border 1"]',
            "37: patterns.decompensate: the width over which compensation begins beside them is missing",
        ),
        (
            "roll_width = 0.1\nallowances = { seam = 0.05 }",
            "36: patterns.roll_width: roll_width is 0.1, no more than two allowances of seams",
        ),
        ("planes = []\ncompensation = 'stress'", "37: patterns.compensation"),
        (
            "planes = []\nstress_error = 5",
            "37: patterns.stress_error: stress_error is 5.0; it must be at most 1, as 0.05",
        ),
        (
            "planes = []\ncopy_tolerance = 0.01",
            "37: patterns.copy_tolerance: no copies are asked for; give copies = true",
        ),
        ("planes = []\ncopies = true\ncopy_tolerance = 0", "38: patterns.copy_tolerance: copy_tolerance is 0"),
        (
            "planes = [{ point = [0, 0, 0], normal = [0, 0, 0] }]",
            "36: patterns.planes.0.normal: normal is [0.0, 0.0, 0.0]; give a direction",
        ),
        (
            "planes = []\nwarp = { 'strip 1' = [0, 0, 0] }",
            '37: patterns.warp."strip 1": warp is [0.0, 0.0, 0.0]; give a direction',
        ),
    ],
)
def test_faults_have_lines(tmp_path, table, words):
    with pytest.raises(ValueError, match="roof") as caught:
        read_case(case(tmp_path, f"\n[patterns]\n{table}\n"))
    told = str(caught.value)
    assert f"roof.toml:{words}" in told


@pytest.mark.parametrize(
    ("table", "strips"),
    [
        ('geodesics = [[[-3, -1, 0], ["3 m", -1, 0]], [[-3, 1, 0], [3, 1, 0]]]', 3),
        ("geodesics = [[14, 20]]", 2),
        ("between = [{ first = [0, 7, 14, 21, 28], last = [6, 13, 20, 27, 34], strips = 4 }]", 4),
        ("between = [{ first = [0, 7, 14, 21, 28], last = [6, 13, 20, 27, 34] }]\nroll_width = 1.5", 3),
    ],
)
def test_ways_to_ask_for_seams(tmp_path, table, strips):
    pytest.importorskip("potpourri3d")
    found = read_case(case(tmp_path, f"\n[patterns]\n{table}\n"))
    assert len(found.patterns.pattern(found.structure).cloth) == strips


def test_loads_of_the_proof_act_on_the_strips(tmp_path):
    extra = 'loads = [{ kind = "plan", part = "roof", load = [0, 0, -0.1] }]\ncompensation = [0.99, 0.995]\n'
    found = read_case(case(tmp_path, PATTERNS + extra))
    pattern = found.patterns.pattern(found.structure)
    proof = prove_pattern(pattern, found.patterns.loads, progress=False)
    assert [load.part for load in proof.loads] == ["strip 1", "strip 2"]
    assert pattern.compensation["strip 1"] == pytest.approx([0.99, 0.995], rel=1e-6)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (
            "between = [{ first = [0, 7, 14, 21, 28], last = [6, 13, 20, 27, 34] }]\nroll_width = 0.042",
            "between.0: roll_width is 0.002, too little for 500 strips",
        ),
        ("planes = [{ point = [0, 0, 5], normal = [0, 0, 1] }]", "planes.0: The plane through"),
        ("geodesics = [[14, 20], [[-3, 1, 0], [3, 1, 9]]]", r"geodesics.1: end \(3, 1, 9\) is not on the surface"),
    ],
)
def test_seams_that_cannot_be_made_name_their_entry(tmp_path, table, words):
    if "geodesics" in table:
        pytest.importorskip("potpourri3d")
    found = read_case(case(tmp_path, f"\n[patterns]\n{table}\n"))
    with pytest.raises(ValueError, match=words):
        found.patterns.pattern(found.structure)


def test_one_strip_by_prestress_another_by_factors(tmp_path):
    table = "compensation = { 'strip 1' = 'prestress', 'strip 2' = [0.99, 0.98] }"
    found = read_case(case(tmp_path, f"{PATTERNS}{table}\n"))
    pattern = found.patterns.pattern(found.structure)
    assert pattern.compensation["strip 1"] == pytest.approx([1 / (1 + 2 * 0.7 / 500)] * 2, rel=1e-4)
    assert pattern.compensation["strip 2"] == pytest.approx([0.99, 0.98], rel=1e-3)


TESTS = 'stress = [["1 kN/m", 1], [3, 3]], elongation = [[0.002, 0.006], [0.006, 0.010]]'


@pytest.mark.parametrize("table", [f"{{ {TESTS} }}", f"{{ 'strip 1' = {{ {TESTS} }}, 'strip 2' = [0.99, 0.98] }}"])
def test_compensation_by_biaxial_tests(tmp_path, table):
    """The roof has 2 kN/m in both directions, in the middle between two tests."""
    found = read_case(case(tmp_path, f"{PATTERNS}compensation = {table}\n"))
    pattern = found.patterns.pattern(found.structure)
    assert pattern.compensation["strip 1"] == pytest.approx([1 / 1.004, 1 / 1.008], rel=1e-9)
    second = [0.99, 0.98] if "strip 2" in table else [1 / 1.004, 1 / 1.008]
    assert pattern.compensation["strip 2"] == pytest.approx(second, rel=1e-9)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ("{ stress = [[1, 1], [3, 3]] }", "biaxial tests have stress and elongation; give"),
        ("{ stress = [[1, 1], [3, 3]], elongation = [[0.002, 0.006]] }", "patterns.compensation: BiaxialTests stress"),
        ("{ 'strip 1' = { stress = [[1, 1], [1, 1]], elongation = [[0, 0], [0, 0]] } }", "has a pair twice"),
        ("{ stress = [[1, 1], [3, '3 m']], elongation = [[0, 0], [0, 0.1]] }", "'m' is no unit of this quantity"),
    ],
)
def test_faults_of_biaxial_tests_are_told(tmp_path, table, words):
    with pytest.raises(ValueError, match=r"roof\.toml:40") as caught:
        read_case(case(tmp_path, f"{PATTERNS}compensation = {table}\n"))
    assert words in str(caught.value)


SAIL = """\
kind = "sail"
size = 1.5
corners = { A = [0, 0], B = [6, 0], C = [6, 4], D = [0, 4] }
"""
ROPE = """
[parts.rope]
kind = "cable"
group = ["A-B", "B-C"]
axial_stiffness = 1e4
"""


def test_corners_and_lines_are_decompensated_by_name(tmp_path):
    """Nodes are those of the geometry, by name or number, also where the strips are meshed anew."""
    extra = 'size = 0.7\ndecompensate = ["C", 0, "rope", "border 1"]\ntransition = 0.5\ncompensation = 0.99\n'
    file = case(tmp_path, ROPE + PATTERNS.replace("[0, 0, 0]", "[0, 2, 0]") + extra)
    grid = 'kind = "grid"\nwidth = 6\nheight = 4\ncolumns = 6\nrows = 4\n'
    file.write_text(file.read_text().replace(grid, SAIL).replace('"grid"', '"sail"'))
    found = read_case(file)
    pattern = found.patterns.pattern(found.structure)
    structure = pattern.strips.structure
    corner, first, *names = pattern.decompensated
    assert structure.points[corner] == pytest.approx([6, 4, 0])
    assert structure.points[first] == pytest.approx(found.structure.points[0])
    assert set(names) == {"border 1", *(edge.name for edge in pattern.strips.edges if edge.line == "rope")}


def test_fabric_is_told_with_its_article(tmp_path):
    file = case(tmp_path)
    woven = 'kind = "woven"\nEt_warp = 500\nEt_weft = 400\nGt = 30\nnu = 0.3'
    file.write_text(file.read_text().replace('kind = "fabric"\nEt = 500\nnu = 0.3', woven))
    with pytest.raises(ValueError, match=r"material is a fabric of kind 'woven', give its warp"):
        read_case(file)


def test_case_in_millimetres_has_usual_allowances(tmp_path):
    """They were 0.02 and 0.05 mm, beside marks at every half millimetre."""
    file = case(tmp_path, PATTERNS.replace('allowances = { seam = "20 mm", border = "50 mm" }\n', ""))
    text = file.read_text().replace('length = "m"', 'length = "mm"').replace("width = 6", 'width = "6 m"')
    file.write_text(text.replace("height = 4", 'height = "4 m"').replace("Et = 500", 'Et = "500 kN/m"'))
    plan = read_case(file).patterns
    assert (plan.allowances.of_seams, plan.allowances.of_borders) == (20.0, 50.0)
    assert plan.sewn_width == 2160.0


def test_warp_of_a_strip_is_chosen(tmp_path):
    found = read_case(case(tmp_path, PATTERNS + 'warp = { "strip 2" = [1, 2, 0] }\n'))
    pattern = found.patterns.pattern(found.structure)
    along, aslant = (pattern.strips.structure.warp(f"strip {number}")[0] for number in (1, 2))
    assert np.abs(along) == pytest.approx([1, 0, 0], abs=1e-9)
    assert aslant == pytest.approx(np.array([1, 2, 0]) / np.sqrt(5), abs=1e-9)
    turned, straight = pattern.cloth["strip 2"], pattern.cloth["strip 1"]
    assert straight.length == pytest.approx(6 * pattern.compensation["strip 1"][0], rel=1e-9)
    assert turned.length == pytest.approx(10 / np.sqrt(5) * pattern.compensation["strip 2"][0], rel=1e-6)


def test_case_for_a_pattern_alone_is_sound(tmp_path):
    file = case(tmp_path)
    file.write_text(file.read_text().replace('[[stages]]\nname = "rest"\n', ""))
    code, words = said("check", file)
    assert code == 0
    assert "neither form_finding nor [[stages]]; `fx-membrane patterns` makes its cutting pattern" in words


@pytest.mark.parametrize(("tolerance", "copies"), [("", {}), ('\ncopy_tolerance = "150 mm"', {"strip 2": "strip 1"})])
def test_strips_alike_within_the_tolerance_are_cut_once(tmp_path, tolerance, copies):
    planes = "planes = [{ point = [0, 0.05, 0], normal = [0, 1, 0] }]\ncopies = true"
    found = read_case(case(tmp_path, f"\n[patterns]\n{planes}{tolerance}\n"))
    assert found.patterns.pattern(found.structure).strips.copies == copies
