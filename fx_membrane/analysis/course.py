"""A stage between its actions at the start and at the end."""

from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..assembly.actions import Actions, between
from ..model.stages import Stage


class Course(NamedTuple):
    """A stage between its actions.

    Attributes:
        stage: The stage.
        start: Actions at the load factor 0.
        end: Actions at the load factor 1.
        shape: Displacement at its start, shape (n, 3) [m].
    """

    stage: Stage
    start: Actions
    end: Actions
    shape: NDArray[np.float64]

    def actions(self, factor: Fraction | float) -> Actions:
        """Actions at a load factor."""
        return between(self.start, self.end, float(factor))
