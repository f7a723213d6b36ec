"""Return of freed memory to the system.

SuperLU_DIST, which PETSc may load, makes the C library keep all that is freed. Holes that the setup of an analysis has
left are too small for its factors, and add to the peak.
"""

from __future__ import annotations

import ctypes
from contextlib import suppress

LARGE = 1_000_000  # rows of a process; below, fetching the memory again takes more time than its return is worth


def return_freed_memory(rows: int) -> None:
    """Return free memory to the system, with glibc, if a process has many rows of a matrix."""
    if rows > LARGE:
        with suppress(OSError, AttributeError):  # macOS, musl
            ctypes.CDLL(None).malloc_trim(0)
