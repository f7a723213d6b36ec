"""Processes that share the work: errors of one raised by all, and refusal of differing input."""

from __future__ import annotations

import math
import pickle
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import wraps
from typing import Any, ParamSpec

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

OUTCOME = 2003  # tag of messages with the outcome of an act

P = ParamSpec("P")


@contextmanager
def together(comm: MPI.Intracomm) -> Iterator[None]:
    """Raise an exception of any process on all of them, so that none waits for one that has left.

    The block must not communicate. If several processes raise, all raise the exception of the first one.
    """
    error: Exception | None = None
    try:
        yield
    except Exception as raised:
        if comm.size == 1:
            raise
        error = raised
    if not somewhere(comm, error is not None):
        return
    errors = comm.allgather(_portable(error))
    rank, first = next((rank, other) for rank, other in enumerate(errors) if other is not None)
    if rank == comm.rank and error is not None:
        raise error
    raise first from error


def by_the_first(act: Callable[P, None]) -> Callable[P, None]:
    """Leave an act to the first process; raise its exceptions on all processes.

    The first process sends and does not wait: it may be the only one that calls.
    """

    @wraps(act)
    def shared(*args: P.args, **kwargs: P.kwargs) -> None:
        comm, error = MPI.COMM_WORLD, None
        if comm.rank == 0:
            try:
                act(*args, **kwargs)
            except Exception as raised:
                error = raised
            for other in range(1, comm.size):
                comm.send(_portable(error), other, OUTCOME)
        else:
            error = comm.recv(source=0, tag=OUTCOME)
        if error is not None:
            raise error

    return shared


def refuse_differences(comm: MPI.Intracomm, digests: Callable[[], Mapping[str, str]]) -> None:
    """Refuse input that differs between processes, on all of them.

    Args:
        comm: The processes.
        digests: Digests of the input by subject; not called for one process.

    Raises:
        ValueError: The input differs.
    """
    if comm.size == 1:
        return
    with together(comm):
        mine = dict(digests())
    first, *others = comm.allgather(mine)
    for number, other in enumerate(others, 1):
        names = [name for name in first | other if first.get(name) != other.get(name)]
        if names:
            more = f" and {len(names) - 3} more" if len(names) > 3 else ""
            raise ValueError(
                f"The input of process {number} differs from that of process 0 in: {', '.join(names[:3])}{more}; give "
                "all processes the same: draw random numbers and read files on one of them, and broadcast."
            )


def everywhere(comm: MPI.Intracomm, flag: bool) -> bool:
    """Return True if a flag is set on all processes; collective.

    One message of numbers: `Comm.allreduce` of mpi4py sends objects, several messages for each pair of processes.
    """
    return bool(flag) if comm.size == 1 else bool(_reduced(comm, float(flag), MPI.MIN))


def somewhere(comm: MPI.Intracomm, flag: bool) -> bool:
    """Return True if a flag is set on some process; collective."""
    return not everywhere(comm, not flag)


def summed(comm: MPI.Intracomm, value: float) -> float:
    """Sum of the values of all processes; collective."""
    return value if comm.size == 1 else _reduced(comm, value, MPI.SUM)


def _reduced(comm: MPI.Intracomm, value: float, operation: MPI.Op) -> float:
    values = np.array([value], dtype=np.float64)
    comm.Allreduce(MPI.IN_PLACE, values, operation)
    return float(values[0])


def gathered(comm: MPI.Intracomm, rows: NDArray[Any]) -> NDArray[Any]:
    """Rows of all processes on each, one process after the other; those of a single process are not copied.

    Args:
        comm: The processes.
        rows: Rows of this process, of the same type and length on all, shape (n, ...).
    """
    if comm.size == 1:
        return rows
    counts = np.asarray(comm.allgather(len(rows)))
    total = np.empty((counts.sum(), *rows.shape[1:]), dtype=rows.dtype)
    comm.Allgatherv(np.ascontiguousarray(rows), [total, counts * math.prod(rows.shape[1:])])
    return total


def _portable(error: Exception | None) -> Exception | None:
    """Replace an exception that cannot be sent by one with the same text."""
    try:
        copy = pickle.loads(pickle.dumps(error))
        return error if str(copy) == str(error) else RuntimeError(f"{type(error).__name__}: {error}")
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
