"""Step control of the continuation by arc length: distance of points, and rejection of steps.

Source: E. Ramm, Strategies for tracing the nonlinear response near limit points, in: W. Wunderlich, E. Stein,
K.-J. Bathe (eds.), Nonlinear finite element analysis in structural mechanics, Springer (1981) 63-89: the length of a
step follows the root of the desired number of iterations over that of the last step.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StepControl:
    """Limits of a step along a path.

    Attributes:
        desired: Desired number of corrector points.
        sharp: Angle [rad] above which a step is rejected and halved, unless the path has a kink there.
        drift: Fraction of the step by which its curve may leave the path (see `path_check`); beyond, it is halved.
        coarse: Multiple of the intended change of the load factor, above which a step is halved.
        patience: Maximum number of halvings for `coarse` alone.
        halvings: Maximum number of halvings of a step.
        short: Fraction of the first step below which a step is not checked: rounding hides the path.
        flat: Largest cosine between the path and the axis of the load factor at a limit point.
        exact: Relative error of the load factor at a limit point in a kink of the path.
        search: Maximum number of trials for a limit point.
        compression_stiffness: Fraction of that of wrinkled and slack cells in effect at a limit point.
    """

    desired: int = 4
    sharp: float = 0.6
    drift: float = 0.01
    coarse: float = 1.5
    patience: int = 4
    halvings: int = 12
    short: float = 2.5e-4
    flat: float = 1e-5
    exact: float = 1e-6
    search: int = 30
    compression_stiffness: float = 0.01

    def stretch(self, corrections: int) -> float:
        """Length of the next step as a multiple of the last, from the number of points of its corrector."""
        return min(max(math.sqrt(self.desired / corrections), 0.5), 2.0)
