"""Shape in exact equilibrium on the way to the nearest stress, and its difference from the wish."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..plan import Plan
from .ratios import differences

Array = NDArray[np.float64]


class State(NamedTuple):
    """Shape in exact equilibrium.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        multipliers: Multipliers of equilibrium, shape (n, 3) [m2/N].
        plans: References of the membranes, with their stress there.
        densities: Force densities of bars, by part, shape (cells,) [N/m].
        reactions: Forces of supports, shape (n, 3) [N].
        ratios: Stress over wish, by part: w^-1/2 s w^-1/2 in the frame of the wish, shape (cells, 2, 2), and T / T_w,
            shape (cells,) [-].
        area: Area of the membranes [m2], or of the strips that bars count as, without one.
        norm: Sum of areas times squared differences from the wish [m2].
    """

    points: Array
    multipliers: Array
    plans: dict[str, Plan]
    densities: dict[str, Array]
    reactions: Array
    ratios: dict[str, Array]
    area: float
    norm: float

    @property
    def mean(self) -> float:
        """Root of the mean squared relative difference of stress and wish [-]."""
        return float(np.sqrt(self.norm / self.area))

    @property
    def largest(self) -> float:
        """Largest relative difference of a principal stress, or of the force of a bar, from the wish [-]."""
        return max((float(differences(ratio).max(initial=0.0)) for ratio in self.ratios.values()), default=0.0)
