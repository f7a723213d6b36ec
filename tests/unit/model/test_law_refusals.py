"""Material laws that are refused, each with its remedy."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

from fx_membrane import Axial, Cable, Fabric, Mast, NeoHooke
from fx_membrane._dolfinx import abstract_mesh
from fx_membrane.forms import wrinkling
from own_laws import Foil, Stiffening, foil, law, membrane, own_state

LINE = [[0, 1]]
AREA = abstract_mesh(2)


@dataclass(frozen=True)
class Private(Foil):
    _k: float = 1.0
    energy = Foil.energy


def test_field_with_an_underscore():
    with pytest.raises(ValueError, match=r"Private has a field '_k'; give it a name without an underscore"):
        membrane(Private(1.0))


class NotFrozen:
    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E)

    stiffness = 1.0


@dataclass(frozen=True)
class Text(Foil):
    name: str = "north"
    energy = Foil.energy


def ogden(under_the_root=0.0, exponent=2.5):
    """Energy in the principal stretches, whose squares are the roots of a quadratic equation."""

    def energy(self, E, sigma0, parameters):
        C = 2 * E + ufl.Identity(2)
        t, d = ufl.tr(C), ufl.det(C)
        r = ufl.sqrt(t**2 / 4 - d + under_the_root)
        stretches = (t / 2 + r) ** (exponent / 2) + (t / 2 - r) ** (exponent / 2) + d ** (-exponent / 2)
        return ufl.inner(sigma0, E) + parameters.D * (stretches - 3)

    return energy


def guarded(self, E, sigma0, parameters):
    """Energy without stiffness at E = 0 itself, where the condition takes the other branch."""
    return ufl.inner(sigma0, E) + parameters.D * ufl.conditional(ufl.gt(ufl.inner(E, E), 0), ufl.inner(E, E), 0)


def ufl_without_stiffness(self, E, sigma0, parameters):
    return ufl.inner(sigma0, E) + parameters.D * ufl.inner(E, E) ** 2


@dataclass(frozen=True)
class Loose:
    """Law without a stiffness."""

    k: float
    energy = Foil.energy


REFUSED = [
    (Loose(1.0), "Loose stiffness is missing; give a typical stiffness"),
    (law(energy=ogden()), r"derivatives at E = 0, at equal stretches, that are not numbers.*tr\(C\).*under the root"),
    (law(energy=lambda self, E, s, p: ufl.inner(s, E) + ufl.inner(E, E) ** 0.9), "derivatives.*not numbers"),
    (law(energy=guarded), "not positive"),
    (law(strain_limit="5 %"), r"Mine strain_limit is the text '5 %'"),
    (law(strain_limit=-0.05), r"Mine strain_limit is -0\.05; it must be positive"),
    (
        law(relaxed_energy=lambda self, E, s, p: ufl.tr(E)),
        r"relaxed_energy\(.*\) returns .*; return .*Relaxed.*or None",
    ),
    (
        law(relaxed_energy=lambda self, E, s, p: (ufl.tr(E), 0)),
        r"relaxed_energy\(.*\) returns .*; return .*Relaxed.*or None",
    ),
    (law(relaxed_energy=lambda self, E: None), r"relaxed_energy takes \(E\); let it take \(E, sigma0, parameters\)"),
    (
        law(relaxed_energy=lambda self, E, s, p: wrinkling.isotropic(E, 0 * s, 200 * p.D, 0.0)),
        r"relaxed_energy\(.*\) has the stress .* in component 11 at the taut strain .* under the prestress .* of a "
        "trial, but its energy has .*; .*take the same moduli and sigma0",
    ),
    (
        law(relaxed_energy=lambda self, E, s, p: wrinkling.isotropic(E, s, 20 * p.D, 0.0)),
        r"has the stress .* in component 11 at the taut strain \[\[0\.01, .*its energy has",
    ),
    (
        law(relaxed_energy=lambda self, E, s, p: own_state(E, s, p, 7.0)),
        r"has the state 7 at the strain .*; give fx_membrane\.forms\.wrinkling\.TAUT, WRINKLED or SLACK",
    ),
    (
        law(relaxed_energy=lambda self, E, s, p: own_state(E, s, p, ufl.conditional(ufl.lt(E[0, 0], -0.1), 3, 0))),
        r"has the state 3 at the strain \[\[-0\.2, .*; give fx_membrane\.forms\.wrinkling\.TAUT",
    ),
    (law(relaxed_energy=lambda self, E, s, p: own_state(E, s, p, E)), r"whose state is a tensor of shape \(2, 2\)"),
    (law(strain=lambda self, s: s[:, 0]), r"strain\(stress\) has the shape \(3, 2\).*\(3, 2, 2\).*same shape"),
    (law(strain=lambda self, s: s / self.EA), r"strain\(stress\) raises AttributeError"),
    (Foil, "brackets"),
    (object(), "give a Fabric, .* or a law of your own"),
    (Axial(1.0), "a law of bars; give one of membranes"),
    (NotFrozen(), r"a NotFrozen, .*@dataclass\(frozen=True\)"),
    (Text(1.0), "Text name is the text 'north'; give a number"),
    (law(stiffness=-1.0), r"Mine stiffness is -1\.0; it must be positive"),
    (law(stiffness=None), "Mine stiffness must be a number"),
    (law(stiffness=lambda self: 1.0), "Mine stiffness is a method; write @property"),
    (law(stiffness=property(lambda self: self.EA)), "Mine stiffness raises AttributeError.*EA.*give"),
    (law(directed="yes"), "Mine directed is 'yes'; give True or False"),
    (law(relaxed_energy=3), "Mine relaxed_energy is 3; give a method, or None"),
    (
        law(energy=lambda self, E, s, p: E),
        r"Mine\(D=2\.0\), whose.* returns a tensor of shape \(2, 2\); return a scalar",
    ),
    (law(energy=lambda self, E, s, p: ufl.diag_vector(E)), r"returns a vector of shape \(2,\); return a scalar"),
    (
        law(energy=lambda self, E, s, p: ufl.as_ufl(1.0) * ufl.dx(domain=AREA)),
        "returns an integral; return.*without dx",
    ),
    (law(energy=lambda self, E, s, p: 3.0), r"returns 3\.0; return a scalar in UFL"),
    (law(energy=lambda self, E, s, p: p.EA * E[0, 0]), "raises AttributeError.*E and sigma0.*parameters the numbers D"),
    (law(energy=lambda self, E, s, p: p.D[0] * E[0, 0]), "raises .*E and sigma0.*parameters the numbers D"),
    (law(energy=lambda self, E: E[0, 0]), r"energy takes \(E\); let it take \(E, sigma0, parameters\)"),
    (law(energy=lambda self, E, s, p, q: E[0, 0]), r"energy takes \(E, s, p, q\); let it take"),
    (law(energy=lambda self, E, s, p: float(p.D) * foil(E, s, p)), "raises TypeError.*ufl.sqrt.*float"),
    (law(energy=lambda self, E, s, p: float(E[0, 0]) * foil(E, s, p)), "raises TypeError.*ufl.sqrt.*float"),
    (law(energy=lambda self, E, s, p: np.exp(p.D) * foil(E, s, p)), "raises TypeError.*ufl.exp.*NumPy"),
    (law(energy=lambda self, E, s, p: foil(E, s, p) if p.D > 1 else 0), "raises .*ufl.conditional.* if"),
    (law(energy=lambda self, E, s, p: (1 + (p.D == 2)) * foil(E, s, p)), "Python's own comparison.*ufl.conditional"),
    (
        law(energy=ufl_without_stiffness),
        r"second derivative 0 at E = 0 in.*\[\[1\.0, 0\.0\], .*stiffness.*; give an energy",
    ),
    (law(energy=lambda self, E, s, p: p.D * ufl.inner(E, E)), r"add inner\(sigma0, E\)"),
    (law(energy=lambda self, E, s, p: ufl.inner(s, E) + ufl.tr(E)), r"add inner\(sigma0, E\)"),
    (law(energy=lambda self, E, s, p: ufl.inner(s, E) - p.D * ufl.inner(E, E)), "not positive"),
    (law(energy=lambda self, E, s, p: ufl.inner(s, E) + p.D * ufl.tr(E) ** 2), "not positive"),
    (law(energy=lambda self, E, s, p: ufl.inner(s, E) + ufl.ln(ufl.tr(E))), "mend it|not a finite"),
]


@pytest.mark.parametrize(("material", "words"), REFUSED)
def test_refused_in_a_membrane(material, words):
    with pytest.raises(ValueError, match=f"^Membrane material.*{words}") as refusal:
        membrane(material)
    assert str(refusal.value).endswith(".")


@pytest.mark.parametrize(
    "material", [law(energy=ogden(1e-12)), law(strain_limit=0.5), law(strain=lambda self, s: None)]
)
def test_remedies_are_taken(material):
    assert membrane(material).material is material


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"material": Fabric(1.0, 0.3)}, "law.*membranes.*one.*bars"),
        ({"material": Foil}, "give an Axial, with brackets"),
        ({"material": law(energy=lambda self, E, s, p: ufl.inner(s, E) + E[1, 1] ** 2)}, "energy.* raises"),
        ({"material": law(energy=lambda self, E, s, p: float(p.D) * foil(E, s, p))}, "raises TypeError.*ufl.sqrt"),
        ({"material": law(energy=lambda self, E, s, p: s)}, r"returns a tensor of shape \(1, 1\)"),
        ({"axial_stiffness": 2e6, "material": Axial(1e6)}, "axial_stiffness is 2000000.0.*give one.*two"),
        ({}, "axial_stiffness.*material"),
    ],
)
@pytest.mark.parametrize("part", [Cable, Mast])
def test_refused_in_a_bar(part, data, words):
    with pytest.raises(ValueError, match=f"^{part.__name__} .*{words}"):
        part(LINE, **data)


@pytest.mark.parametrize("prestress", [-2.5, [[1.0, 3.5], [3.5, 1.0]]])
def test_excess_that_no_stretch_takes_up(prestress):
    """The force of a neo-Hookean foil along one direction is below Gt E for 2nd Piola-Kirchhoff stresses: below 2."""
    with pytest.raises(ValueError, match=r"^Membrane prestress is -2\.5.*cell 0.*excess.*no stretch.*NeoHooke"):
        membrane(NeoHooke(2.0), prestress=prestress, warp=(1, 0, 0))
    assert membrane(NeoHooke(2.0), prestress=-1.9).carries_compression is False
    assert membrane(Fabric(2.0, 0.3), prestress=-2.5).carries_compression is False
    assert membrane(NeoHooke(2.0), prestress=-2.5, compression_stiffness=1).carries_compression
    assert Cable(LINE, prestress=-1e3, material=Stiffening(1.0, 1.0)).axial_stiffness == 1.0
