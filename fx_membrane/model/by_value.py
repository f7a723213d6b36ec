"""Comparison of plain data by value."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np


class ByValue:
    """Base of plain data: objects of one class with equal numbers, texts and arrays are equal, with equal hashes."""

    def __eq__(self, other: object) -> bool:
        """Compare all fields that the constructor takes."""
        return self is other or _equal(self, other)

    def __hash__(self) -> int:
        """Return a hash that goes with the comparison."""
        return hash(_frozen(self))


def _equal(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other)
    if _is_data(one):
        return type(one) is type(other) and all(_equal(getattr(one, key), getattr(other, key)) for key in _fields(one))
    if isinstance(one, Mapping):
        return isinstance(other, Mapping) and one.keys() == other.keys() and all(_equal(one[k], other[k]) for k in one)
    if isinstance(one, list | tuple):
        return isinstance(other, list | tuple) and len(one) == len(other) and all(map(_equal, one, other))
    return bool(one == other)


def _frozen(value: Any) -> Any:
    """Value as an object with a hash, equal for equal values."""
    if isinstance(value, np.ndarray):
        return value.shape, (value.astype(np.float64) + 0.0).tobytes()  # -0.0 + 0.0 is 0.0
    if _is_data(value):
        return type(value), *(_frozen(getattr(value, key)) for key in _fields(value))
    if isinstance(value, Mapping):
        return frozenset((key, _frozen(entry)) for key, entry in value.items())
    if isinstance(value, list | tuple):
        return tuple(map(_frozen, value))
    return value


def _is_data(value: Any) -> bool:
    return dataclasses.is_dataclass(value) and not isinstance(value, type)


def _fields(value: Any) -> list[str]:
    return [entry.name for entry in dataclasses.fields(value) if entry.init]
