"""PETSc and SLEPc, loaded after MPI, and without two habits that a script would notice.

dolfinx's wheel needs the MPI library to be loaded before it. PETSc takes a pipe that is closed at its other end,
`script.py | head`, for a crash; to Python it is an exception: the handler that was there is put back. At its end PETSc
waits for all processes, before `python -m mpi4py` can end them for an exception of one: that is done here. Python ends
modules in the reverse order of their start, so that SLEPc, which waits too, must be loaded before.
"""

import atexit
import signal
import sys
import threading

from mpi4py import MPI


def _load() -> None:
    handler = signal.getsignal(signal.SIGPIPE)
    from petsc4py import PETSc  # noqa: F401, PLC0415  (between the two)
    from slepc4py import SLEPc  # noqa: F401, PLC0415

    if handler is not None and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, handler)


def _end_all() -> None:
    """End all processes if this one ends by an exception and runs under `python -m mpi4py`."""
    if "mpi4py.run" in sys.modules and MPI.COMM_WORLD.size > 1 and getattr(sys, "last_value", None) is not None:
        sys.stderr.flush()
        MPI.COMM_WORLD.Abort(1)


_load()
atexit.register(_end_all)
