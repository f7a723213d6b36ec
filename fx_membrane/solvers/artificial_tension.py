"""Artificial tension, as a strain, in the tangent: how much of it a step of Newton's method begins with.

The numbers have no source: they were chosen by trial on tests/benchmarks/hard_cases.py.
"""

from collections.abc import Sequence

from .base import Iteration

FIRST, LEAST, LARGEST = 1e-4, 1e-8, 1e4
GROWTH, DECAY = 4.0, 0.3
SHORT = 0.3  # a step that asks for more of it


def more(tension: float) -> float:
    """The next larger one."""
    return max(FIRST, GROWTH * tension)


def to_begin_with(length: float, tension: float, history: Sequence[Iteration]) -> float:
    """More after a short step, less after a full one, in pace with the residual.

    So the last steps converge quadratically, with tension or without.

    Args:
        length: Length of the last step.
        tension: The one it was made with.
        history: The iterates so far.
    """
    if len(history) > 1 and length < SHORT:
        return more(tension)
    if length < 1 or not tension:
        return tension
    before, now = (max(entry.residual, 1e-300) for entry in history[-2:])
    less = min(DECAY, now / before) * tension
    return less if less > LEAST else 0.0
