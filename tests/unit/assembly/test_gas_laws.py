"""Laws of enclosed gas: each is the derivative of its energy, and goes on smoothly where the gas is crushed."""

import numpy as np
import pytest

from fx_membrane.assembly.gas_laws import Enclosed, Fan


@pytest.mark.parametrize("law", [Enclosed(1e5, 0.9, 1.0, 1e5), Enclosed(1e5, 0.9, 1.4, 9e4), Fan(300.0)])
@pytest.mark.parametrize("volume", [1.0, 0.3, 0.02, 0.005, 0.0, -0.1])
def test_derivatives(law, volume):
    h = 1e-4 * max(abs(volume), 1e-3)
    slope = (law.energy(volume + h) - law.energy(volume - h)) / (2 * h)
    stiffness = (law.force(volume + h) - law.force(volume - h)) / (2 * h)
    assert law.force(volume) == pytest.approx(slope, rel=1e-5, abs=1e-3)
    assert law.stiffness(volume) == pytest.approx(stiffness, rel=1e-5)


def test_energy_is_smooth_where_gas_is_crushed():
    law = Enclosed(1e5, 0.9, 1.4, 1e5)
    below, above = law.least * (1 - 1e-9), law.least * (1 + 1e-9)
    for value in (law.energy, law.force, law.stiffness):
        assert value(below) == pytest.approx(value(above), rel=1e-7)


def test_polytropic_tends_to_isothermal():
    near, limit = Enclosed(1e5, 0.9, 1 + 1e-7, 1e5), Enclosed(1e5, 0.9, 1.0, 1e5)
    for volume in (0.5, 1.5):
        assert near.energy(volume) == pytest.approx(limit.energy(volume), rel=1e-5)
        assert near.force(volume) == pytest.approx(limit.force(volume), rel=1e-5)
    assert np.isclose(limit.energy(0.9), 0.0)


@pytest.mark.parametrize("law", [Enclosed(1e5, 0.9, 1.0, 1e5), Enclosed(1e5, 0.9, 1.4, 9e4), Fan(300.0)])
@pytest.mark.parametrize("volume", [1.0, 0.9, 0.3])
def test_size_bounds_the_rounding_of_energy_differences(law, volume):
    """Volumes that differ by rounding alone have energies that differ by no more than rounding of the size."""
    near = volume * (1 + np.arange(-4, 5) * 2.0**-52)
    energies = np.array([law.energy(value) for value in near])
    assert np.ptp(energies) <= 20 * np.finfo(float).eps * law.size(volume)
