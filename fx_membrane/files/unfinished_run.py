"""States of a run that has not ended, kept in its folder: what a killed run has found can be read."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.stages import Stage
from ..results.remarks import remarked
from ..results.states import StageResult, StageResults
from ..results.unfinished_stages import Failure
from ..runtime.messages import say
from ..runtime.processes import by_the_first
from .archive import load_results, write_archive

FOLDER = "unfinished"  # in that of the results; an archive for each stage begun
SHARE = 20  # an increment is kept if the time since the last is this multiple of that for keeping it


class KeptStates:
    """Observer of a run that keeps the last state of each stage.

    Args:
        folder: Folder of the results.
        stages: The stages.
        heads: Results whose title, units and limits are kept, too.
    """

    def __init__(self, folder: Path, stages: Sequence[Stage], heads: StageResults):
        self._folder, self._stages, self._heads = folder / FOLDER, list(stages), heads
        self._ends: dict[str | None, NDArray[np.float64]] = {}
        self._next, self._failed = 0.0, False
        self._left: StageResult | None = None

    @by_the_first
    def __call__(self, state: StageResult) -> None:
        """Keep a state: the first and the last of a stage, and of others as many as cost little time."""
        first = state.name not in self._ends
        self._ends[state.name] = state.displacement
        self._left = state
        if first or _factor(state) == 1 or monotonic() >= self._next:
            self.keep_last()

    def keep_last(self) -> None:
        """Keep the last state that was left, on this process."""
        if self._left is None:
            return
        state, self._left, began = self._left, None, monotonic()
        number = next(row for row, stage in enumerate(self._stages) if stage.name == state.name)
        factor = _factor(state)
        after = self._stages[number].after
        found = remarked(state, self._ends[after] if after else np.zeros_like(state.displacement))
        if factor < 1:
            found = replace(found, name=f"{state.name}, up to load factor {factor:.6g}")
        results = StageResults({found.name: found}, self._stages)
        _copy_heads(self._heads, results)
        try:
            write_archive(results, self._folder / f"{number:04d}.fxm")
        except ValueError as error:
            if not self._failed:
                say(f"{error} The run goes on.")
            self._failed = True
        self._next = monotonic() + SHARE * (monotonic() - began)


@by_the_first
def drop(folder: Path) -> None:
    """Remove the states of an unfinished run."""
    shutil.rmtree(folder / FOLDER, ignore_errors=True)


def unfinished_results(folder: Path) -> StageResults | None:
    """Results of a run that has not ended; None without any.

    Raises:
        ValueError: A file of them is damaged.
    """
    found = [load_results(file) for file in sorted((folder / FOLDER).glob("*.fxm"))]
    if not found:
        return None
    states = {name: state for entry in found for name, state in entry.items()}
    results = StageResults(states, found[-1].stages)
    _copy_heads(found[-1], results)
    lacking = [stage.name for stage in results.stages if stage.name not in states]
    if lacking:
        last = next((_factor(state) for name, state in states.items() if name.startswith(f"{lacking[0]}, up to")), 0.0)
        reason = "The run was stopped, or still goes on: `fx-membrane run CASE --resume` continues it."
        results.failure = Failure(lacking[0], last, last, reason)
    return results


def _factor(state: Any) -> float:
    return float(state.increments[-1].load_factor) if state.increments else 0.0


def _copy_heads(source: StageResults, target: StageResults) -> None:
    target.title, target.limits = source.title, source.limits
    target.force_unit, target.length_unit = source.force_unit, source.length_unit
