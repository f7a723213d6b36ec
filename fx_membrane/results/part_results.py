"""State of a part: strains, and stresses of membranes or forces of cables and masts."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class MembraneResult:
    """State of a membrane; stresses are forces per length, divide by the thickness for [Pa].

    Attributes:
        strain: Green-Lagrange strain in the warp/weft frame, shape (cells, 2, 2) [-].
        second_piola_kirchhoff: Stress per reference length in the warp/weft frame, shape (cells, 2, 2) [N/m], Gil (32).
        cauchy: Stress per current length in global axes, shape (cells, 3, 3) [N/m].
        principal: Principal values of `cauchy`, the larger first, shape (cells, 2) [N/m].
        warp_weft_stress: Normal components of `cauchy` along the current warp and weft, shape (cells, 2) [N/m].
        state: "taut", "wrinkled" or "slack", shape (cells,). With `compression_stiffness=1` the membrane neither
            wrinkles nor slackens: all cells are "taut", even if `principal` shows compression.
        cauchy_projected: Cauchy stress of Gil (19) with J = det(I + grad u), the paper's Table 2, in global axes, shape
            (cells, 3, 3) [N/m]. It is larger than `cauchy` where cells have turned.
    """

    dimension: ClassVar[Literal[2]] = 2
    strain: Array
    second_piola_kirchhoff: Array
    cauchy: Array
    principal: Array
    cauchy_projected: Array
    warp_weft_stress: Array
    state: NDArray[np.str_]

    @property
    def taut(self) -> NDArray[np.bool_]:
        """Cells that are neither wrinkled nor slack, shape (cells,)."""
        return self.state == "taut"

    @property
    def slack(self) -> NDArray[np.bool_]:
        """Cells without tension, shape (cells,)."""
        return self.state == "slack"


@dataclass(frozen=True, eq=False)
class BarResult:
    """State of cables or masts.

    Attributes:
        strain: Green-Lagrange strain, shape (cells,) [-].
        force: Axial force in the current shape, tension positive, shape (cells,) [N].
        slack: Cells without tension, shape (cells,); False for masts, and for cables with `compression_stiffness=1`.
    """

    dimension: ClassVar[Literal[1]] = 1
    strain: Array
    force: Array
    slack: NDArray[np.bool_]

    @property
    def taut(self) -> NDArray[np.bool_]:
        """Cells that are not slack, shape (cells,)."""
        return ~self.slack

    @property
    def principal(self) -> Array:
        """Axial force as the one principal value of a bar, shape (cells, 1) [N]; see `MembraneResult`."""
        return self.force[:, None]
