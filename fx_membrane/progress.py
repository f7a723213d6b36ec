"""Words on stderr about a run under way: a bar on a terminal, lines where there is none, as in a batch job."""

import contextlib
import os
import sys
from time import monotonic
from typing import Self

from tqdm import tqdm

from .solver import Iteration

SILENCE = 10.0  # longest time without a line [s]


class Report:
    """Tells how far a run is, on one process.

    On a terminal it is one line: name, position, iterations and residual. Elsewhere there is a line for each increment
    that is found, and one every ten seconds; a single iteration that takes longer cannot be interrupted.

    Args:
        name: Name of the stage, or of what else runs.
        position: Where it begins.
        shown: Whether anything is written.
        label: Name of the position.
        end: The position at its end; None where nobody knows.
    """

    def __init__(self, name: str, position: float, shown: bool, label: str = "load factor", end: float | None = 1.0):
        self._name, self._label = name, label
        self._shown = shown and sys.stderr is not None
        self._lines = self._shown and not sys.stderr.isatty()
        bar, digits = ("", 0) if end is None else ("{bar:10} ", 4)  # 80 columns hold a name of 16 letters
        self._bar = tqdm(
            desc=name,
            total=end,
            initial=position,
            bar_format=f"{{desc}}: {bar}{label} {{n:.{digits}f}}{{postfix}}",
            ncols=_columns(),
            nrows=20,  # any: one bar is shown at a time
            disable=not self._shown or self._lines,
            file=sys.stderr,
        )
        self._position = position
        self._iterations = 0
        self._last: Iteration | None = None
        self._began = self._told = self._heard = monotonic()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.close()

    def iteration(self, number: int, entry: Iteration) -> None:
        """Hears of an iterate; of the same again where one takes long."""
        self._iterations += entry is not self._last
        self._last = entry
        self._bar.set_postfix_str(f"iteration {number}, residual {entry.residual:.1e}")
        now = monotonic()
        next_time = now + (now - self._heard)  # when the next may be heard of
        self._heard = now
        if next_time >= self._told + SILENCE:
            self._tell(f"after {self._label} {self._position:.6g}, iteration {number}, residual {entry.residual:.1e}")

    def increment(self, position: float, residual: float) -> None:
        """Hears of an increment that was found, and its largest unbalanced force [N]."""
        self._bar.update(position - self._position)
        self._position = position
        self._tell(f"{self._label} {position:.6g} after {self._iterations} iterations, residual {residual:.1e}")

    def _tell(self, words: str) -> None:
        self._told = monotonic()
        if self._lines:
            with contextlib.suppress(OSError, ValueError):  # a reader that is gone is no reason to end a run
                print(f"{self._name}: {words}, {self._told - self._began:.1f} s", file=sys.stderr, flush=True)


def _columns() -> int | None:
    """Width of the terminal; 80 where it does not tell, as some that are not on a screen."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (AttributeError, OSError, ValueError):  # no terminal, no bar
        return None
