"""Observed orders of convergence."""

import numpy as np


def rates(remainders, scale):
    """Orders of remainders for halved steps, of those above rounding."""
    above = remainders[remainders > 1e-13 * scale]
    return np.log2(above[:-1] / above[1:])
