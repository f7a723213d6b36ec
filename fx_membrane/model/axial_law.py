"""Law of cables, masts and ropes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..checks.validation import positive, store
from ..forms import elasticity, wrinkling


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
