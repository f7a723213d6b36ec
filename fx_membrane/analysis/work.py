"""Limit of the work of a stage or a path, counted over all attempts."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import monotonic

from mpi4py import MPI

from ..checks import validation
from ..checks.values import counted
from ..solvers.base import Iteration, Monitor


@dataclass(frozen=True)
class WorkLimit:
    """Maximum work of a stage of an `Analysis` or a path of `equilibrium_path`, successful or not.

    Iterations are those of all increments, of rejected attempts and of the homotopy. A stage that takes more ends with
    a ConvergenceError, which has its last converged state; a path with a PathError, which has its points. A
    single iteration is not interrupted. With a checkpoint, the next run resumes there, with the whole limit available.

    Args:
        iterations: Maximum number of iterations; None for no limit beyond those of the solver for each increment.
        seconds: Maximum time by the clock of the first process [s]; None for no limit.

    Raises:
        ValueError: A number is not above zero, or iterations is not a whole number.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> try:
        ...     Analysis(rope, limit=WorkLimit(iterations=1)).run([pull])
        ... except ConvergenceError as error:
        ...     print(error.failed.outcome.name)
        ...
        WORK_LIMIT
    """

    iterations: int | None = None
    seconds: float | None = None

    def __post_init__(self) -> None:
        if self.iterations is not None:
            validation.store(self, validation.positive_integer, "iterations")
        if self.seconds is not None:
            validation.store(self, validation.positive, "seconds")


class WorkDone(Exception):  # noqa: N818  (a message from the monitor to whoever runs the solver)
    """Exception that ends a solve from its monitor, with the reason as a sentence."""


@dataclass
class Work:
    """Count of the work of a stage or a path: a monitor that ends the solve at the limit.

    Attributes:
        iterates: Iterates of the present increment, or of the path, the first of each attempt included.
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
        """Count an iterate; called again with the same one if it takes long.

        Raises:
            WorkDone: The limit is reached; on all processes together.
        """
        if not self.iterates or entry is not self.iterates[-1]:
            self.iterates.append(entry)
            self._count += number > 0  # the start of an attempt is no iteration
        self.monitor(number, entry)
        if self.limit.iterations is not None and self._count > self.limit.iterations:
            self._end(f"the limit of {counted(self.limit.iterations, 'iteration')} for {self.what} is used up")
        if self.limit.seconds is not None:
            elapsed = self.comm.bcast(monotonic() - self._began)
            if elapsed >= self.limit.seconds:
                taken = counted(self._count, "iteration")
                self._end(f"the limit of {self.limit.seconds:g} s for {self.what} is used up, after {taken}")

    def _end(self, reason: str) -> None:
        self.over = reason
        raise WorkDone(reason)
