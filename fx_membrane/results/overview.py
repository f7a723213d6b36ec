"""Table of all stages of a run, and the checks of each, to print at its end."""

from collections.abc import Iterator

import numpy as np

from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..geometry.measures import measures
from .check import Check, Verdict
from .checks import checks, table
from .limits import Limits, limit_checks
from .places import cell_place, node_place
from .report import report
from .states import StageResult, StageResults
from .unfinished import unfinished


def overview(results: StageResults) -> str:
    """Lines on each stage: its work, its largest displacement, extremes of each part, its checks; stages that lack."""
    units = results.force_unit, results.length_unit
    limits = results.limits or Limits()
    lines = [line for state in results.values() for line in _lines(state, limits, *units)]
    lacking = [check._replace(remedy="") for check in unfinished(results)]  # the error tells the remedy
    return "\n".join([*lines, *_lacking(lacking)])


def states_and_checks(results: StageResults) -> str:
    """Lines on each stage: its report and its checks; stages that lack, with the remedy."""
    limits, force, length = results.limits or Limits(), results.force_unit, results.length_unit
    lines = [
        report(state, force_unit=force, length_unit=length) + "\n" + table(checks(state, limits))
        for state in results.values()
    ]
    return "\n".join([*lines, *_lacking(unfinished(results))])


def exceeded(results: StageResults) -> list[str]:
    """Limits of the design that states exceed, in words."""
    limits = results.limits or Limits()
    return [
        f"{check.name} in stage {state.name!r}, {check.found} of {check.limit}"
        for state in results.values()
        for check in limit_checks(state, limits)
        if check.verdict is Verdict.FAIL
    ]


def _lacking(found: list[Check]) -> list[str]:
    return ["The run is incomplete:", table(found)] if found else []


def _lines(state: StageResult, limits: Limits, force: str, length: str) -> Iterator[str]:
    iterations = sum(entry.total_iterations for entry in state.increments)
    work = f"{counted(len(state.increments), 'increment')}, {counted(iterations, 'iteration')}"
    size = np.linalg.norm(state.displacement, axis=1)
    node = first_largest(size)
    yield f"Stage {state.name!r}: {work}"
    yield f"  largest displacement {size[node]:.4g} {length}, {node_place(state.structure, node)}"
    width = max(map(len, state.parts)) + 2
    for name, found in state.parts.items():
        per = "" if found.dimension == 1 else f"/{length}"
        yield f"  {name:{width}}{_extremes(state, name)} {force}{per}{_share(state, name)}"
    yield table(checks(state, limits))


def _extremes(state: StageResult, name: str) -> str:
    """Least and largest force, or principal stress, of a part, each with its cell and place."""
    values = state.parts[name].principal
    least, largest = values.min(axis=-1), values.max(axis=-1)
    ends = [(least, first_largest(-least)), (largest, first_largest(largest))]
    return " to ".join(f"{numbers[cell]:.5g} ({cell_place(state.structure, name, cell)})" for numbers, cell in ends)


def _share(state: StageResult, name: str) -> str:
    found, part = state.parts[name], state.structure.parts[name]
    if part.carries_compression:
        return ""
    states = np.asarray(found.state) if found.dimension == 2 else np.where(found.slack, "slack", "taut")
    size = measures(state.structure.points, part.cells)
    shares = {word: size[states == word].sum() / size.sum() for word in ("wrinkled", "slack")}
    told = [f"{100 * share:.3g} % {word}" for word, share in shares.items() if share]
    return f"; {', '.join(told)}" if told else ""
