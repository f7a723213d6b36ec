"""Checks of input on entry: each returns the value as an array or a number, or raises one clear sentence.

Plain data keeps the results of the checks: floats, whole numbers, texts, read-only arrays of float64 or int64.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence, Set
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .array_entries import all_are, described, entries, equal_rows, frozen_integers, misfit
from .objects import communicator as communicator  # noqa: PLC0414  (others take all checks from here)
from .objects import instance as instance  # noqa: PLC0414
from .objects import instances as instances  # noqa: PLC0414
from .objects import listed as listed  # noqa: PLC0414
from .objects import plain as plain  # noqa: PLC0414
from .values import counted as counted  # noqa: PLC0414
from .values import format_point as format_point  # noqa: PLC0414
from .values import is_real, is_whole, scalar
from .values import short_repr as short_repr  # noqa: PLC0414

MAX_NUMBER = 1e60  # limit of all numbers: the square of the product of two is still finite
MAX_INTEGER = 2**31 - 1  # limit of whole numbers


def store(owner: object, check: Callable[[str, Any], Any], *fields: str) -> None:
    """Store checked values in fields of a frozen dataclass; messages call them "Class field"."""
    for field in fields:
        keep(owner, **{field: check(f"{type(owner).__name__} {field}", getattr(owner, field))})


def keep(owner: object, **values: Any) -> None:
    """Set fields of a frozen dataclass."""
    for field, value in values.items():
        object.__setattr__(owner, field, value)


def number(name: str, value: Any) -> float:
    """Check a finite number."""
    if isinstance(value, str):
        raise ValueError(f"{name} is the text {short_repr(value)}; give a number.")
    value = scalar(value)
    if not is_real(type(value)):
        raise ValueError(f"{name} must be a number, not {short_repr(value)}.")
    try:
        result = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number, not {short_repr(value)}.") from None
    except OverflowError:
        result = np.inf
    if not abs(result) <= MAX_NUMBER:
        raise ValueError(f"{name} is {short_repr(value)}; give a finite number, at most {MAX_NUMBER:g} in size.")
    return result


def positive(name: str, value: Any) -> float:
    """Check a finite number above zero."""
    result = number(name, value)
    if result <= 0:
        raise ValueError(f"{name} is {short_repr(value)}; it must be positive.")
    return result


def not_negative(name: str, value: Any) -> float:
    """Check a finite number, zero or above."""
    result = number(name, value)
    if result < 0:
        raise ValueError(f"{name} is {short_repr(value)}; it must not be negative.")
    return result


def positive_integer(name: str, value: Any, most: int = MAX_INTEGER) -> int:
    """Check a whole number above zero."""
    return _integer(name, value, "a whole number above zero", 1, most)


def integer(name: str, value: Any) -> int:
    """Check a whole number."""
    return _integer(name, value, "a whole number", -MAX_INTEGER, MAX_INTEGER)


def _integer(name: str, value: Any, wanted: str, least: int, most: int) -> int:
    value = scalar(value)
    fits = is_whole(type(value))
    if not (fits and least <= value <= most):
        limit = f" and at most {most}" if fits and value > most else ""
        raise ValueError(f"{name} is {short_repr(value)}; give {wanted}{limit}.")
    return int(value)


def fraction(name: str, value: Any) -> float:
    """Check a number above zero and at most one."""
    result = positive(name, value)
    if result > 1:
        raise ValueError(f"{name} is {short_repr(value)}; it must be at most 1, as 0.05 for 5 %.")
    return result


def tolerance(name: str, value: Any) -> float:
    """Check a relative tolerance: a number above zero and at most one per cent."""
    result = positive(name, value)
    if result > 1e-2:
        raise ValueError(f"{name} is {short_repr(value)}; it must be at most 0.01, or forces would not balance.")
    return result


def truth(name: str, value: Any) -> bool:
    """Check a truth value."""
    if not isinstance(value, bool | np.bool_):
        raise ValueError(f"{name} is {short_repr(value)}; give True or False.")
    return bool(value)


def choice(name: str, value: Any, choices: Sequence[str | None], remedy: str) -> Any:
    """Check for one of some texts, or None if it is one of the choices."""
    if not (value is None or isinstance(value, str)) or value not in choices:
        raise ValueError(f"{name} is {short_repr(value)}; give {remedy}.")
    return value if value is None else str.__str__(value)


def finite(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Make a read-only array of finite numbers."""
    wanted = "an array of numbers with rows of equal length"
    array = entries(name, value, wanted)
    if not all_are(is_real, array):
        raise ValueError(f"{name} must be {wanted}, not {misfit(is_real, value)}.")
    try:
        with np.errstate(over="ignore"):
            result = np.array(array, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be {wanted}, not {short_repr(value)}.") from None
    except OverflowError:
        raise ValueError(f"{name} has a value that is not finite as a number of 64 bits; give smaller ones.") from None
    bad = np.argwhere(~(np.abs(result) <= MAX_NUMBER))
    if len(bad):
        entry, where = result[tuple(bad[0])], f" at index {tuple(map(int, bad[0]))}" if result.ndim else ""
        if np.isfinite(entry):
            raise ValueError(f"{name} has the value {entry:g}{where}; give numbers of at most {MAX_NUMBER:g} in size.")
        raise ValueError(f"{name} has a value that is not finite ({entry}){where}; give finite numbers.")
    result.setflags(write=False)
    return result


def positions(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Make a read-only array of points in space, shape (n, 3)."""
    result = finite(name, value)
    if result.ndim != 2 or result.shape[1] != 3:
        raise ValueError(f"{name} has shape {result.shape}; give (n, 3), one row x, y, z for each node.")
    return result


def vector(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Make a read-only array of three finite numbers."""
    result = finite(name, value)
    if result.shape != (3,):
        raise ValueError(f"{name} is {short_repr(value)}; give three components (x, y, z).")
    return result


def direction(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Scale a nonzero vector to length one."""
    result = vector(name, value)
    if not result.any():
        raise ValueError(f"{name} is {short_repr(value)}; give a direction (x, y, z) that is not zero.")
    result = result / np.abs(result).max()  # squares of tiny ones would be zero
    return np.asarray(result / np.linalg.norm(result))


def indices(name: str, value: ArrayLike, empty: bool = False) -> NDArray[np.int64]:
    """Make a read-only, one-dimensional array of node or cell numbers; a single number gives an array of one."""
    wanted = "a list of whole numbers"
    array = np.atleast_1d(entries(name, value, wanted))
    if array.ndim != 1 or not (all_are(is_whole, array) or array.size == 0):
        mask = array.size and (array.dtype.kind == "b" or all(isinstance(entry, bool) for entry in array.flat))
        hint = "; turn a mask into numbers with numpy.flatnonzero" if mask else ""
        raise ValueError(f"{name} must be {wanted}, not {misfit(is_whole, value)}{hint}.")
    if not (array.size or empty):
        raise ValueError(f"{name} is empty; name at least one, or leave it out.")
    return frozen_integers(name, array)


def unique_indices(name: str, value: ArrayLike, of: str) -> NDArray[np.int64]:
    """Check unique numbers of nodes or cells, returned as by `rows`."""
    result = indices(name, value)
    numbers, count = np.unique(result, return_counts=True)
    if (count > 1).any():
        raise ValueError(
            f"{name} names {of} {numbers[np.argmax(count > 1)]} twice; name each once, and add a second load of that "
            "kind if it is to count twice."
        )
    return result


def cells(name: str, value: ArrayLike, nodes: int, distinct: bool = True, row: str = "cell") -> NDArray[np.int64]:
    """Make a read-only array of cells with that many nodes each; no cell may repeat a node, nor another cell."""
    wanted = f"an array of whole numbers of shape (n, {nodes}) with n >= 1"
    array = entries(name, value, wanted)
    if array.ndim != 2 or array.shape[1] != nodes or not len(array):
        remedy = "; split quadrilaterals into triangles" if (nodes, *array.shape[1:]) == (3, 4) else ""
        raise ValueError(f"{name} must be {wanted}, not {described(value)}{remedy}.")
    if not all_are(is_whole, array):
        found = misfit(is_whole, value) if isinstance(value, list | tuple) else described(value)
        raise ValueError(f"{name} must be {wanted}, not {found}.")
    result = frozen_integers(name, array)
    ordered = np.sort(result, axis=1)
    twice = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    if len(twice):
        raise ValueError(
            f"{name}: {row} {twice[0]} has a node twice, {result[twice[0]].tolist()}; remove or mend the {row}."
        )
    equal = equal_rows(ordered) if distinct else None
    if equal:
        raise ValueError(
            f"{name}: {row}s {equal[0]} and {equal[1]} have the same nodes, {result[equal[0]].tolist()}; remove one"
            f"{', or make the second a part of its own' * (row == 'cell')}."
        )
    return result


def in_range(name: str, numbers: NDArray[np.int64], count: int, of: str) -> None:
    """Refuse numbers outside 0 ... count - 1."""
    bad = numbers[(numbers < 0) | (numbers >= count)]
    if len(bad):
        raise ValueError(f"{name} names {of} {bad[0]}, which does not exist; {of}s are numbered 0 to {count - 1}.")


def letters(name: str, value: Any) -> str:
    """Check components given as a text, some of "xyz"."""
    if not isinstance(value, str) or not value or set(value) - set("xyz") or len(set(value)) < len(value):
        raise ValueError(
            f'{name} is {short_repr(value)}; give one or more of the letters x, y and z, like "xyz" or "z".'
        )
    return str.__str__(value)


def components(name: str, value: str) -> tuple[int, ...]:
    """Convert components to column numbers: "xz" is (0, 2)."""
    return tuple("xyz".index(letter) for letter in letters(name, value))


def name(what: str, value: Any) -> str:
    """Check a text that is not empty."""
    if not isinstance(value, str) or not value:
        raise ValueError(f"The name of a {what} is {short_repr(value)}; give a text.")
    return str.__str__(value)


def text(what: str, value: Any) -> str:
    """Check a text, which may be empty; of a class derived from text, return the text itself."""
    instance(what, value, str)
    return str.__str__(value)


def texts(name: str, values: Any) -> tuple[str, ...]:
    """Make a tuple of texts, from any sequence or set of them."""
    values = sorted(values, key=str) if isinstance(values, Set) else values
    return tuple(map(str.__str__, instances(name, values, str)))


def unique(name: str, values: Iterable[str]) -> None:
    """Refuse a name given twice."""
    seen: set[str] = set()
    for value in values:
        if value in seen:
            raise ValueError(f"{name} {value!r} is given twice; names must differ.")
        seen.add(value)
