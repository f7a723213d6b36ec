"""Check of a state: number, limit, verdict, place and remedy."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from .reader_words import for_readers


class Verdict(Enum):
    """Verdict of a check."""

    PASS = "PASS"
    WARN = "WARN"
    FAIL = "FAIL"


class Check(NamedTuple):
    """Check of a state.

    Attributes:
        name: The fact that is checked.
        found: Its number, as text.
        limit: The limit, as text; empty without one.
        verdict: The verdict.
        remedy: What to do about it; empty if it passes.
        place: Place of the worst node or cell; empty if it passes or has none.
        design: True for a limit of the design, which says nothing against the numbers.
    """

    name: str
    found: str
    limit: str
    verdict: Verdict
    remedy: str = ""
    place: str = ""
    design: bool = False

    @property
    def advice(self) -> str:
        """Place and remedy in one text, for readers with and without a script."""
        return ": ".join(filter(None, (self.place, for_readers(self.remedy))))
