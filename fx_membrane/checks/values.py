"""Values in messages, and tests for numbers."""

from __future__ import annotations

import contextlib
from collections.abc import Sized
from typing import Any

import numpy as np
from numpy.typing import NDArray


def short_repr(value: Any) -> str:
    """Show a value in a message: in full, or by its kind and shape if that would be long."""
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if isinstance(value, int) and abs(value) >= 10**50:  # Python does not print numbers of more than 4300 digits
        return f"a whole number of about {round(value.bit_length() * 0.30103)} digits"
    with contextlib.suppress(Exception):  # a list of long numbers, or an object that cannot show itself
        numpy = isinstance(value, np.ndarray | np.generic) and value is not np.ma.masked
        text = repr(value.tolist() if numpy and value.dtype.kind not in "mM" else value)
        if len(text) <= 50:
            return text
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}, shape {value.shape}"
    sized = isinstance(value, Sized) and not hasattr(value, "shape")  # sparse matrices have no length
    count = ""
    with contextlib.suppress(Exception):  # a tensor in UFL has no length either
        count = f" of {len(value)} entr{'y' if len(value) == 1 else 'ies'}" if sized else ""
    return with_article(type(value).__name__) + count


def with_article(noun: str) -> str:
    """Put "a" or "an" before a noun."""
    return f"{'an' if noun[0] in 'AEIOUaeiou' else 'a'} {noun}"


def counted(count: int, noun: str) -> str:
    """Put a number before a noun, which takes an s unless the number is one."""
    return f"{count} {noun}{'s' * (count != 1)}"


def expected(kind: Any) -> str:
    """Name a class, or several joined by |, in a message."""
    words = {"str": "text", "Mapping": "dictionary", "Sequence": "list", "bool_": "True or False", "NoneType": "None"}
    names = [entry.__name__ for entry in getattr(kind, "__args__", (kind,))]
    return " or ".join(words.get(name, name) for name in names)


def format_point(point: NDArray[np.float64]) -> str:
    """Show a position in a message; rounding of coordinates is shown as zero."""
    rounding = 1e-12 * np.abs(point).max(initial=1e-3)  # a point all of rounding is the origin
    return f"({', '.join(f'{0.0 if abs(value) < rounding else value:.6g}' for value in point)})"


def is_real(kind: type) -> bool:
    """Return True if values of a class are real numbers: no texts, truth values, dates, complex numbers or arrays."""
    if issubclass(kind, np.generic):
        return issubclass(kind, np.integer | np.floating) and not issubclass(kind, np.timedelta64)
    return hasattr(kind, "__float__") and not issubclass(kind, bool | Sized)


def is_whole(kind: type) -> bool:
    """Return True if values of a class are whole numbers."""
    return issubclass(kind, int | np.integer) and not issubclass(kind, bool | np.timedelta64)


def scalar(value: Any) -> Any:
    """Unwrap the value in an array without dimensions."""
    if not hasattr(value, "__array__") or isinstance(value, np.generic):
        return value
    array = np.asanyarray(value)
    return array[()] if array.ndim == 0 else value
