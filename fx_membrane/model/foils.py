"""Laws of foils at any strain. Moduli are per width (modulus times thickness)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from ..checks.validation import not_negative, positive, store
from ..forms import hyperelasticity


@dataclass(frozen=True)
class NeoHooke:
    """Incompressible neo-Hookean membrane in plane stress, for foils at any strain.

    Without prestress its relaxed energy is that of simple tension, W(l, l^-1/2) with the larger stretch l.

    Args:
        Gt: Shear modulus times thickness, a third of Young's modulus times thickness [N/m].

    Raises:
        ValueError: The modulus is not positive.

    Source:
        `forms.hyperelasticity`; A. C. Pipkin (1986), D. J. Steigmann (1990), see `forms.wrinkling`.

    Example:
        >>> foil = NeoHooke.from_modulus(E=3e6, thickness=1e-3)
        >>> foil, round(foil.stiffness, 6)
        (NeoHooke(Gt=1000.0), 3000.0)
    """

    dimension: ClassVar[int] = 2
    directed: ClassVar[bool] = False
    Gt: float

    def __post_init__(self) -> None:
        store(self, positive, "Gt")

    @classmethod
    def from_modulus(cls, E: float, thickness: float) -> NeoHooke:
        """Make a foil from Young's modulus E at small strains [Pa] and a thickness [m]."""
        return cls(positive("NeoHooke E", E) / 3 * positive("NeoHooke thickness", thickness))

    @property
    def stiffness(self) -> float:
        """Young's modulus at small strains times thickness [N/m]."""
        return 3 * self.Gt

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference area in UFL [J/m2]."""
        return hyperelasticity.neo_hooke(E, sigma0, parameters.Gt)


@dataclass(frozen=True)
class MooneyRivlin:
    """Incompressible Mooney-Rivlin membrane in plane stress, for foils at any strain.

    Without prestress its relaxed energy is that of simple tension, W(l, l^-1/2) with the larger stretch l.

    Args:
        C10t: Constant of the first invariant times thickness, C10 in W = C10 (I1 - 3) + C01 (I2 - 3) [N/m].
        C01t: Constant of the second invariant times thickness, zero or above [N/m]. The shear modulus times thickness
            is 2 (C10t + C01t).

    Raises:
        ValueError: C10t is not positive, or C01t is negative.

    Source:
        `forms.hyperelasticity`; A. C. Pipkin (1986), D. J. Steigmann (1990), see `forms.wrinkling`.

    Example:
        >>> foil = MooneyRivlin.from_moduli(C10=2e5, C01=5e4, thickness=1e-3)
        >>> foil, round(foil.stiffness, 6)
        (MooneyRivlin(C10t=200.0, C01t=50.0), 1500.0)
    """

    dimension: ClassVar[int] = 2
    directed: ClassVar[bool] = False
    C10t: float
    C01t: float

    def __post_init__(self) -> None:
        store(self, positive, "C10t")
        store(self, not_negative, "C01t")

    @classmethod
    def from_moduli(cls, C10: float, C01: float, thickness: float) -> MooneyRivlin:
        """Make a foil from the constants C10 and C01 [Pa] and a thickness [m]."""
        t = positive("MooneyRivlin thickness", thickness)
        return cls(positive("MooneyRivlin C10", C10) * t, not_negative("MooneyRivlin C01", C01) * t)

    @property
    def stiffness(self) -> float:
        """Young's modulus at small strains times thickness [N/m]."""
        return 6 * (self.C10t + self.C01t)

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference area in UFL [J/m2]."""
        return hyperelasticity.mooney_rivlin(E, sigma0, parameters.C10t, parameters.C01t)
