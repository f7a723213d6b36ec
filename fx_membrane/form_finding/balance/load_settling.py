"""Loads that depend on the shape, solve by solve: settled where only rounding is left of their change."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

# Change of the loads, relative to the largest, that is that of one operation: no solve does better.
LOAD_ROUNDING = 1e-15
# The same, below which a change that rises is rounding of the shape; slow solves fall all the way.
SHAPE_ROUNDING = 1e-10


class LoadSettling:
    """Tell when loads have settled; half of `NEAR`, or twice, ends no solve earlier that still falls."""

    def __init__(self) -> None:
        self.least = np.inf

    def __call__(self, before: NDArray[np.float64], now: NDArray[np.float64]) -> bool:
        """Return True if loads, both of shape (n, 3) [N], change by rounding only."""
        largest = np.abs(now).max(initial=0.0)
        change = np.abs(now - before).max(initial=0.0)
        risen = change >= self.least
        self.least = min(self.least, change)
        return bool(change <= LOAD_ROUNDING * largest or (risen and change <= SHAPE_ROUNDING * largest))
