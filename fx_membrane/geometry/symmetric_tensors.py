"""Symmetric tensors of two dimensions by components 11, 12 and 22 in columns, shape (3, ..., n)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def components(tensors: Array) -> Array:
    """Components of tensors, shape (..., n, 2, 2)."""
    return np.stack([tensors[..., 0, 0], tensors[..., 0, 1], tensors[..., 1, 1]])


def tensors(components: Array) -> Array:
    """Make tensors of components, shape (..., n, 2, 2)."""
    first, mixed, last = components
    return np.stack([np.stack([first, mixed], axis=-1), np.stack([mixed, last], axis=-1)], axis=-2)


def sandwich(outer: Array, inner: Array) -> Array:
    """Products s e s of tensors s and e."""
    a, b, c = outer
    e, f, g = inner
    first, upper, lower, last = a * e + b * f, a * f + b * g, b * e + c * f, b * f + c * g
    return np.stack([first * a + upper * b, first * b + upper * c, lower * b + last * c])


def square_root(components: Array) -> Array:
    """Square roots of positive tensors; NaN of others."""
    first, mixed, last = components
    with np.errstate(invalid="ignore"):
        root = np.sqrt(first * last - mixed**2)
        scale = np.sqrt(first + last + 2 * root)
    return np.stack([first + root, mixed, last + root]) / scale


def inverse(components: Array) -> Array:
    """Inverses of tensors."""
    first, mixed, last = components
    return np.stack([last, -mixed, first]) / (first * last - mixed**2)
