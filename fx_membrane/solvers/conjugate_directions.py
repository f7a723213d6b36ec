"""Directions of first-order methods: the fraction of the previous one that each adds, Gil (77).

Source: J. Nocedal, S. J. Wright, Numerical optimization (2006), section 5.2.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from petsc4py import PETSc


class Gradient(NamedTuple):
    """Gradient of the energy: the unbalanced forces g at the free components, and s = M^-1 g for a preconditioner M."""

    g: PETSc.Vec
    s: PETSc.Vec


Beta = Callable[[Gradient, Gradient], float]


def fletcher_reeves(now: Gradient, before: Gradient) -> float:
    """Fraction beta of the previous direction, the first of Gil (77); preconditioned, Nocedal & Wright (5.41a)."""
    return float(now.g.dot(now.s) / before.g.dot(before.s))


def polak_ribiere(now: Gradient, before: Gradient) -> float:
    """Fraction beta of the previous direction, the second of Gil (77); it may be negative."""
    return float((now.g.dot(now.s) - before.g.dot(now.s)) / before.g.dot(before.s))


def no_memory(now: Gradient, before: Gradient) -> float:
    """No fraction of the previous direction: steepest descent, Gil (73)."""
    return 0.0
