"""Progress messages on stderr: a bar on a terminal, lines elsewhere, as in a batch job."""

import contextlib
import os
import sys
from time import monotonic
from typing import Self

from tqdm import tqdm

from ..checks.values import counted
from ..runtime.messages import silent
from .base import Iteration

SILENCE = 10.0  # longest time without a line [s]


class Pulse:
    """Line on stderr at least every ten seconds, as often as its owner calls it.

    Args:
        name: Name of the task.
        shown: False writes nothing.
    """

    def __init__(self, name: str, shown: bool):
        self._name, self._shown = name, shown and sys.stderr is not None and not silent()
        self._began = self._told = self._heard = monotonic()

    def __call__(self, words: str) -> None:
        """Note a sign of life; write it if the next may come too late."""
        now = monotonic()
        following = now + (now - self._heard)
        self._heard = now
        if following >= self._told + SILENCE:
            self.tell(words)

    def tell(self, words: str) -> None:
        """Write a line."""
        self._told = monotonic()
        if self._shown:
            with contextlib.suppress(OSError, ValueError):  # a closed reader must not end a run
                print(f"{self._name}: {words}, {self._told - self._began:.1f} s", file=sys.stderr, flush=True)


class Report:
    """Progress of a stage, on one process.

    On a terminal it is one line: name, load factor, iterations and residual. Elsewhere it writes a line for each
    increment found, and one every ten seconds; a single longer iteration cannot be interrupted.

    Args:
        name: Name of the stage.
        factor: Load factor at its start.
        shown: False writes nothing.
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
            nrows=20,  # any value: one bar is shown at a time
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
        """Report an iterate; called again with the same one if it takes long."""
        self._iterations += number > 0 and entry is not self._last  # the start of an attempt is no iteration
        self._last = entry
        words = f"iteration {number}, residual {entry.residual:.1e}"
        self._bar.set_postfix_str(words)
        self._pulse(f"after load factor {self._factor:.6g}, {words}")

    def increment(self, factor: float, residual: float) -> None:
        """Report a converged increment and its largest unbalanced force [N]."""
        self._bar.update(factor - self._factor)
        self._factor = factor
        self._pulse.tell(
            f"load factor {factor:.6g} after {counted(self._iterations, 'iteration')}, residual {residual:.1e}"
        )


def _columns() -> int | None:
    """Width of the terminal; 80 if it is unknown, as on some without a screen."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (AttributeError, OSError, ValueError):  # no terminal, no bar
        return None
