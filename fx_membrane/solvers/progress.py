"""Progress messages on stderr: a bar on a terminal, lines elsewhere, as in a batch job."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
import threading
from collections.abc import Callable, Iterator
from importlib.util import find_spec
from time import monotonic
from typing import Any, Self

from tqdm import tqdm

from ..checks.values import counted
from ..runtime.messages import silent
from ..runtime.printable_text import printable
from .base import Iteration

WIDE_TERMINAL = 110  # columns of a terminal that holds more
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


@contextlib.contextmanager
def beating(pulse: Pulse, words: str) -> Iterator[Callable[[str], None]]:
    """Write a line every ten seconds during a call that cannot be divided.

    Args:
        pulse: Where the lines go.
        words: Words of the lines.

    Yields:
        Function that changes the words.
    """
    now, ended = [words], threading.Event()

    def beat() -> None:
        while not ended.wait(0.9 * SILENCE):
            pulse.tell(now[0])

    thread = threading.Thread(target=beat, daemon=True)
    thread.start()
    try:
        yield lambda other: now.__setitem__(0, other)
    finally:
        ended.set()
        thread.join()


class Report:
    """Progress of a stage, on one process.

    On a terminal it is one line: name, load factor, iterations and residual; on a wide one also the numbers of stage
    and increment, the time passed, and an estimate of the rest. A notebook shows a bar of its own, where ipywidgets are
    there. Elsewhere it writes a line for each increment found, and one every ten seconds; a single longer iteration
    cannot be interrupted.

    Args:
        name: Name of the stage.
        factor: Load factor at its start.
        shown: False writes nothing.
        number: Number of the stage in the run, from 1.
        count: Number of stages of the run.
    """

    def __init__(self, name: str, factor: float, shown: bool, number: int = 1, count: int = 1):
        shown, name = shown and not silent(), printable(name).replace("\n", "\\n")
        terminal = shown and sys.stderr is not None and sys.stderr.isatty()
        widgets = shown and _notebook_bar()
        columns = _columns()
        self._wide = bool(widgets) or (columns or 0) >= WIDE_TERMINAL
        self._pulse = Pulse(name, shown and not terminal and not widgets)
        self._bar = (widgets or tqdm)(
            desc=name,
            total=1.0,
            initial=factor,
            bar_format="{desc}: "
            + ("{bar}" if widgets else "{bar:10}")
            + " load factor {n:.4f}{postfix}"  # 80 columns hold a name of 16 letters
            + f", stage {number} of {count}, {{elapsed}}<{{remaining}}" * self._wide,
            ncols=None if widgets else columns,
            nrows=20,  # any value: one bar is shown at a time
            disable=not (terminal or widgets),
            file=sys.stderr,
        )
        self._factor, self._iterations, self._increment = factor, 0, 1
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
        self._bar.set_postfix_str(f"increment {self._increment}, {words}" if self._wide else words)
        self._pulse(f"after load factor {self._factor:.6g}, {words}")

    def increment(self, factor: float, residual: float, iterations: int) -> None:
        """Report a converged increment.

        Args:
            factor: Load factor at its end.
            residual: Its largest unbalanced force [N].
            iterations: Number of iterations of this and the earlier increments, as their results tell it.
        """
        self._bar.update(factor - self._factor)
        self._factor = factor
        self._increment += 1
        lost = self._iterations - iterations
        given_up = f" and {lost} in larger increments without success" if lost > 0 else ""
        self._pulse.tell(
            f"load factor {factor:.6g} after {counted(iterations, 'iteration')}{given_up}, residual {residual:.1e}"
        )


def _notebook_bar() -> Any:
    """Bar of notebooks; None elsewhere, and without ipywidgets."""
    if "ipykernel" not in sys.modules or not find_spec("ipywidgets"):
        return None
    return importlib.import_module("tqdm.notebook").tqdm


def _columns() -> int | None:
    """Width of the terminal; 80 if it is unknown, as on some without a screen."""
    try:
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    except (AttributeError, OSError, ValueError):  # no terminal, no bar
        return None
