"""Laws of woven and coated fabrics. Moduli are per width (modulus times thickness), as in data sheets."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..checks.validation import number, positive, short_repr, store
from ..forms import elasticity, wrinkling


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


def _woven(parameters: Any) -> tuple[Any, Any, Any, Any]:
    return parameters.Et_warp, parameters.Et_weft, parameters.nu, parameters.Gt


def _strain(stress: NDArray[np.float64], Et_warp: float, Et_weft: float, nu: float, Gt: float) -> NDArray[np.float64]:
    strain = np.divide(stress, 2 * Gt)
    strain[:, 0, 0] = stress[:, 0, 0] / Et_warp - nu * stress[:, 1, 1] / Et_warp
    strain[:, 1, 1] = stress[:, 1, 1] / Et_weft - nu * stress[:, 0, 0] / Et_warp
    return strain
