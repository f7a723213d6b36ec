"""Values of case files that are no faults, but hardly meant: the check warns of them, each at its line."""

import pytest
from click.testing import CliRunner

from roof_case import ROOF, changed

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.cli import main
from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError

CHANGED = 'increments = 2\nchanges = [{ kind = "prestress factor", part = "roof", factor = 0.8 }]'
FOIL = 'kind = "neo-hooke"\nGt = "1 kN/m"'


def doubts(tmp_path, *replaced):
    """Doubts of the case with some texts replaced, and all that the check says."""
    (tmp_path / "a.toml").write_text(changed(ROOF, *replaced, count=1), encoding="utf-8")
    ended = CliRunner().invoke(main, ["check", str(tmp_path / "a.toml")])
    assert (ended.exit_code, "no faults" in ended.output) == (0, True)
    return read_case(tmp_path / "a.toml").doubts, ended.output


@pytest.mark.parametrize(
    ("replaced", "expected"),
    [
        ([('"12 MN"', '"12 mN"')], ["28: parts.\"edge, left\".axial_stiffness: '12 mN' is in thousandths of N"]),
        ([('"-100 Pa"', '"-100 mPa"')], ["62: stages.1.loads.1.pressure: '-100 mPa' is in thousandths of Pa"]),
        ([('"-0.6 kN/m2"', "-600")], ["54: stages.1.loads.0: this load stretches part 'roof', of about 4 by 4"]),
        ([('"500 kN/m"', "0.5")], ["54: stages.1.loads.0: this load stretches"]),
        (
            [
                ('kind = "fabric"\nEt = "500 kN/m"\nnu = 0.3', FOIL),
                ("warp = [1, 0, 0]", ""),
                ('["1 kN/m", 1500e-3]', "1"),
            ],
            [],
        ),
        ([("increments = 2", CHANGED)], []),
        ([("increments = 2", CHANGED.replace("0.8", "80"))], ["53: stages.1.changes.0.factor: 80 times the prestress"]),
        (
            [("increments = 2", CHANGED), ('prestress = ["1 kN/m", 1500e-3]', "")],
            ["stages.1.changes.0: part 'roof' has no prestress"],
        ),
        ([('force = "kN"', 'force = "mN"'), ('"12 MN"', '"12 mN"')], []),
    ],
)
def test_values_that_are_hardly_meant(replaced, expected, tmp_path):
    found, said = doubts(tmp_path, *replaced)
    assert len(found) >= len(expected)
    for words in expected:
        assert [line for line in found if words in line]
        assert words in said
    if not expected:
        assert not found


@pytest.mark.filterwarnings("always:Part .* is prestressed by")
def test_strain_of_the_prestress_is_told_in_check(tmp_path):
    said = doubts(tmp_path, ('"12 MN"', '"12 N"'))[1]
    assert "Part 'edge, left' is prestressed by" in said
    assert "Units are probably mixed" in said


def test_huge_grid_is_told_before_it_is_made(tmp_path, capfd):
    text = ROOF.replace("columns = 4", "columns = 100000").replace("rows = 4", "rows = 100000")
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    with pytest.raises(CaseError, match="too many cells"):
        read_case(tmp_path / "a.toml")
    assert "20000000000 triangles" in capfd.readouterr().err


@pytest.mark.parametrize(
    ("replaced", "keys"),
    [
        (
            [('group = "grid"', 'group = "gird"'), ('width = "4 m"', "width = -4")],
            ["geometry.width", "parts.roof.group"],
        ),
        (
            [('rim_of = "roof"\ncomponents', 'group = "rim"\ncomponents'), ("columns = 4", "columns = 0")],
            ["geometry.columns", "supports.0.group"],
        ),
        ([('group = "grid"\n', ""), ("rows = 4", "rows = 0.5")], ["geometry.rows", "parts.roof"]),
    ],
)
def test_groups_are_told_beside_faults_of_the_geometry(replaced, keys, tmp_path):
    (tmp_path / "a.toml").write_text(changed(ROOF, *replaced, count=1), encoding="utf-8")
    with pytest.raises(CaseError) as told:
        read_case(tmp_path / "a.toml")
    assert [line.split(": ")[1] for line in told.value.lines if "kind" not in line] == keys


@pytest.mark.parametrize("value", ["1,5 kN/m", "9**9**9**9 m", "100 daN/5cm", "nan m", "1e999 kN/m", "5 kN/m + 2 kN/m"])
def test_traps_of_units_are_told_at_their_line(value, tmp_path):
    (tmp_path / "a.toml").write_text(ROOF.replace('"500 kN/m"', f'"{value}"'), encoding="utf-8")
    with pytest.raises(CaseError, match=r"a\.toml:14: materials\.pvc\.Et: ") as told:
        read_case(tmp_path / "a.toml")
    assert len(told.value.lines) == 1
