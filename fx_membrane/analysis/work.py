"""A bound on the work of a stage or a path, counted over all that is tried."""

from dataclasses import dataclass, field
from time import monotonic

from mpi4py import MPI

from ..checks import validation
from ..solvers.base import Iteration, Monitor


@dataclass(frozen=True)
class WorkLimit:
    """Most work that a stage of an `Analysis` or a path of `trace` may take, whatever comes of it.

    Iterations are those of all increments, of tries that came to nothing, and of those that draw a structure smooth.
    A stage that takes more ends with a ConvergenceError, which has its last converged state; a path with a
    ContinuationError, which has its points. A single iteration is not interrupted. With a checkpoint the next run
    begins where this one ended, with the whole limit before it.

    Args:
        iterations: Most iterations; None for no limit but those of the solver for each increment.
        seconds: Most time by the clock of the first process [s]; None for no limit.

    Raises:
        ValueError: A number is not above zero, or iterations is not a whole one.
    """

    iterations: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if self.iterations is not None:
            validation.store(self, validation.whole, "iterations")
        if self.seconds is not None:
            validation.store(self, validation.positive, "seconds")


class WorkDone(Exception):  # noqa: N818  (a message from the monitor to whoever runs the solver)
    """Ends a solve from its monitor, with the reason in words."""


@dataclass
class Work:
    """Counts the work of a stage or a path; a monitor that ends the solve where the limit is reached.

    Attributes:
        iterates: Those of the present increment, or of the path, the first of each try included.
        what: Name of what is limited.
        over: That the limit is reached, in words; empty before.
    """

    limit: WorkLimit
    comm: MPI.Intracomm
    monitor: Monitor
    iterates: list[Iteration] = field(default_factory=list)
    over: str = ""
    what: str = "a stage"
    _count: int = 0
    _began: float = 0.0

    def __post_init__(self) -> None:
        self._began = monotonic()

    def __call__(self, number: int, entry: Iteration) -> None:
        """Hears of an iterate; of the same again where one takes long.

        Raises:
            WorkDone: The limit is reached; on all processes together.
        """
        if not self.iterates or entry is not self.iterates[-1]:
            self.iterates.append(entry)
            self._count += number > 0  # the start of a try is no iteration
        self.monitor(number, entry)
        if self.limit.iterations is not None and self._count > self.limit.iterations:
            self._end(f"the limit of {self.limit.iterations} iterations for {self.what} is used up")
        if self.limit.seconds is not None:
            elapsed = self.comm.bcast(monotonic() - self._began)
            if elapsed >= self.limit.seconds:
                self._end(
                    f"the limit of {self.limit.seconds:g} s for {self.what} is used up, after {self._count} iterations"
                )

    def _end(self, reason: str) -> None:
        self.over = reason
        raise WorkDone(reason)
