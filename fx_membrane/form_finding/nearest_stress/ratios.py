"""Ratios of stress and force to the wish: powers, differences, and limits."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.symmetric_tensors import components, inverse, sandwich, square_root, tensors
from ..form import relative_difference
from ..plan import Plan

Array = NDArray[np.float64]


def relative(stress: Array, wish: Array) -> Array:
    """Ratios w^-1/2 s w^-1/2 of a stress to a wish, all of shape (cells, 2, 2) [-]."""
    root = inverse(square_root(components(wish)))
    return tensors(sandwich(root, components(stress)))


def power(ratio: Array, exponent: float) -> Array:
    """Powers of symmetric positive tensors, shape (cells, 2, 2), or of numbers, shape (cells,)."""
    if ratio.ndim == 1:
        return np.asarray(ratio**exponent)
    values, vectors = np.linalg.eigh(ratio)
    return np.asarray((vectors * values[:, None] ** exponent) @ vectors.swapaxes(1, 2))


def differences(ratio: Array) -> Array:
    """Largest relative difference of a principal stress, or of a force, from the wish, shape (cells,) [-]."""
    return relative_difference(ratio, np.broadcast_to(np.eye(2) if ratio.ndim > 1 else 1.0, ratio.shape))


def check_tension(plans: Mapping[str, Plan]) -> None:
    """Refuse a stress that is no tension.

    Raises:
        RuntimeError: There is one.
    """
    for plan in plans.values():
        if not np.isfinite(plan.stress).all() or np.linalg.eigvalsh(plan.stress)[:, 0].min() <= 0:
            raise RuntimeError("a stress is no tension")


def check_ratios(ratios: Mapping[str, Array], share: float) -> None:
    """Refuse a stress below a share of the wish.

    Raises:
        RuntimeError: There is one.
    """
    for ratio in ratios.values():
        least = ratio if ratio.ndim == 1 else np.linalg.eigvalsh(ratio)[:, 0]
        if not least.min() > share:
            raise RuntimeError("a stress falls below the least share of the wish")
