"""Refusals at the door: each check returns the value as an array or a number, or raises one clear sentence."""

import math
from collections.abc import Iterable, Sequence, Sized
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray


def shown(value: Any) -> str:
    """A value as a refusal shows it: as it is, or its kind and shape if that would be long."""
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value.tolist() if isinstance(value, np.ndarray | np.generic) else value)
    if len(text) <= 50:
        return text
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}, shape {value.shape}"
    return _article(type(value).__name__) + (f" of {len(value)} entries" if isinstance(value, Sized) else "")


def place(point: NDArray[np.float64]) -> str:
    """A position as a message shows it."""
    return f"({', '.join(f'{coordinate:.6g}' for coordinate in point)})"


def _article(noun: str) -> str:
    return f"{'an' if noun[0] in 'AEIOUaeiou' else 'a'} {noun}"


def number(name: str, value: Any) -> float:
    """A finite number."""
    if isinstance(value, str):
        raise ValueError(f"{name} is the text {value!r}; give a number.")
    try:
        result = float("not a number" if isinstance(value, bool) else value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be a number, not {shown(value)}.") from None
    if not math.isfinite(result):
        raise ValueError(f"{name} is {value}; give a finite number.")
    return result


def positive(name: str, value: Any) -> float:
    """A finite number above zero."""
    result = number(name, value)
    if result <= 0:
        raise ValueError(f"{name} is {value}; it must be positive.")
    return result


def not_negative(name: str, value: Any) -> float:
    """A finite number, zero or above."""
    result = number(name, value)
    if result < 0:
        raise ValueError(f"{name} is {value}; it must not be negative.")
    return result


def whole(name: str, value: Any) -> int:
    """A whole number above zero."""
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
        raise ValueError(f"{name} is {value!r}; give a whole number above zero.")
    return int(value)


def share(name: str, value: Any) -> float:
    """A number above zero and at most one."""
    if positive(name, value) > 1:
        raise ValueError(f"{name} is {value}; it must be at most 1.")
    return float(value)


def tolerance(name: str, value: Any) -> float:
    """A relative tolerance: a number above zero and at most one per cent."""
    if positive(name, value) > 1e-2:
        raise ValueError(f"{name} is {value}; it must be at most 0.01, or forces would not balance.")
    return float(value)


def finite(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """A read-only array of finite numbers."""
    try:
        if value is None or np.iscomplexobj(value) or np.asarray(value).dtype.kind in "US":
            raise TypeError
        result = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        raise ValueError(f"{name} must be an array of numbers with rows of equal length, not {shown(value)}.") from None
    bad = np.argwhere(~np.isfinite(result))
    if len(bad):
        where = f" at index {tuple(map(int, bad[0]))}" if result.ndim else ""
        raise ValueError(
            f"{name} has a value that is not finite ({result[tuple(bad[0])]}){where}; give finite numbers."
        )
    result.setflags(write=False)
    return result


def positions(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """A read-only array of points in space, shape (n, 3)."""
    result = finite(name, value)
    if result.ndim != 2 or result.shape[1] != 3:
        raise ValueError(f"{name} has shape {result.shape}; give (n, 3), one row x, y, z for each node.")
    return result


def vector(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """A read-only array of three finite numbers."""
    result = finite(name, value)
    if result.shape != (3,):
        raise ValueError(f"{name} is {shown(value)}; give three components (x, y, z).")
    return result


def direction(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """A vector that is not zero."""
    result = vector(name, value)
    if not result.any():
        raise ValueError(f"{name} is {shown(value)}; give a direction (x, y, z) that is not zero.")
    return result


def rows(name: str, value: ArrayLike) -> NDArray[np.int64]:
    """A read-only, one-dimensional array of node or cell numbers; a single number is an array of one."""
    result = np.atleast_1d(_array(name, value, "a list of whole numbers"))
    if result.ndim != 1 or not (result.dtype.kind in "iu" or result.size == 0):
        hint = "; turn a mask into numbers with numpy.flatnonzero" if result.dtype.kind == "b" else ""
        raise ValueError(f"{name} must be a list of whole numbers, not {shown(value)}{hint}.")
    if not result.size:
        raise ValueError(f"{name} is empty; name at least one, or leave it out.")
    return _frozen_integers(result)


def distinct(name: str, value: ArrayLike, of: str) -> NDArray[np.int64]:
    """Numbers of nodes or cells as `rows` returns them, each of them once."""
    result = rows(name, value)
    numbers, count = np.unique(result, return_counts=True)
    if (count > 1).any():
        raise ValueError(
            f"{name} names {of} {numbers[np.argmax(count > 1)]} twice; name each once, and add a second load of that "
            "kind if it is to count twice."
        )
    return result


def cells(name: str, value: ArrayLike, nodes: int, distinct: bool = True) -> NDArray[np.int64]:
    """A read-only array of cells with that many nodes each; no cell may have a node twice, nor be there twice."""
    wanted = f"an array of whole numbers of shape (n, {nodes}) with n >= 1"
    result = _array(name, value, wanted)
    if result.ndim != 2 or result.shape[1] != nodes or not len(result) or result.dtype.kind not in "iu":
        what = f"{result.dtype} of shape {result.shape}" if result.ndim else shown(value)
        raise ValueError(f"{name} must be {wanted}, not {what}.")
    ordered = np.sort(result, axis=1)
    twice = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    if len(twice):
        raise ValueError(
            f"{name}: cell {twice[0]} has a node twice, {result[twice[0]].tolist()}; remove or mend the cell."
        )
    _, first, count = np.unique(ordered, axis=0, return_index=True, return_counts=True)
    if distinct and (count > 1).any():
        cell = first[count > 1].min()
        other = np.flatnonzero((ordered == ordered[cell]).all(axis=1))[1]
        raise ValueError(
            f"{name}: cells {cell} and {other} have the same nodes, {result[cell].tolist()}; remove one, "
            "or make the second a part of its own."
        )
    return _frozen_integers(result)


def in_range(name: str, numbers: NDArray[np.int64], count: int, of: str) -> None:
    """Refuses numbers outside 0 ... count - 1."""
    bad = numbers[(numbers < 0) | (numbers >= count)]
    if len(bad):
        raise ValueError(f"{name} names {of} {bad[0]}, which does not exist; {of}s are numbered 0 to {count - 1}.")


def components(name: str, value: str) -> tuple[int, ...]:
    """Components as column numbers: "xz" is (0, 2)."""
    if not isinstance(value, str) or not value or set(value) - set("xyz") or len(set(value)) < len(value):
        raise ValueError(f'{name} is {value!r}; give one or more of the letters x, y and z, like "xyz" or "z".')
    return tuple("xyz".index(letter) for letter in value)


def name(what: str, value: Any) -> str:
    """A text that is not empty."""
    if not isinstance(value, str) or not value:
        raise ValueError(f"The name of a {what} is {value!r}; give a text.")
    return value


def instance(what: str, value: Any, kind: Any) -> None:
    """Refuses an object of another kind (a class, or several joined by |)."""
    if not isinstance(value, kind):
        hint = ", with brackets behind its name" if isinstance(value, type) else ""
        raise ValueError(f"{what} is {shown(value)}; give {_article(_expected(kind))}{hint}.")


def instances(name: str, values: Any, kind: Any) -> tuple[Any, ...]:
    """A tuple of objects of a kind (a class, or several joined by |), from any sequence of them."""
    if not isinstance(values, Sequence) or isinstance(values, str):
        raise ValueError(f"{name} must be a list of {_expected(kind)}, not {shown(values)}; put it in brackets.")
    for value in values:
        if not isinstance(value, kind):
            raise ValueError(f"{name} has {shown(value)}; give a list of {_expected(kind)}.")
    return tuple(values)


def unique(name: str, values: Iterable[str]) -> None:
    """Refuses a name given twice."""
    seen: set[str] = set()
    for value in values:
        if value in seen:
            raise ValueError(f"{name} {value!r} is given twice; names must differ.")
        seen.add(value)


def _array(name: str, value: Any, wanted: str) -> NDArray[Any]:
    """Any array; rows of unequal length are none."""
    try:
        return np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} must be {wanted}, not {shown(value)}.") from None


def _expected(kind: Any) -> str:
    names = (entry.__name__ for entry in getattr(kind, "__args__", (kind,)))
    return " or ".join({"str": "text", "Mapping": "dictionary"}.get(name, name) for name in names)


def _frozen_integers(array: NDArray[Any]) -> NDArray[np.int64]:
    result = array.astype(np.int64)
    result.setflags(write=False)
    return result
