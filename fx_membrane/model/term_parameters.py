"""Parameters of energy terms: their kinds, and their values on the cells of a part."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from . import term_trial

Array = NDArray[np.float64]

RESERVED = ("part", "cells", "quadrature_degree")


def described(term: Any) -> str:
    """Name of a term in messages and tables: its class and its part."""
    return f"{type(term).__name__} on {term.part!r}"


def kinds(term: Any) -> term_trial.Kinds:
    """Kinds of the parameters of a term: terms of a class and of equal kinds share their forms."""
    found = []
    for name in names(term):
        shape = np.shape(getattr(term, name))
        uniform = shape in ((), (3,))
        found.append((name, "constant" if uniform else "cells", 3 if shape[-1:] == (3,) else 1))
    return tuple(found)


def signature(term: Any) -> str:
    """Digest of the formula of a term."""
    return term_trial.signature(term, kinds(term))


def values(term: Any, count: int, named: str = "") -> dict[str, Array]:
    """Parameters of a term on a part, by name: shape () or (3,) for all cells, (cells, 1) or (cells, 3) for each.

    Outside the cells of the term a parameter of each has the value of its first.

    Args:
        term: The term.
        count: Number of cells of the part.
        named: Name of the term in messages.

    Raises:
        ValueError: An array has another length.
    """
    cells = chosen(term, count)
    found: dict[str, Array] = {}
    for name in names(term):
        value = np.asarray(getattr(term, name), dtype=np.float64)
        if value.shape not in ((), (3,)):
            if value.ndim > 2 or len(value) != len(cells) or value.shape[1:] not in ((), (1,), (3,)):
                n = len(cells)
                raise ValueError(
                    f"{named} has the parameter {name} of shape {value.shape}; give a number, a vector (3,), or one "
                    f"for each of its {n} cells: ({n}, 1) or ({n}, 3). Shape (3,) is always one vector."
                )
            value = _on_part(value.reshape(len(cells), -1), cells, count)
        found[name] = value
    return found


def change_of(term: Any, count: int, name: str, given: Any) -> Array:
    """Change of a parameter of a term on a part, in the shape that `values` has for it.

    Args:
        term: The term.
        count: Number of cells of the part.
        name: Name of the parameter.
        given: The change, in the shape of the parameter; one row for all cells, too, where it has one for each.

    Raises:
        ValueError: The parameter does not exist, or the change has another shape.
    """
    known = values(term, count)
    if not isinstance(name, str) or name not in known:
        raise ValueError(
            f"{described(term)} has no parameter {validation.short_repr(name)}; "
            f"{f'those with a derivative are {list(known)}' if known else 'it has none at all'}."
        )
    what = f"direction of {name!r}"
    value, own = validation.finite(what, given), known[name]
    if own.ndim < 2:
        shapes = [own.shape]
    else:
        size, cells = own.shape[1], chosen(term, count)
        shapes = [(), (len(cells),), (len(cells), 1)] if size == 1 else [(3,), (len(cells), 3)]
    if value.shape not in shapes:
        wanted = " or ".join(f"shape {shape}" if shape else "a number" for shape in shapes)
        raise ValueError(f"The {what} of {described(term)} has shape {value.shape}; give {wanted}.")
    if own.ndim < 2:
        return value
    single = value.shape in ((), (3,)) and value.shape == shapes[0]
    return _on_part(np.broadcast_to(value, (len(cells), size)) if single else value.reshape(-1, size), cells, count)


def touched(structure: Any, terms: Sequence[Any]) -> NDArray[np.bool_]:
    """Nodes on which terms act, shape (n,)."""
    found = np.zeros(len(structure.points), dtype=bool)
    for term in terms:
        cells = structure.parts[term.part].cells
        found[cells[chosen(term, len(cells))]] = True
    return found


def chosen(term: Any, count: int) -> NDArray[np.int64]:
    """Numbers of the cells on which a term acts."""
    cells = getattr(term, "cells", None)
    return np.arange(count) if cells is None else np.asarray(cells)


def names(term: Any) -> list[str]:
    """Names of the parameters of a term: fields that are not reserved."""
    return [entry.name for entry in dataclasses.fields(term) if entry.name not in RESERVED]


def _on_part(rows: Array, cells: NDArray[np.int64], count: int) -> Array:
    """Spread rows of some cells over a part; other cells have the first row."""
    found = np.repeat(rows[:1], count, axis=0)
    found[cells] = rows
    return found
