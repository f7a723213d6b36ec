"""Rubber balloon past the largest pressure of its gas: along the path of a fan, and with a given volume."""

import numpy as np
import pytest

from balloons import eighth_of_a_balloon
from cushions import run
from fx_membrane import (
    Chamber,
    GasPressure,
    GasVolume,
    NeoHooke,
    Stage,
    equilibrium_path,
    stability,
)


def balloon():
    """Eighth of a rubber balloon."""
    return eighth_of_a_balloon(4, NeoHooke(1e3), chambers={"gas": Chamber("balloon", rigid_walls=True)})


@pytest.mark.mpi
def test_path_of_a_fan_passes_the_largest_pressure():
    """Beyond it the balloon is unstable on a fan; with the volume given there is the same state."""
    structure = balloon()
    pole = int(structure.points[:, 2].argmax())
    blow = Stage("blow", changes=[GasPressure(1200.0, "gas")], increments=8)
    path = equilibrium_path(structure, blow, None, (pole, "z", 1.2))
    assert len(path.limit_points) == 1
    assert (path.negative_pivots[[1, -1]] == [0, 1]).all()
    found = path.points[-1].chambers["gas"]
    assert found.pressure == pytest.approx(1200.0 * path.points[-1].load_factor)
    grow = Stage("grow", changes=[GasVolume(found.volume, "gas")], increments=2)
    assert run(grow, structure=structure)["grow"].chambers["gas"].pressure == pytest.approx(found.pressure, rel=1e-7)


@pytest.mark.mpi
def test_volume_passes_the_largest_pressure():
    """A rubber balloon of given volume is stable beyond its largest pressure, and found in one stage."""
    structure = balloon()
    grow = Stage("grow", changes=[GasVolume(8 * np.pi / 6, "gas")], increments=4)
    state = run(grow, structure=structure)["grow"]
    pressures = [entry.chambers["gas"].pressure for entry in state.increments]
    assert pressures[-1] == pytest.approx(2e3 * (1 / 2 - 2.0**-7), rel=0.03)
    assert max(pressures) > 1.2 * pressures[-1]
    assert stability(state).stable
