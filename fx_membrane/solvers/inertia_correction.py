"""Inertia correction in Newton's method: the shift lambda of the tangent K + lambda T.

T is the stabilization matrix: the stiffness of a tension of strain one in all parts. The shift appears where the pivots
show negative curvature or none. It grows until they are positive, and vanishes at the solution.

Sources: A. Waechter, L. T. Biegler, On the implementation of an interior-point filter line-search algorithm for
large-scale nonlinear programming, Math. Program. 106 (2006) 25-57, algorithm IC (Ipopt); TAO's Newton line search
(TAONLS), for the shift that decays with the residual, as in pseudo-transient continuation: C. T. Kelley, D. E. Keyes,
SIAM J. Numer. Anal. 35 (1998) 508-523.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .base import Iteration


@dataclass(frozen=True)
class ShiftControl:
    """Schedule of the shift, as strains; `first` is that of Ipopt, the others were fitted on hard_cases.py.

    Growth 8 and decay 1/3, those of Ipopt, take 2 % fewer factorizations in most of the cases. In the two sheets
    twisted out of their plane they take 30 % more. With the least shift 1e-12 of TAONLS they take 10 % fewer in all.
    But then the last step keeps a shift, and the motions of soft structures lose a digit.

    Attributes:
        first: First shift above zero.
        growth: Factor after a tangent that is not positive definite, and after a short step.
        decay: Largest factor after a full step; that of the residual, if smaller, replaces it.
        least: Shift below which it is dropped, so that the last steps converge quadratically.
        largest: Shift above which the tangent counts as singular.
        short: Length of a step that is short: its quadratic model was poor.
    """

    first: float = 1e-4
    growth: float = 4.0
    decay: float = 0.3
    least: float = 1e-8
    largest: float = 1e4
    short: float = 0.3

    def more(self, shift: float) -> float:
        """Return the next larger shift."""
        return max(self.first, self.growth * shift)

    def next(self, length: float, shift: float, history: Sequence[Iteration]) -> float:
        """Return the shift that the next iteration starts with.

        Args:
            length: Length of the last step.
            shift: Shift of the last step.
            history: The iterates so far.
        """
        if len(history) > 1 and length < self.short:
            return self.more(shift)
        if length < 1 or not shift:
            return shift
        before, now = (max(entry.residual, 1e-300) for entry in history[-2:])
        less = min(self.decay, now / before) * shift
        return less if less > self.least else 0.0
