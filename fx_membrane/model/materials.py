"""Material laws of the package. Moduli of membranes are per width (modulus times thickness), as in fabric data sheets.

`laws` has the contract that they keep; the energies are in `forms`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..checks.validation import not_negative, number, positive, short_repr, store
from ..forms import elasticity, hyperelasticity, wrinkling
from . import law_check


@dataclass(frozen=True)
class Fabric:
    """Isotropic Saint Venant-Kirchhoff membrane in plane stress.

    Args:
        Et: Young's modulus times thickness [N/m].
        nu: Poisson's ratio, above -1 and at most 0.5 [-].

    Raises:
        ValueError: A value is out of its range.

    Example:
        >>> Fabric(Et=4e5, nu=0.3)
        Fabric(Et=400000.0, nu=0.3)
        >>> Fabric.from_modulus(E=4e8, nu=0.3, thickness=1e-3).Et
        400000.0
    """

    dimension: ClassVar[int] = 2
    directed: ClassVar[bool] = False
    strain_limit: ClassVar[float] = 0.05
    Et: float
    nu: float

    def __post_init__(self) -> None:
        store(self, positive, "Et")
        given = self.nu
        store(self, number, "nu")
        if not -1 < self.nu <= 0.5:
            raise ValueError(f"Fabric nu is {short_repr(given)}; Poisson's ratio must be above -1 and at most 0.5.")

    @classmethod
    def from_modulus(cls, E: float, nu: float, thickness: float) -> Fabric:
        """Make a fabric from Young's modulus E [Pa], Poisson's ratio nu [-] and a thickness [m]."""
        return cls(positive("Fabric E", E) * positive("Fabric thickness", thickness), nu)

    def strain(self, stress: NDArray[np.float64]) -> NDArray[np.float64]:
        """Green-Lagrange strains of cells under stresses [N/m], both of shape (n, 2, 2)."""
        return _strain(stress, self.Et, self.Et, self.nu, self.Et / (2 * (1 + self.nu)))

    @property
    def stiffness(self) -> float:
        """Young's modulus times thickness [N/m]."""
        return self.Et

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference area in UFL [J/m2]."""
        return elasticity.strain_energy(E, sigma0, elasticity.isotropic(E, parameters.Et, parameters.nu))

    def relaxed_energy(self, E: Any, sigma0: Any, parameters: Any) -> wrinkling.Relaxed:
        """Relaxed energy and state in UFL."""
        return wrinkling.isotropic(E, sigma0, parameters.Et, parameters.nu)


@dataclass(frozen=True)
class OrthotropicFabric:
    """Woven Saint Venant-Kirchhoff membrane in plane stress, with warp and weft.

    Args:
        Et_warp: Modulus times thickness along the warp [N/m].
        Et_weft: Modulus times thickness along the weft [N/m].
        nu: Poisson's ratio, the contraction of the weft under tension in the warp [-]; symmetry gives the other one, nu
            Et_weft / Et_warp.
        Gt: Shear modulus times thickness [N/m].

    Raises:
        ValueError: A stiffness is not positive, or nu^2 Et_weft / Et_warp >= 1 (the energy would not be positive).

    Example:
        >>> OrthotropicFabric(Et_warp=6e5, Et_weft=4e5, nu=0.3, Gt=2e4)
        OrthotropicFabric(Et_warp=600000.0, Et_weft=400000.0, nu=0.3, Gt=20000.0)
    """

    dimension: ClassVar[int] = 2
    directed: ClassVar[bool] = True
    strain_limit: ClassVar[float] = 0.05
    Et_warp: float
    Et_weft: float
    nu: float
    Gt: float

    def __post_init__(self) -> None:
        store(self, positive, "Et_warp", "Et_weft", "Gt")
        given = self.nu
        store(self, number, "nu")
        limit = (self.Et_warp / self.Et_weft) ** 0.5
        if not abs(self.nu) < limit:
            raise ValueError(
                f"OrthotropicFabric nu is {short_repr(given)}; with these stiffnesses its size must be "
                f"below {limit:.6g}."
            )

    def strain(self, stress: NDArray[np.float64]) -> NDArray[np.float64]:
        """Green-Lagrange strains of cells under stresses [N/m] in the warp/weft frame, both (n, 2, 2)."""
        return _strain(stress, self.Et_warp, self.Et_weft, self.nu, self.Gt)

    @property
    def stiffness(self) -> float:
        """Larger modulus times thickness [N/m]."""
        return max(self.Et_warp, self.Et_weft)

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference area in UFL [J/m2]."""
        return elasticity.strain_energy(E, sigma0, elasticity.orthotropic(E, *_woven(parameters)))

    def elastic_strain(self, sigma0: Any, parameters: Any) -> Any:
        """Green-Lagrange strain that belongs to a prestress, in UFL, shape (2, 2) [-]."""
        return elasticity.orthotropic_compliance(sigma0, *_woven(parameters))

    def relaxed_energy(self, E: Any, sigma0: Any, parameters: Any, angle: Any = 0.0) -> wrinkling.Relaxed:
        """Relaxed energy and state in UFL, with the angle of `forms.wrinkling.orthotropic`."""
        return wrinkling.orthotropic(E, sigma0, *_woven(parameters), angle)


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


