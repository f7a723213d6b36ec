"""Gas that no chamber can hold is told with every state of it."""

import pytest

from cushions import AIR, INFLATE, SEAL, airbag, cushion, run
from fx_membrane import (
    Ambient,
    Chamber,
    CrushedGasWarning,
    GasPressure,
    Stage,
    equilibrium_path,
    load_results,
    save_results,
)
from fx_membrane.results.state_checks import checks


def told(state):
    return [str(remark) for remark in state.remarks if remark.category is CrushedGasWarning]


def volume_check(state):
    return next(check for check in checks(state, length="m") if check.name == "volume of gas in 'gas'")


@pytest.mark.filterwarnings("ignore::fx_membrane.UnstableStateWarning", "ignore::fx_membrane.LargeStrainWarning")
def test_volume_and_absolute_pressure_below_zero(tmp_path):
    with pytest.warns(CrushedGasWarning, match="Stage 'suck': the volume of chamber 'gas' is -3.* hold them apart"):
        states = run(Stage("suck", changes=[Ambient(AIR), GasPressure(-1.2 * AIR, "gas")], increments=2))
    volume, pressure = told(states["suck"])
    assert "absolute pressure -2.026e+04, which no gas has" in pressure
    assert volume_check(states["suck"]).verdict.value == "WARN"
    save_results(states, tmp_path / "gas.fxm")
    assert told(load_results(tmp_path / "gas.fxm")["suck"]) == [volume, pressure]


def test_usual_gas_passes_without_a_word():
    states = run(INFLATE, SEAL)
    assert not told(states["seal"])
    assert volume_check(states["seal"]).verdict.value == "PASS"
    assert volume_check(states["seal"]).found.endswith(" m3")


def test_flat_chamber_is_not_crushed():
    flat = cushion(height=0.0, separate=[("top", "bottom")], chambers={"gas": Chamber({"top": 1, "bottom": -1})})
    assert not told(run(Stage("rest", changes=[GasPressure(0.0, "gas")]), structure=flat)["rest"])


@pytest.mark.mpi
def test_points_of_a_path_have_the_gas():
    path = equilibrium_path(airbag(), Stage("inflate", changes=[GasPressure(300.0, "gas")], increments=2))
    for number, point in enumerate(path.points):
        assert point.chambers == path.state(number).chambers
    assert path.points[-1].chambers["gas"].pressure == pytest.approx(300.0)
