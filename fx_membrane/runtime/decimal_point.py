"""A decimal point for C libraries, where the program has chosen a decimal comma, as Qt does."""

import locale
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def decimal_point() -> Iterator[None]:
    """C reads and writes 0.5, not 0,5, in this block: SCOTCH builds its strategy of text, PETSc parses options."""
    chosen = locale.setlocale(locale.LC_NUMERIC)
    locale.setlocale(locale.LC_NUMERIC, "C")
    try:
        yield
    finally:
        locale.setlocale(locale.LC_NUMERIC, chosen)
