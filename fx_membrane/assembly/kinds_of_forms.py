"""Kinds of parts whose formulas are the same, so that their compiled forms are found without a walk through them.

A form of UFL is known by its signature, for which all of its formula is read; for small structures that takes most of
the time of a run. Formulas of the package depend on a few facts, which are the kind of a part. Those of a user's own
law may depend on anything, and are read each time.
"""

from __future__ import annotations

from collections.abc import Hashable

from ..model import materials
from ..model.parts import Part

Kind = tuple[Hashable, ...]
NO_KIND: Kind = ()


def kind_of(part: Part, elastic: bool = True, natural: bool = False) -> Kind:
    """All that the formulas of a part depend on, numbers aside; `NO_KIND` if that is not known.

    The forms of a part make their functions and constants in one order, by which compiled code knows them.

    Args:
        part: The part.
        elastic: False if the prestress is the only stress.
        natural: True for a natural shape.
    """
    if not materials.is_shipped(part.material):
        return NO_KIND
    return type(part.material), part.dimension, part.is_strut, part.shares_tension, elastic, natural


def named(name: str, kind: Kind) -> Kind:
    """Name of a form of a part of a kind, and of that form alone; `NO_KIND` for parts without a kind."""
    return (name, *kind) if kind else NO_KIND
