"""Compensation of a case: by prestress, factors or biaxial tests, for all strips or by the name of a strip."""

from __future__ import annotations

from typing import Any

from ...patterns.biaxial_tests import BiaxialTests
from ...patterns.compensations import factors_of
from .faults import Faults
from .fields import TESTS

TRAIL = ("patterns", "compensation")


def check_compensation(faults: Faults, given: Any) -> None:
    """Check factors and tests; names of strips are known after the cut."""
    by_strip = isinstance(given, dict) and not is_tested(given)
    for name, entry in given.items() if by_strip else [(None, given)]:
        with faults.at(*TRAIL, *([] if name is None else [name])):
            if is_tested(entry):
                BiaxialTests(**entry)
            elif entry != "prestress":
                factors_of("compensation", entry)


def compensation_from(given: Any) -> Any:
    """Make the argument of `cutting_pattern` of a compensation without faults."""
    if is_tested(given):
        return BiaxialTests(**given)
    return {name: compensation_from(entry) for name, entry in given.items()} if isinstance(given, dict) else given


def is_tested(given: Any) -> bool:
    """Tell tables of biaxial tests from those of strips."""
    return isinstance(given, dict) and given.keys() == TESTS.keys()
