"""Chambers, their gas and the air around in case files."""

import pytest

from fx_membrane import Ambient, Analysis, Chamber, GasAmount, GasPressure, GasVolume, Seal
from fx_membrane.files.report.gas_actions import gas_action

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError
from roof_case import changed

CUSHION = """
format = 1
units = { force = "kN", length = "m" }

[geometry]
kind = "points"
points = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, 0.3], [0, 0, -0.3]]

[materials.foil]
kind = "fabric"
Et = 160
nu = 0.4

[parts.top]
kind = "membrane"
material = "foil"
cells = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]

[parts.bottom]
kind = "membrane"
material = "foil"
cells = [[0, 1, 5], [1, 2, 5], [2, 3, 5], [3, 0, 5]]

[[supports]]
nodes = [0, 1, 2, 3]

[chambers.cushion]
parts = { top = 1, bottom = -1 }
exponent = 1.4

[[stages]]
name = "inflate"
  [[stages.changes]]
  kind = "gas pressure"
  chamber = "cushion"
  pressure = "300 Pa"

[[stages]]
name = "seal"
after = "inflate"
  [[stages.changes]]
  kind = "air"
  pressure = "1013.25 hPa"
  temperature = 293.15
  [[stages.changes]]
  kind = "seal"
  chamber = "cushion"

[[stages]]
name = "fill"
  [[stages.changes]]
  kind = "gas volume"
  chamber = "cushion"
  volume = "900 dm3"

[[stages]]
name = "amount"
after = "seal"
  [[stages.changes]]
  kind = "gas amount"
  chamber = "cushion"
  pressure = 101.6
  volume = 0.85
"""


def case(tmp_path, *changes):
    (tmp_path / "cushion.toml").write_text(changed(CUSHION, *changes))
    return read_case(tmp_path / "cushion.toml")


def test_case_gives_the_gas_of_a_script(tmp_path):
    found = case(tmp_path)
    assert found.structure.chambers == {"cushion": Chamber({"top": 1, "bottom": -1}, 1.4)}
    (fan,), (air, seal), (given,), (amount,) = (stage.changes for stage in found.stages)
    assert (type(fan), fan.chamber, fan.pressure) == (GasPressure, "cushion", pytest.approx(0.3))
    assert (air.pressure, air.temperature) == pytest.approx((101.325, 293.15))
    assert type(air) is Ambient
    assert seal == Seal("cushion")
    assert (type(given), given.volume) == (GasVolume, pytest.approx(0.9))
    assert amount == GasAmount(101.6, 0.85, "cushion")
    states = Analysis(found.structure, found.solver).run(found.stages)
    assert states["seal"].chambers["cushion"].pressure == pytest.approx(0.3)
    assert states["fill"].chambers["cushion"].volume == pytest.approx(0.9)
    assert gas_action(fan, "kN", "m") == "Pressure 0.3 kN/m2 in cushion, open"


@pytest.mark.parametrize(
    ("replaced", "words"),
    [
        (("parts = { top = 1, bottom = -1 }", 'parts = ["top"]'), r"chambers\.cushion: .*is not closed: it has a hole"),
        (("top = 1, bottom = -1", "top = -1, bottom = 1"), r"chambers\.cushion: .*is inside out"),
        (("top = 1, bottom = -1", "top = 1, lid = -1"), r"chambers\.cushion: .*has the part 'lid', which is no membr"),
        (("exponent = 1.4", "exponent = 0.4"), r"chambers\.cushion\.exponent: exponent is 0\.4"),
        (('volume = "900 dm3"', "volume = -1"), r"stages\.2\.changes\.0\.volume: volume is -1"),
        (('volume = "900 dm3"', 'volume = "900 dm2"'), r"volume: .*'dm2' is no unit of this quantity"),
        (
            ('kind = "seal"\n  chamber = "cushion"', 'kind = "seal"\n  chamber = "cusion"'),
            r"stages\.1\.changes\.1\.chamber: there is no chamber 'cusion'; 'cushion' may be meant",
        ),
        (('kind = "seal"', 'kind = "seel"'), r"'seel' is not one of .*'seal' may be meant"),
        (("pressure = 101.6", "pressure = -3"), r"stages\.3\.changes\.0\.pressure: pressure is -3"),
    ],
)
def test_faults(tmp_path, replaced, words):
    with pytest.raises(CaseError, match=words):
        case(tmp_path, replaced)


@pytest.mark.parametrize(
    ("replaced", "words"),
    [
        (("pressure = 101.6", "pressure = 0.3"), r"toml:56: stages\.3: .*'gas amount'.*looks like a gauge pressure"),
        (('pressure = "1013.25 hPa"\n', ""), r"stages\.1: .*temperature before a pressure"),
        (("[chambers", '[solver]\nmethod = "conjugate gradient"\n\n[chambers'), r"solver\.method: .*finds no pressure"),
    ],
)
def test_gas_that_no_run_would_take_is_told_by_the_check(tmp_path, replaced, words):
    with pytest.raises(CaseError, match=words):
        case(tmp_path, replaced)


def test_temperature_of_the_air_in_degrees(tmp_path):
    found = case(tmp_path, ("temperature = 293.15", 'temperature = "20 degC"'))
    assert found.stages[1].changes[0].temperature == pytest.approx(293.15)


def test_faults_of_chambers_come_beside_those_of_parts(tmp_path):
    with pytest.raises(CaseError) as caught:
        case(
            tmp_path,
            ("top = 1, bottom = -1", "top = 1, botom = -1"),
            ("exponent = 1.4", "exponent = 0.4"),
            ("Et = 160", "Et = -1"),
        )
    places = [line.split(": ")[1] for line in caught.value.lines]
    assert places == ["materials.foil.Et", "chambers.cushion.parts", "chambers.cushion.exponent"]
