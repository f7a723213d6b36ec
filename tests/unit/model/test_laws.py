"""Material laws that membranes and bars take, with their stiffness and their relaxed energy."""

from dataclasses import astuple, dataclass, replace

import numpy as np
import pytest
import ufl

from fx_membrane import Axial, Cable, Fabric, Mast, MooneyRivlin, NeoHooke
from fx_membrane.forms import wrinkling
from fx_membrane.results.strain_limits import elastic_strain
from own_laws import Foil, Stiffening, law, membrane, own_state

LINE = [[0, 1]]


def test_own_relaxed_energy_that_agrees_is_taken():
    relaxed = law(relaxed_energy=lambda self, E, s, p: wrinkling.isotropic(E, s, 1.5 * p.D, 0.5))
    assert membrane(relaxed).material is relaxed
    two_states = law(
        relaxed_energy=lambda self, E, s, p: own_state(E, s, p, ufl.conditional(ufl.lt(E[0, 0], -0.1), 1, 0))
    )
    assert membrane(two_states).material is two_states


@dataclass(frozen=True)
class Rope:
    """Cable whose relaxed energy has a modulus of its own."""

    EA: float
    relaxed: float

    def energy(self, E, sigma0, parameters):
        return sigma0[0, 0] * E[0, 0] + parameters.EA * E[0, 0] ** 2 / 2

    def relaxed_energy(self, E, sigma0, parameters):
        return wrinkling.cable(E, sigma0, parameters.relaxed)

    @property
    def stiffness(self):
        return self.EA


def test_relaxed_energy_of_a_cable():
    assert Cable(LINE, material=Rope(1e5, 1e5)).axial_stiffness == 1e5
    with pytest.raises(ValueError, match=r"stress 1\.2e\+04 in component 11.*\[\[0\.01\]\].*its energy has 3e\+03"):
        Cable(LINE, material=Rope(1e5, 1e6))


@pytest.mark.parametrize("material", [Foil(3.0), law(), NeoHooke(2.0), MooneyRivlin(2.0, 1.0), Fabric(1e5, 0.3)])
def test_law_of_a_membrane(material):
    assert membrane(material).material is material


@pytest.mark.parametrize("part", [Cable, Mast])
def test_law_of_a_bar(part):
    material = Stiffening(1e6, 1e8)
    bar = part(LINE, material=material)
    assert bar.material is material
    assert bar.axial_stiffness == 1e6
    linear = part(LINE, 2e6)
    assert linear.material == Axial(2e6)
    assert part(LINE, material=Axial(2e6)).axial_stiffness == 2e6
    assert part.from_modulus(LINE, 2e11, 1e-4).material == Axial(2e7)


def test_replaced_prestress_keeps_the_law():
    bar = replace(Cable(LINE, material=Stiffening(1e6, 1e8)), prestress=5.0)
    assert bar.material == Stiffening(1e6, 1e8)
    assert replace(Cable(LINE, 1e6), prestress=5.0).material == Axial(1e6)


@pytest.mark.parametrize(
    ("make", "expected"),
    [
        (lambda: NeoHooke.from_modulus(E=6e6, thickness=1e-3), NeoHooke(2e3)),
        (lambda: MooneyRivlin.from_moduli(C10=1e6, C01=2e5, thickness=1e-3), MooneyRivlin(1e3, 2e2)),
    ],
)
def test_moduli_times_thickness(make, expected):
    made = make()
    assert astuple(made) == pytest.approx(astuple(expected), rel=1e-15)
    assert made.stiffness == pytest.approx(expected.stiffness)


def test_compliance_is_none_without_one():
    assert elastic_strain(membrane(NeoHooke(2.0)), np.ones((3, 2, 2))) is None
    assert elastic_strain(Cable(LINE, 2.0), np.ones((3, 1, 1)))[0, 0, 0] == 0.5


@pytest.mark.parametrize(
    ("part", "carries"),
    [
        (membrane(Foil(1.0)), False),
        (membrane(Foil(1.0), compression_stiffness=1), True),
        (membrane(law(relaxed_energy=None)), True),
        (membrane(law(relaxed_energy=lambda *_: None)), True),
        (Cable(LINE, 1.0), False),
        (Cable(LINE, material=Stiffening(1.0, 1.0)), False),
        (Mast(LINE, 1.0), True),
    ],
)
def test_law_that_carries_compression(part, carries):
    assert part.carries_compression == carries


def unsymmetric(self, E, sigma0, parameters):
    return ufl.inner(sigma0, E) + parameters.D * E[0, 0] ** 2 + parameters.D * E[1, 1] ** 2 / 5 + E[0, 1] ** 2


def test_energy_with_a_direction_needs_a_warp():
    material = law(energy=unsymmetric)
    with pytest.raises(ValueError, match=r"^Membrane material.*warp.*weft"):
        membrane(material)
    assert membrane(material, warp=(1, 0, 0)).material is material
