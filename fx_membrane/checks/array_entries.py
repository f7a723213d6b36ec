"""Entries of arrays and of nested lists in their original types, before NumPy makes one type of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .values import short_repr

ODD = np.uint64(0x9E3779B97F4A7C15)  # without pattern


def entries(name: str, value: Any, wanted: str) -> NDArray[Any]:
    """Make an array of the entries; those of lists keep their types.

    NumPy would give all entries of a list one type: 1.0 for True beside 2.0.

    Raises:
        ValueError: Rows have unequal lengths, or entries are masked.
    """
    try:
        array = _array(value)
    except ValueError:
        raise ValueError(f"{name} must be {wanted}, not {short_repr(value)}.") from None
    if _masked(array):
        raise ValueError(f"{name} has masked entries; leave them out, or fill them with array.filled(value).")
    return array


def _masked(array: NDArray[Any]) -> bool:
    if isinstance(array, np.ma.MaskedArray):
        return bool(np.any(array.mask))
    return array.dtype.kind == "O" and type(np.ma.masked) in set(map(type, array.flat))


def _array(value: Any) -> NDArray[Any]:
    if isinstance(value, bytes | bytearray):  # NumPy reads them as numbers
        raise ValueError
    if not isinstance(value, list | tuple):
        return np.asanyarray(value)
    if any(issubclass(kind, np.ma.MaskedArray) for kind in set(map(type, value))):
        return np.asanyarray(np.ma.stack(value))  # np.array drops the masks
    return np.array(value, dtype=object)


def all_are(fits: Callable[[type], bool], array: NDArray[Any]) -> bool:
    """Return True if all entries of an array are of classes that fit."""
    if array.dtype.kind == "O":
        return all(map(fits, set(map(type, array.flat))))
    return fits(array.dtype.type) or array.size == 0


def misfit(fits: Callable[[type], bool], value: Any) -> str:
    """Show a value in a message; if it is long, with the first entry that does not fit."""
    text = short_repr(value)
    mixed = isinstance(value, list | tuple) or (isinstance(value, np.ndarray) and value.dtype.kind == "O")
    if not mixed or not text.startswith(("a ", "an ")):
        return text
    array = np.array(value, dtype=object)
    for index, entry in np.ndenumerate(array):
        if not fits(type(entry)) and not isinstance(entry, list | tuple | np.ndarray):
            return f"{text}, with {short_repr(entry)} at index {index}"
    return text


def described(value: Any) -> str:
    """Type and shape of a value in NumPy's terms."""
    try:
        array = np.asarray(value)
    except ValueError:  # rows of unequal length
        return short_repr(value)
    return f"{array.dtype} of shape {array.shape}" if array.ndim else short_repr(value)


def frozen_integers(name: str, array: NDArray[Any]) -> NDArray[np.int64]:
    """Make a read-only copy of whole numbers."""
    limits = np.iinfo(np.int64)
    for extreme in (array.max(), array.min()) if array.size else ():
        if not limits.min <= extreme <= limits.max:
            raise ValueError(f"{name} has {short_repr(extreme)}, a number that no node and no cell has; mend it.")
    result = np.array(array, dtype=np.int64)
    result.setflags(write=False)
    return result


def equal_rows(rows: NDArray[np.int64]) -> tuple[int, int] | None:
    """First row of whole numbers that comes again, and the row where it does; None if all differ."""
    # Equal rows have equal sums, modulo 2^64; sorting these takes a fifth of the time that sorting rows takes.
    sums = np.sort((rows.view(np.uint64) * ODD ** np.arange(rows.shape[1], dtype=np.uint64)).sum(axis=1))
    if (sums[1:] != sums[:-1]).all():
        return None
    _, first, count = np.unique(rows, axis=0, return_index=True, return_counts=True)
    if not (count > 1).any():
        return None
    row = first[count > 1].min()
    return int(row), int(np.flatnonzero((rows == rows[row]).all(axis=1))[1])
