"""Laws derived from others, and digests of laws."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

from fx_membrane import Fabric, NeoHooke, OrthotropicFabric
from fx_membrane.model import laws
from fx_membrane.model.digests import fingerprints
from fx_membrane.model.structure import Structure
from models import POINTS
from own_laws import Foil, law, membrane


@dataclass(frozen=True)
class Silent(Fabric):
    exponent: float = 2.0


class Bare(OrthotropicFabric):
    pass


@dataclass(frozen=True)
class WithStrain(Fabric):
    def strain(self, stress):
        return stress


@pytest.mark.parametrize(
    ("material", "parent"),
    [(Silent(1e5, 0.3), "Fabric"), (Bare(1e5, 1e5, 0.3, 1e4), "OrthotropicFabric"), (WithStrain(1e5, 0.3), "Fabric")],
)
def test_inherited_energy_is_refused(material, parent):
    with pytest.raises(ValueError, match=rf"derived.*{parent}, .*\(energy = {parent}\.energy.*meant\)"):
        membrane(material, warp=(1, 0, 0))


@dataclass(frozen=True)
class Stiffer(Fabric):
    """Twice the energy, and nothing else of its own."""

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + 2 * Fabric.energy(self, E, 0 * sigma0, parameters)


def test_members_of_another_energy_do_not_count():
    part = membrane(Stiffer(1e5, 0.3))
    assert laws.member(part.material, "relaxed_energy") is None
    assert laws.member(part.material, "strain") is None
    assert laws.strain_limit(part.material) == np.inf
    assert laws.member(Fabric(1e5, 0.3), "relaxed_energy") is not None


def digests(material):
    return fingerprints(Structure(POINTS, {"foil": membrane(material)}))


def test_energy_of_limited_range_has_a_digest():
    """As of a foil of limited stretch: a logarithm of a negative number at large strains."""

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) - parameters.D * ufl.ln(1 - ufl.inner(E, E) / 2)

    values = laws.energies(law(energy=energy), 2)
    assert "none" in values
    assert len(set(values)) > 8
    assert len(digests(law(energy=energy))["energy of part 'foil'"]) == 64


def test_parameters_and_energy_are_in_the_digest():
    def changed(one, other):
        one, other = digests(one), digests(other)
        return {name for name in one | other if one.get(name) != other.get(name)}

    assert changed(Foil(1.0), Foil(1)) == set()
    assert changed(Foil(1.0), Foil(1.5)) == {"material of part 'foil'", "energy of part 'foil'"}
    again = law(energy=lambda self, E, s, p: Foil.energy(self, E, s, p) + 1e-6 * ufl.tr(E) ** 4)
    assert changed(law(), again) == {"energy of part 'foil'"}
    assert "energy of part 'foil'" not in digests(NeoHooke(1.0))
