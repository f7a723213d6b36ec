"""Natural stretches and changes in case files."""

import numpy as np
import pytest

from fx_membrane import Analysis, LengthChange, NaturalStretch, PrestressFactor, TemperatureChange
from roof_case import ROOF, changed

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError
from fx_membrane.files.cases.units import Units

CHANGES = """
[[stages]]
name = "cold"
after = "lift"
  [[stages.changes]]
  kind = "temperature"
  part = "roof"
  difference = "-30 K"
  expansion = ["1.2e-5 1/K", 2e-5]
  [[stages.changes]]
  kind = "length"
  part = "edge, left"
  change = "-3 cm"
  [[stages.changes]]
  kind = "stretch"
  part = "roof"
  stretch = [0.999, 1.0]
  where = { x = [0, 2] }
  [[stages.changes]]
  kind = "prestress factor"
  part = "edge, left"
  factor = 0.9
  cells = [0, 1]
"""


def case(tmp_path, changes=CHANGES, replaced=()):
    text = ROOF.replace("\n[output]", f"{changes}\n[output]")
    (tmp_path / "roof.toml").write_text(changed(text, *replaced))
    return read_case(tmp_path / "roof.toml")


def test_case_gives_the_changes_of_a_script(tmp_path):
    natural = ("warp = [1, 0, 0]", "warp = [1, 0, 0]\nnatural_stretch = [0.998, 0.999]")
    found = case(tmp_path, replaced=[natural])
    assert np.array_equal(found.structure.parts["roof"].natural_tensors()[0], np.diag([0.998, 0.999]))
    roof = found.structure.parts["roof"]
    east = np.flatnonzero(found.structure.points[roof.cells].mean(axis=1)[:, 0] >= 0)
    assert list(found.stages[-1].changes) == [
        TemperatureChange(-30.0, "roof", (1.2e-5, 2e-5)),
        LengthChange(-0.03, "edge, left"),
        NaturalStretch((0.999, 1.0), "roof", east),
        PrestressFactor(0.9, "edge, left", [0, 1]),
    ]
    assert Analysis(found.structure, found.solver).run(found.stages)["cold"].equilibrium.residual < 1e-6


@pytest.mark.parametrize(
    ("replaced", "words"),
    [
        (('difference = "-30 K"', 'difference = "-30 degC"'), r"difference: .*temperature, not a difference.*'30 K'"),
        (('difference = "-30 K"', 'difference = "-30 m"'), r"difference: .*no unit of this quantity"),
        (('["1.2e-5 1/K", 2e-5]', '"12"'), r"expansion.*|changes.*3\.6e\+04"),
        (('change = "-3 cm"', 'change = "-3 K"'), r"changes\.1\.change: .*'K' is no unit of this quantity"),
        (('part = "edge, left"\n  change', 'part = "roof"\n  change'), r"changes\.1\.part: .*no cable or mast"),
        (("stretch = [0.999, 1.0]", "stretch = [0.999, 1.0, 1.0]"), r"changes\.2\.stretch: .*list of length 3"),
        (("stretch = [0.999, 1.0]", "stretch = 0.1"), r"changes\.2\.stretch: .*0\.1 times as long"),
        (("factor = 0.9", "factor = -0.9"), r"changes\.3\.factor: .*-0\.9"),
        (("cells = [0, 1]\n\n[output]", "cells = [0, 99]\n\n[output]"), r"changes\.3\.cells\.1: 99 is not there"),
        (('kind = "length"', 'kind = "lengths"'), r"changes\.1\.kind: 'lengths' is not one of .*'length' may be meant"),
        (("warp = [1, 0, 0]", "natural_stretch = 3"), r"parts\.roof\.natural_stretch: .*3 times as long"),
    ],
)
def test_faults_of_changes(tmp_path, replaced, words):
    with pytest.raises(CaseError, match=words):
        case(tmp_path, replaced=[replaced])


@pytest.mark.parametrize(
    ("replaced", "words"),
    [
        (('"-3 cm"', '"-3 m"'), r"roof\.toml:\d+: stages\.2\.changes\.1: Part 'edge, left' after a change of kind"),
        (("stretch = [0.999, 1.0]", "stretch = [0.52, 1.0]"), r"stages\.2\.changes\.2: Part 'roof' after a change of"),
    ],
)
def test_changes_beyond_all_sense_are_told_before_a_run(tmp_path, replaced, words):
    """Also those that add up along stages; the faults of the next stage stay untold, as they follow from these."""
    natural = ("warp = [1, 0, 0]", "warp = [1, 0, 0]\nnatural_stretch = [0.9, 0.9]")
    later = CHANGES.replace('"lift"', '"cold"').replace('"cold"', '"colder"', 1)
    with pytest.raises(CaseError, match=words) as told:
        case(tmp_path, CHANGES + later, [replaced, natural])
    assert len(told.value.lines) == 1


def test_faults_of_changes_are_told_at_once(tmp_path):
    with pytest.raises(CaseError) as told:
        case(tmp_path, replaced=[("factor = 0.9", "factor = -1"), ('"-3 cm"', '"-3 kN"'), ('"-30 K"', '"-30 kN"')])
    assert len(told.value.lines) == 3


@pytest.mark.parametrize(
    ("value", "dimension", "expected"),
    [("30 K", "K", 30.0), (-30, "K", -30.0), ("1.2e-5 1/K", "1/K", 1.2e-5), ("12e-6 1 / K", "1/K", 12e-6)],
)
def test_quantities_of_temperature(value, dimension, expected):
    assert Units("kN", "m").number(value, dimension) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("value", ["30 degC", "30 degF", "30 celsius", "30 °C", "30 kN"])
def test_temperatures_with_a_zero_of_their_own(value):
    with pytest.raises(ValueError, match=r"30 K|kN/m2"):
        Units("kN", "m").number(value, "K")
    with pytest.raises(ValueError, match=r"1\.2e-5 1/K|kN/m2"):
        Units("kN", "m").number(value.replace("30 ", "30 1/"), "1/K")
