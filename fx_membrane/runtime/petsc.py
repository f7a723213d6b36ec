"""PETSc and SLEPc, loaded after MPI, and without two habits that a script would notice.

dolfinx's wheel needs the MPI library to be loaded before it. PETSc takes a closed pipe for a crash. At its end PETSc
waits for all processes, before `python -m mpi4py` can end them for an exception of one: that is done here. Python ends
modules in the reverse order of their start, so that SLEPc, which waits too, must be loaded before.
"""

from __future__ import annotations

import atexit
import sys

from mpi4py import MPI

from .pipe_signal import kept_pipe_signal


def _load() -> None:
    with kept_pipe_signal():
        from petsc4py import PETSc  # noqa: F401, PLC0415  (within)
        from slepc4py import SLEPc  # noqa: F401, PLC0415


def _end_all() -> None:
    """End all processes if this one ends by an exception and runs under `python -m mpi4py`."""
    if "mpi4py.run" in sys.modules and MPI.COMM_WORLD.size > 1 and getattr(sys, "last_value", None) is not None:
        sys.stderr.flush()
        MPI.COMM_WORLD.Abort(1)


_load()
atexit.register(_end_all)
