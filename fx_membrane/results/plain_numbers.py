"""Numbers of tables and reports as texts."""

from __future__ import annotations

import numpy as np

LEAST, MOST = 1e-4, 1e9  # between them a number has no exponent


def plain(value: float, digits: int = 5) -> str:
    """Show a number with some significant digits: as 123460 where `f"{value:.5g}"` writes 1.2346e+05."""
    short = f"{value:.{digits}g}"
    size = abs(float(short))
    return np.format_float_positional(float(short), trim="-") if LEAST <= size < MOST else short
