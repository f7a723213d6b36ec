"""Checks of objects on entry: of one kind, of no derived class, in a list; each raises one clear sentence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from mpi4py import MPI

from .values import expected, short_repr, with_article


def communicator(name: str, value: Any) -> MPI.Intracomm:
    """Check for processes that share the work."""
    if not isinstance(value, MPI.Intracomm) or value == MPI.COMM_NULL:
        raise ValueError(f"{name} is {short_repr(value)}; give a communicator of mpi4py, as MPI.COMM_WORLD.")
    return value


def instance(what: str, value: Any, kind: Any) -> None:
    """Refuse an object of another kind (a class, or several joined by |)."""
    if not isinstance(value, kind):
        hint = ", with brackets behind its name" if isinstance(value, type) else ""
        inside = [key for key, entry in value.items() if isinstance(entry, kind)] if isinstance(value, Mapping) else []
        hint = f", as its entry [{inside[0]!r}]" if inside else hint
        raise ValueError(f"{what} is {short_repr(value)}; give {with_article(expected(kind))}{hint}.")


def plain(what: str, value: Any, kind: Any) -> None:
    """Refuse an object of another kind or of a derived class, whose own data and methods nothing would use."""
    instance(what, value, kind)
    _refuse_derived(f"{what} is", value, kind)


def _refuse_derived(what: str, value: Any, kind: Any) -> None:
    if type(value) not in getattr(kind, "__args__", (kind,)):
        raise ValueError(
            f"{what} {with_article(type(value).__name__)}, a class derived from {type(value).__mro__[1].__name__}, "
            f"whose own data and methods would not be used; give {with_article(expected(kind))} itself."
        )


def listed(name: str, values: Any, words: str, example: str, alone: bool) -> None:
    """Refuse what is no list, with brackets as the remedy for one object of it.

    Args:
        name: Name of the list.
        values: The list.
        words: Objects of the list.
        example: Name of a class of these, or "".
        alone: True for one of them.
    """
    if isinstance(values, Sequence) and not isinstance(values, str | bytes | bytearray):
        return
    remedy = "put it in brackets" if alone else (f"give [{example}(...)]" if example else "give one")
    raise ValueError(f"{name} must be a list of {words}, not {short_repr(values)}; {remedy}.")


def instances(name: str, values: Any, kind: Any) -> tuple[Any, ...]:
    """Make a tuple of objects of a kind (a class, or several joined by |), from any sequence of them."""
    first = getattr(kind, "__args__", (kind,))[0].__name__
    listed(name, values, expected(kind), first, isinstance(values, kind))
    for value in values:
        if not isinstance(value, kind):
            raise ValueError(f"{name} has {short_repr(value)}; give a list of {expected(kind)}.")
        if kind is not str:
            _refuse_derived(f"{name} has", value, kind)
    return tuple(values)
