"""Decimal point for C libraries, if the program has chosen a decimal comma, as Qt does."""

from __future__ import annotations

import locale
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def decimal_point() -> Iterator[None]:
    """Make C use 0.5, not 0,5, in this block: SCOTCH builds its strategy from text, PETSc parses options."""
    chosen = locale.setlocale(locale.LC_NUMERIC)
    locale.setlocale(locale.LC_NUMERIC, "C")
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, chosen)
