"""Laws in other places and of derived classes, and the reason of a refusal."""

from dataclasses import dataclass

import pytest
import ufl

from fx_membrane import Axial, Cable, Fabric, Membrane


def test_law_in_the_place_of_a_stiffness_is_told():
    with pytest.raises(ValueError, match=r"axial_stiffness is the law Axial.*give that as material="):
        Cable([[0, 1]], Axial(1e5))


def test_derived_law_with_a_further_field_may_call_its_parent():
    @dataclass(frozen=True)
    class Marked(Fabric):
        mark: float = 1.0

        def energy(self, E, sigma0, parameters):
            return Fabric.energy(self, E, sigma0, parameters)

        def relaxed_energy(self, E, sigma0, parameters):
            return Fabric.relaxed_energy(self, E, sigma0, parameters)

    law = Marked(1e5, 0.3)
    assert Membrane([[0, 1, 2]], law).material is law


def test_energy_that_loses_small_strains_is_told_with_that_reason():
    @dataclass(frozen=True)
    class Lost:
        k: float
        stiffness = 1e5
        dimension = 1

        def energy(self, E, sigma0, parameters):
            lost = -1e14 * ufl.ln(1 - parameters.k * E[0, 0] ** 2 / 2e14)  # k E^2 / 2, but for its digits
            return ufl.inner(sigma0, E) + lost

    with pytest.raises(ValueError, match=r"second derivative 1e\+05 is positive.*loses small strains in rounding"):
        Cable([[0, 1]], material=Lost(1e5))
