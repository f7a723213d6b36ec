"""Material laws of the package, by their names.

`laws` has the contract that they keep; the energies are in `forms`.
"""

from __future__ import annotations

from typing import Any

from . import law_check
from .axial_law import Axial
from .fabrics import Fabric, OrthotropicFabric
from .foils import MooneyRivlin, NeoHooke

SHIPPED = (Fabric, OrthotropicFabric, NeoHooke, MooneyRivlin, Axial)


def check(what: str, material: Any, dimension: int) -> None:
    """Refuse what is no law for cells of a dimension; the energy of a law that is not `SHIPPED` is tried."""
    law_check.check(what, material, dimension, own=not is_shipped(material))


def is_shipped(material: Any) -> bool:
    """Return True for a law of the package, False for one of a user's own."""
    return type(material) in SHIPPED
