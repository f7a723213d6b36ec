"""Messages to the user during a run."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from mpi4py import MPI
from tqdm import tqdm

from .printable_text import printable

_silenced = [False]


def say(text: str) -> None:
    """Print a line to stderr, beside any progress bar; only one process prints."""
    if MPI.COMM_WORLD.rank == 0 and sys.stderr is not None and not silent():
        tqdm.write(printable(text), file=sys.stderr)


def silent() -> bool:
    """Return True within `silence`."""
    return _silenced[-1]


@contextmanager
def silence(wanted: bool = True) -> Iterator[None]:
    """Keep messages and progress of a run from the user; warnings and errors stay."""
    _silenced.append(wanted or silent())
    try:
        yield
    finally:
        _silenced.pop()
