"""Loads and numbers given for a membrane by its name, on the strips that are cut from it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from ..checks import validation
from ..model.ponds import Pond
from .strips import Strips

T = TypeVar("T")


def by_strip(strips: Strips, given: Mapping[str, T]) -> dict[str, T]:
    """Entries by the name of strips, from those of strips and of membranes; the entry of a strip comes first."""
    found: dict[str, T] = {}
    for name, value in given.items():
        if name not in strips.names:
            found |= dict.fromkeys(strips.cut_from(name) or (name,), value)
    return found | {name: value for name, value in given.items() if name in strips.names}


def on_strips(what: str, strips: Strips, given: Sequence[T]) -> list[T]:
    """Put loads or changes of a membrane on all strips that are cut from it.

    Raises:
        ValueError: They are no list; one is a pond, or on cells of the membrane, or has values for them.
    """
    validation.listed(what, given, "loads or changes", "", hasattr(given, "__dataclass_fields__"))
    return [placed for entry in given for placed in _placed(what, strips, entry)]


def _placed(what: str, strips: Strips, entry: Any) -> list[Any]:
    name = getattr(entry, "part", None)
    if not isinstance(name, str) or name in strips.structure.parts or not strips.cut_from(name):
        return [entry]
    names, kind = list(strips.cut_from(name)), type(entry).__name__
    if isinstance(entry, Pond):
        raise ValueError(f"{what}: a Pond is on {name!r}, which is cut; name the strip that it lies on, of {names}.")
    if getattr(entry, "cells", None) is not None or _of_cells(entry):
        raise ValueError(
            f"{what}: a {kind} is on cells of {name!r}, which have other numbers in its strips; leave cells out, or "
            f"name the strips, {names}."
        )
    return [replace(entry, part=strip) for strip in names]


def _of_cells(entry: Any) -> bool:
    """Return True if an entry has values for cells: more than a number, a pair, a vector or a tensor."""
    return any(np.shape(getattr(entry, field.name)) not in ((), (2,), (3,), (2, 2)) for field in fields(entry))
