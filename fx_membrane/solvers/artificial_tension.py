"""Shift of the tangent in Newton's method: an artificial tension, given as a strain.

The schedule (first value, growth after a failure, decay with the residual) is that of an inertia correction: A.
Waechter, L. T. Biegler, Math. Program. 106 (2006) 25-57 (Ipopt), and of TAO's Newton line search (TAONLS). The decay
with the residual is that of pseudo-transient continuation: C. T. Kelley, D. E. Keyes, SIAM J. Numer. Anal. 35 (1998)
508-523. The numbers were chosen by trial on tests/benchmarks/hard_cases.py.
"""

from collections.abc import Sequence

from .base import Iteration

FIRST, LEAST, LARGEST = 1e-4, 1e-8, 1e4
GROWTH, DECAY = 4.0, 0.3
SHORT = 0.3  # step length below which the shift grows


def more(tension: float) -> float:
    """Next larger shift."""
    return max(FIRST, GROWTH * tension)


def to_begin_with(length: float, tension: float, history: Sequence[Iteration]) -> float:
    """Shift that the next iteration starts with: larger after a short step, smaller after a full one.

    The shift decays with the residual, so that the last steps converge quadratically.

    Args:
        length: Length of the last step.
        tension: Shift of the last step.
        history: The iterates so far.
    """
    if len(history) > 1 and length < SHORT:
        return more(tension)
    if length < 1 or not tension:
        return tension
    before, now = (max(entry.residual, 1e-300) for entry in history[-2:])
    less = min(DECAY, now / before) * tension
    return less if less > LEAST else 0.0
