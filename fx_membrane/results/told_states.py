"""Sentences on states, and the warnings that tell them."""

from __future__ import annotations

from typing import Self


class UnstableStateWarning(UserWarning):
    """Equilibrium that is unstable, very far from the start of the stage, or held by slack parts."""


class CrushedGasWarning(UserWarning):
    """Chamber whose volume, or absolute pressure, is not positive."""


class LostPrestressWarning(UserWarning):
    """State in which a prestressed part has almost no tension left in any cell."""


class Remark(str):
    """A sentence on a state.

    Attributes:
        category: Class of the warning that tells it.
    """

    category: type[UserWarning]

    def __new__(cls, sentence: str, category: type[UserWarning] = UnstableStateWarning) -> Self:
        """Make a sentence of a category."""
        remark = super().__new__(cls, sentence)
        remark.category = category
        return remark
