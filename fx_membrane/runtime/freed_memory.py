"""Return of freed memory to the system, and release of meshes that circles of references keep.

SuperLU_DIST, which PETSc may load, makes the C library keep all that is freed. Holes that the setup of an analysis has
left are too small for its factors, and add to the peak.
"""

from __future__ import annotations

import ctypes
import gc
from contextlib import suppress
from typing import Any
from weakref import WeakSet

# Rows of a process; below, fetching the memory again takes more time than its return is worth.
LARGE_PROBLEM = 1_000_000
MESHES = 64  # added to those alive from one collection to the next; each takes 13 communicators, MPICH has 2048

_alive: WeakSet[Any] = WeakSet()
_limit = [MESHES]  # of meshes alive, at which unreachable ones are looked for


def return_freed_memory(rows: int) -> None:
    """Return free memory to the system, with glibc, if a process has many rows of a matrix."""
    if rows > LARGE_PROBLEM:
        with suppress(OSError, AttributeError):  # macOS, musl
            ctypes.CDLL(None).malloc_trim(0)


def count_mesh(mesh: object) -> None:
    """Count a mesh as alive until nothing refers to it; free those in circles, as of caught errors, if many are alive.

    The garbage collector counts objects of Python, not communicators: MPICH ends a process that asks for too many.
    """
    _alive.add(mesh)
    if len(_alive) >= _limit[0]:
        gc.collect()
        _limit[0] = len(_alive) + MESHES
    _limit[0] = min(_limit[0], len(_alive) + MESHES)
