"""Signal of a pipe that is closed at its other end, `script.py | head`: PETSc takes it for a crash."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def kept_pipe_signal() -> Iterator[None]:
    """Put the handler of that signal back after PETSc was loaded: to Python a closed pipe is an exception."""
    handler = signal.getsignal(signal.SIGPIPE)
    try:
        yield
    finally:
        if handler is not None and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGPIPE, handler)
