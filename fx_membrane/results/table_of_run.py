"""Table of all stages of a run, and the checks of each, to print at its end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..geometry.sizes import measures
from .chamber_tables import chamber_lines
from .check import Check, Verdict
from .limits import Limits, limit_checks
from .places import cell_place, node_place
from .plain_numbers import plain
from .reader_words import for_readers
from .screen_lines import fitted
from .state_checks import checks, table
from .states import StageResult, StageResults
from .table_of_stage import report
from .unfinished_stages import unfinished

NAMES = 20  # columns of names of parts; longer ones have a line of their own


def overview(results: StageResults) -> str:
    """Lines on each stage: its work, its largest displacement, extremes of each part, its checks; stages that lack.

    None is longer than a screen is wide, but for names.
    """
    units = results.force_unit, results.length_unit
    limits = results.limits or Limits()
    lines = [line for state in results.states.values() for line in _lines(state, limits, *units)]
    lacking = [check._replace(remedy="") for check in unfinished(results)]  # the error tells the remedy
    return "\n".join([*lines, *_lacking(lacking)])


def states_and_checks(results: StageResults) -> str:
    """Lines on each stage: its report and its checks; stages that lack, with the remedy."""
    limits, force, length = results.limits or Limits(), results.force_unit, results.length_unit
    lines = [
        fitted(for_readers(report(state, force_unit=force, length_unit=length)))
        + "\n"
        + table(checks(state, limits, length))
        for state in results.states.values()
    ]
    return "\n".join([*lines, *_lacking(unfinished(results))])


def exceeded(results: StageResults) -> list[str]:
    """Limits of the design that states exceed, in words."""
    limits = results.limits or Limits()
    return [
        f"{check.name} in stage {state.name!r}, {check.found.split(' ')[0]} of {check.limit}"
        for state in results.values()
        for check in limit_checks(state, limits, results.length_unit)
        if check.verdict is Verdict.FAIL
    ]


def _lacking(found: list[Check]) -> list[str]:
    return ["The run is incomplete:", table(found)] if found else []


def _lines(state: StageResult, limits: Limits, force: str, length: str) -> Iterator[str]:
    iterations = sum(entry.total_iterations for entry in state.increments)
    work = f"{counted(len(state.increments), 'increment')}, {counted(iterations, 'iteration')}"
    size = np.linalg.norm(state.displacement, axis=1)
    node = first_largest(size)
    yield fitted(f"Stage {state.name!r}: {work}")
    yield fitted(f"  largest displacement {plain(size[node], 4)} {length}, {node_place(state.structure, node)}")
    width = min(max(map(len, state.parts)), NAMES) + 2
    for name in state.parts:
        unit = state.structure.parts[name].stress_unit(force, length)
        first, *more = [*_extremes(state, name, unit), *_share(state, name)]
        beside = len(name) + 2 <= width
        yield f"  {name:{width}}{first}" if beside else f"{fitted(f'  {name}')}\n  {'':{width}}{first}"
        yield from (f"  {'':{width}}{line}" for line in more)
    yield from map(fitted, chamber_lines(state, force, length))
    yield table(checks(state, limits, length))


def _extremes(state: StageResult, name: str, unit: str) -> Iterator[str]:
    """Lines on the least and largest force, or principal stress, of a part, each with its cell and place."""
    values = state.parts[name].principal
    least, largest = values.min(axis=-1), values.max(axis=-1)
    for word, numbers, sign in (("least", least, -1), ("largest", largest, 1)):
        cell = first_largest(sign * numbers)
        yield f"{word:>7} {plain(numbers[cell])} {unit}, {cell_place(state.structure, name, cell)}"


def _share(state: StageResult, name: str) -> list[str]:
    found, part = state.parts[name], state.structure.parts[name]
    if part.carries_compression:
        return []
    states = found.state
    size = measures(state.structure.points, part.cells)
    shares = {word: size[states == word].sum() / size.sum() for word in ("wrinkled", "slack")}
    told = [f"{100 * share:.3g} % {word}" for word, share in shares.items() if share]
    return [f"        {', '.join(told)}"] if told else []
