"""Elasticity of laws at rest: by the formula of each, and asked once for equal laws."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

from fx_membrane import Fabric, NeoHooke, OrthotropicFabric
from fx_membrane.model import laws


@pytest.mark.parametrize(
    ("law", "wanted"),
    [
        (Fabric(5e5, 0.3), [5e5 / 0.91, 5e5 * 0.3 / 0.91, 5e5 / 0.91, 5e5 / 2.6]),
        (OrthotropicFabric(6e5, 4e5, 0.3, 2e4), [6e5 / 0.94, 12e4 / 0.94, 4e5 / 0.94, 2e4]),
        (NeoHooke(1e5), [4e5, 2e5, 4e5, 1e5]),
    ],
)
def test_entries(law, wanted):
    found = laws.elasticity(law, 2)
    entries = [found[0, 0, 0, 0], found[0, 0, 1, 1], found[1, 1, 1, 1], found[0, 1, 0, 1]]
    assert entries == pytest.approx(wanted, rel=1e-6)
    np.testing.assert_array_equal(found, found.transpose(2, 3, 0, 1))
    np.testing.assert_array_equal(found, found.transpose(1, 0, 2, 3))


@dataclass(frozen=True)
class Counted:
    """Linear law that counts how often its energy is asked."""

    k: float
    asked = 0

    @property
    def stiffness(self):
        return self.k

    def energy(self, E, sigma0, parameters):
        Counted.asked += 1
        return 0.5 * parameters.k * ufl.inner(E, E) + ufl.inner(sigma0, E)


def test_equal_laws_are_asked_once():
    """Each strip of a pattern took half a second for the law that all of them share."""
    first = laws.elasticity(Counted(3e5), 2)
    asked = Counted.asked
    assert asked > 0
    assert laws.elasticity(Counted(3e5), 2) is first
    assert Counted.asked == asked
    assert not first.flags.writeable
    assert laws.elasticity(Counted(4e5), 2)[0, 0, 0, 0] == pytest.approx(4e5, rel=1e-9)
