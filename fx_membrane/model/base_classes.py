"""Base classes of the data of a structure and its stages: types of lists and dictionaries of several kinds."""

from __future__ import annotations

from .by_value import ByValue


class AnyPart(ByValue):
    """A membrane, a cable, a mast or a rope."""


class AnyLoad(ByValue):
    """A load of a stage; energy terms of a user's own are others."""


class AnyChange(ByValue):
    """A change of natural shape, prestress, force, gas or air."""
