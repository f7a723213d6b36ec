"""Control of load increments: accept a solution, halve the increment, or stop.

Two controllers judge each solution. `IncrementControl` halves after failures and lets increments grow back. `Bracket`
closes in on a critical load: the structure is stable below it, and has lost its stability beyond. `Ceiling` limits the
increments by the smallest load factor that failed.

Model: P. Kidger, On neural differential equations, PhD thesis, Oxford (2021), and his diffrax: a step-size controller
accepts or rejects a step, and gives the length of the next.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ..assembly.gas import ChamberResult
from ..model.stages import Stage
from ..model.water_events import BasinResult, WaterEvent
from ..results.load_increments import Increment
from ..solvers.base import Solution
from ..solvers.outcome import Outcome
from .checkpoint_file import Progress


@dataclass(frozen=True)
class IncrementLimits:
    """Limits of the increments.

    Attributes:
        halvings: Maximum number of halvings of the increment that the stage asks for.
        near: Accuracy of the largest load, as a fraction of its load factor, if more would take long.
        long: Number of lost iterates that is long.
    """

    halvings: int = 8
    near: Fraction = Fraction(1, 50)
    long: int = 500


LIMITS = IncrementLimits()


class Verdict(Enum):
    """Verdict on a solution: what follows it."""

    ACCEPT = "the stage continues from it."
    HALVE = "half of the increment is tried."
    STOP = "no smaller increment can help."


@dataclass
class Ceiling:
    """The least load factor that failed from the previous states.

    Attributes:
        factor: That load factor; None before the first failure.
        vain: Number of iterates spent on it.
        smooth: True if the homotopy may still help; it starts afresh for any increment.
    """

    factor: Fraction | None = None
    vain: int = 0
    smooth: bool = True

    def next(self, start: Fraction, size: Fraction) -> Fraction:
        """Load factor to try from a start."""
        limit = self.factor if self.factor is not None and self.vain >= LIMITS.long else Fraction(1)
        return min(start + size, limit)

    def found(self, factor: Fraction) -> None:
        """Record a load factor with an equilibrium."""
        if self.factor is not None and factor >= self.factor:
            self.factor, self.vain, self.smooth = None, 0, True

    def failed(self, factor: Fraction, iterates: int) -> None:
        """Record a load factor without an equilibrium."""
        # A fallback that fails near a load fails closer to it, too; at half of the load it may help.
        self.smooth = self.factor is not None and 2 * factor <= self.factor
        self.factor = factor
        self.vain += iterates

    def near(self, start: Fraction) -> bool:
        """Return True if a start is close to the ceiling."""
        return self.factor is not None and self.factor - start <= LIMITS.near * self.factor

    def reached(self, start: Fraction) -> bool:
        """Return True if a start counts as the end: close to the ceiling after many lost iterations."""
        return self.vain >= LIMITS.long and self.near(start)


@dataclass
class Bracket:
    """Bracket of the critical load at which a structure loses its stability, the first of a stage.

    Attributes:
        beyond: State beyond the critical load, while smaller increments bracket it.
    """

    beyond: Progress | None = None

    def passed(self, state: Progress, solution: Solution, balanced: bool) -> bool:
        """Return True if an equilibrium lies beyond a critical load, seen from a state.

        Args:
            state: The state.
            solution: The equilibrium.
            balanced: True if the start of the stage is an equilibrium.
        """
        judged = balanced or state.factor > 0
        first = not any(entry.outcome.lost_stability for entry in state.increments)
        return solution.converged and solution.lost_stability and judged and first


@dataclass
class IncrementControl:
    """Controller of the load increments of a stage.

    Attributes:
        stage: The stage.
        state: The last state found, and the size of the increment to try.
        balanced: True if the start of the stage is an equilibrium.
        factor: Load factor of the last try.
        reached: State that follows the last one, once a solution is accepted.
    """

    stage: Stage
    state: Progress
    balanced: bool
    ceiling: Ceiling = field(default_factory=Ceiling)
    bracket: Bracket = field(default_factory=Bracket)
    factor: Fraction = Fraction(0)
    reached: Progress | None = None

    @property
    def thorough(self) -> bool:
        """True if the solver may use fallbacks that find distant states."""
        return self.ceiling.smooth and self.bracket.beyond is None

    @property
    def lost(self) -> Progress | None:
        """The accepted state, if it lies beyond a loss of stability."""
        return self.reached if self.reached is self.bracket.beyond else None

    def next(self) -> Fraction:
        """Load factor to try next."""
        self.factor = self.ceiling.next(self.state.factor, self.state.size)
        return self.factor

    def judge(self, solution: Solution, shape: NDArray[np.float64] | None, iterates: int) -> Verdict:
        """Judge the solution of a try.

        Args:
            solution: The solution.
            shape: Its displacement, shape (n, 3) [m]; None of a failure.
            iterates: Number of iterates that it took.
        """
        found = None
        lost = self.bracket.passed(self.state, solution, self.balanced)
        if shape is None:
            self.ceiling.failed(self.factor, iterates)
        else:
            found = self._found(solution, shape, lost)
        if lost:
            self.bracket.beyond = found
        if (lost or solution.outcome.retry) and self._divisible(lost):
            self.state = replace(self.state, size=(self.factor - self.state.factor) / 2)
            return Verdict.HALVE
        self.reached = found or self.bracket.beyond
        return Verdict.ACCEPT if self.reached else Verdict.STOP

    def note_fallen(self, words: str) -> None:
        """Note with the accepted increment the parts that only slack parts held before, in words; none if empty."""
        if words and self.reached:
            *others, last = self.reached.increments
            last = last._replace(outcome=Outcome.FALLEN, fallen=words)
            self.reached = replace(self.reached, increments=(*others, last))

    def note_chambers(self, chambers: Mapping[str, ChamberResult]) -> None:
        """Note with the accepted increment the gas in the chambers."""
        assert self.reached
        *others, last = self.reached.increments
        self.reached = replace(self.reached, increments=(*others, last._replace(chambers=chambers)))

    def note_water(self, basins: tuple[BasinResult, ...], events: tuple[WaterEvent, ...]) -> None:
        """Note with the accepted increment the water in the basins, and its events."""
        assert self.reached
        *others, last = self.reached.increments
        self.reached = replace(self.reached, increments=(*others, last._replace(basins=basins, events=events)))

    def accept(self) -> Progress:
        """Continue from the accepted state; return it."""
        assert self.reached
        self.state, self.reached, self.bracket.beyond = self.reached, None, None
        self.ceiling.found(self.state.factor)
        return self.state

    def failed(self, solution: Solution) -> Increment:
        """Return the increment that failed; if the work ended before a critical load was found, it is unknown."""
        outcome = Outcome.WORK_LIMIT if solution.converged else solution.outcome
        return Increment(float(self.factor), solution.iterations, outcome, solution.extra_iterations)

    def _found(self, solution: Solution, shape: NDArray[np.float64], lost: bool) -> Progress:
        """State of an equilibrium, with the size of the increment after it."""
        full = Fraction(1, self.stage.increments)
        outcome = solution.outcome
        if lost and outcome is not Outcome.UNSTABLE:
            outcome = Outcome.SNAPPED
        increment = Increment(float(self.factor), solution.iterations, outcome, solution.extra_iterations)
        size = full if lost else min(2 * self.state.size, full)
        return Progress(shape, self.factor, size, (*self.state.increments, increment))

    def _divisible(self, lost: bool) -> bool:
        """Return True if half of the increment may be tried."""
        loaded = bool(self.stage.loads or self.stage.displacements or self.stage.changes)
        large = self.state.size * self.stage.increments * 2**LIMITS.halvings > 1
        return loaded and large and (lost or not self.ceiling.reached(self.state.factor))
