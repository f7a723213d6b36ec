"""Return of freed memory to the system, and release of meshes that circles of references keep.

SuperLU_DIST, which PETSc may load, makes the C library keep all that is freed. Holes that the setup of an analysis has
left are too small for its factors, and add to the peak.
"""

from __future__ import annotations

import ctypes
import gc
from contextlib import suppress
from itertools import count

LARGE = 1_000_000  # rows of a process; below, fetching the memory again takes more time than its return is worth
MESHES = 64  # made from one collection to the next; each takes about 13 communicators, of which MPICH has 2048

_made = count(1)


def return_freed_memory(rows: int) -> None:
    """Return free memory to the system, with glibc, if a process has many rows of a matrix."""
    if rows > LARGE:
        with suppress(OSError, AttributeError):  # macOS, musl
            ctypes.CDLL(None).malloc_trim(0)


def free_unreachable_meshes() -> None:
    """Free meshes in circles of references, as of caught errors, for each 64th mesh; call before one is made.

    The garbage collector counts objects of Python, not communicators: MPICH ends a process that asks for too many.
    """
    if next(_made) % MESHES == 0:
        gc.collect()
