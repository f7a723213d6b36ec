"""Failure to find equilibrium, with the results found before."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..results.load_increments import Increment
from ..results.states import StageResult, StageResults


class ConvergenceError(RuntimeError):
    """Failure to find equilibrium in a load increment.

    Attributes:
        results: Results of the stages that were completed, by name.
        last: The last converged state of the stage that failed: that of its last converged increment, or else its
            start. Later iterates are discarded.
        failed: The increment that did not converge, with its iterations.
        motion: For a mechanism, the free motion of its nodes, the largest displacement of size one, shape (n, 3); None
            otherwise. `plot.contours(error.last, {"free motion": np.linalg.norm(error.motion, axis=1)}, path)` shows
            it.
    """

    def __init__(
        self,
        message: str,
        results: StageResults,
        last: StageResult,
        failed: Increment,
        motion: NDArray[np.float64] | None = None,
    ):
        super().__init__(message)
        self.results, self.last, self.failed, self.motion = results, last, failed, motion