@dataclass(frozen=True)
class Axial:
    """Linear law of cables and masts: 2nd Piola-Kirchhoff force EA E at the Green-Lagrange strain E.

    Args:
        axial_stiffness: Young's modulus times cross-section [N].

    Raises:
        ValueError: The stiffness is not positive.

    Example:
        >>> law = Axial(1e7)  # that of Cable(cells, 1e7)
        >>> law.stiffness
        10000000.0
        >>> law.strain(np.array([[[2e4]]])).tolist()  # under 20 kN
        [[[0.002]]]
    """

    dimension: ClassVar[int] = 1
    strain_limit: ClassVar[float] = 0.05
    axial_stiffness: float

    def __post_init__(self) -> None:
        store(self, positive, "axial_stiffness")

    @property
    def stiffness(self) -> float:
        """Young's modulus times cross-section [N]."""
        return self.axial_stiffness

    def strain(self, stress: NDArray[np.float64]) -> NDArray[np.float64]:
        """Green-Lagrange strains of cells under forces [N], both of shape (n, 1, 1)."""
        return np.divide(stress, self.axial_stiffness)

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference length in UFL [J/m]."""
        return elasticity.strain_energy(E, sigma0, elasticity.axial(E, parameters.axial_stiffness))

    def relaxed_energy(self, E: Any, sigma0: Any, parameters: Any) -> wrinkling.Relaxed:
        """Relaxed energy and state in UFL."""
        return wrinkling.cable(E, sigma0, parameters.axial_stiffness)


SHIPPED = (Fabric, OrthotropicFabric, NeoHooke, MooneyRivlin, Axial)


def check(what: str, material: Any, dimension: int) -> None:
    """Refuse what is no law for cells of a dimension; the energy of a law that is not `SHIPPED` is tried."""
    law_check.check(what, material, dimension, own=not is_shipped(material))


def is_shipped(material: Any) -> bool:
    """Return True for a law of the package, False for one of a user's own."""
    return type(material) in SHIPPED


def _woven(parameters: Any) -> tuple[Any, Any, Any, Any]:
    return parameters.Et_warp, parameters.Et_weft, parameters.nu, parameters.Gt


def _strain(stress: NDArray[np.float64], Et_warp: float, Et_weft: float, nu: float, Gt: float) -> NDArray[np.float64]:
    strain = np.divide(stress, 2 * Gt)
    strain[:, 0, 0] = stress[:, 0, 0] / Et_warp - nu * stress[:, 1, 1] / Et_warp
    strain[:, 1, 1] = stress[:, 1, 1] / Et_weft - nu * stress[:, 0, 0] / Et_warp
    return strain
