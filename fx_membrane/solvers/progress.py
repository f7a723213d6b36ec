"""Words on stderr about a run under way: a bar on a terminal, lines where there is none, as in a batch job."""

import contextlib
import os
import sys
from time import monotonic
from typing import Self

from tqdm import tqdm

from .base import Iteration

SILENCE = 10.0  # longest time without a line [s]


class Pulse:
    """A line on stderr at least every ten seconds, as far as its owner gets to call it.

    Args:
        name: Name of what runs.
        shown: Whether anything is written.
    """

    def __init__(self, name: str, shown: bool):
        self._name, self._shown = name, shown and sys.stderr is not None
        self._began = self._told = self._heard = monotonic()

    def __call__(self, words: str) -> None:
        """Hears of a sign of life, and writes it where the next may come too late."""
        now = monotonic()
        following = now + (now - self._heard)
        self._heard = now
        if following >= self._told + SILENCE:
            self.tell(words)

    def tell(self, words: str) -> None:
        """Writes a line."""
        self._told = monotonic()
        if self._shown:
            with contextlib.suppress(OSError, ValueError):  # a reader that is gone is no reason to end a run
                print(f"{self._name}: {words}, {self._told - self._began:.1f} s", file=sys.stderr, flush=True)


class Report:
    """Tells how far a stage is, on one process.

    On a terminal it is one line: name, load factor, iterations and residual. Elsewhere there is a line for each
    increment that is found, and one every ten seconds; a single iteration that takes longer cannot be interrupted.

    Args:
        name: Name of the stage.
        factor: Load factor at which it begins.
        shown: Whether anything is written.
    """

    def __init__(self, name: str, factor: float, shown: bool):
        terminal = shown and sys.stderr is not None and sys.stderr.isatty()
        self._pulse = Pulse(name, shown and not terminal)
        self._bar = tqdm(
            desc=name,
            total=1.0,
            initial=factor,
            bar_format="{desc}: {bar:10} load factor {n:.4f}{postfix}",  # 80 columns hold a name of 16 letters
            ncols=_columns(),
            nrows=20,  # any: one bar is shown at a time
            disable=not terminal,
            file=sys.stderr,
        )
        self._factor, self._iterations = factor, 0
        self._last: Iteration | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def iteration(self, number: int, entry: Iteration) -> None:
        """Hears of an iterate; of the same again where one takes long."""
        self._iterations += entry is not self._last
        self._last = entry
        words = f"iteration {number}, residual {entry.residual:.1e}"
        self._bar.set_postfix_str(words)
        self._pulse(f"after load factor {self._factor:.6g}, {words}")

    def increment(self, factor: float, residual: float) -> None:
        """Hears of an increment that was found, and its largest unbalanced force [N]."""
        self._bar.update(factor - self._factor)
        self._factor = factor
        self._pulse.tell(f"load factor {factor:.6g} after {self._iterations} iterations, residual {residual:.1e}")


def _columns() -> int | None:
    """Width of the terminal; 80 where it does not tell, as some that are not on a screen."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (AttributeError, OSError, ValueError):  # no terminal, no bar
        return None
