"""PETSc, loaded after MPI and without its signal handler for closed pipes.

dolfinx's wheel needs the MPI library to be loaded before it. PETSc takes a pipe closed at its other end, `script.py |
head`, for a crash; Python raises an exception. So the previous handler is restored.
"""

import signal
import threading

from mpi4py import MPI  # noqa: F401


def _load() -> None:
    handler = signal.getsignal(signal.SIGPIPE)
    from petsc4py import PETSc  # noqa: F401, PLC0415  (between the two)

    if handler is not None and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGPIPE, handler)


_load()
