"""Work of forces along a straight line of displacements, with or without a potential."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np


def work(power: Callable[[float], float], points: int) -> Callable[[float], float]:
    """Work of forces as a function of the length on a line [J].

    It is exact, for any length, if the power is a polynomial of a degree below the number of points.

    Args:
        power: Forces at a length times the direction [J].
        points: Number of equidistant lengths between 0 and 1 at which the power is evaluated.
    """
    lengths = np.linspace(0.0, 1.0, points)
    powers = np.linalg.solve(np.vander(lengths), [power(length) for length in lengths])
    integral = np.append(powers / np.arange(points, 0, -1), 0.0)
    return lambda length: float(np.polyval(integral, length))
