"""Laws of a user's own, and membranes of them."""

from dataclasses import dataclass
from typing import Any

import ufl

from fx_membrane import Law, Membrane
from fx_membrane.forms import wrinkling
from models import TRIANGLES


@dataclass(frozen=True)
class Foil(Law):
    """Isotropic, for membranes."""

    D: float

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + parameters.D * (ufl.inner(E, E) + ufl.tr(E) ** 2) / 2

    @property
    def stiffness(self):
        return self.D


def law(**members):
    """Instance of a law like Foil with other members."""
    kind = type("Mine", (), {"__annotations__": {"D": float}, "stiffness": 1.0, "energy": Foil.energy, **members})
    made: Any = dataclass(frozen=True)(kind)
    return made(2.0)


def membrane(material, **data):
    return Membrane(TRIANGLES, material, **data)


@dataclass(frozen=True)
class Stiffening:
    """Force EA E + k E^3, as of a rope."""

    EA: float
    k: float

    def energy(self, E, sigma0, parameters):
        e = E[0, 0]
        return sigma0[0, 0] * e + parameters.EA * e**2 / 2 + parameters.k * e**4 / 4

    @property
    def stiffness(self):
        return self.EA


def foil(E, sigma0, parameters):
    return ufl.inner(sigma0, E) + parameters.D * ufl.inner(E, E)


def own_state(E, sigma0, parameters, state):
    return wrinkling.Relaxed(wrinkling.isotropic(E, sigma0, 1.5 * parameters.D, 0.5).energy, state)
