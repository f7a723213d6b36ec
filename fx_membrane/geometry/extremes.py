"""Rows of largest values, the same however sums were rounded."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

TIE = 1e-8  # share of the largest magnitude by which equal values differ, by rounding and the tolerance of a solver


def first_largest(values: NDArray[np.floating[Any]]) -> int:
    """Row of the largest of some values, shape (n,); of those that differ by rounding, the first.

    On another number of processes sums are rounded in another order. In a symmetric structure, `argmax` would then
    name another of several equal cells.
    """
    slack = TIE * np.abs(values[np.isfinite(values)]).max(initial=0.0)
    near = np.flatnonzero(values >= values.max() - slack)
    return int(near[0]) if len(near) else int(values.argmax())  # the latter where one is no number
