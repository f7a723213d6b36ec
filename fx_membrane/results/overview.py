"""Table of all stages of a run, and the checks of each, to print at its end."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..geometry.measures import measures
from ..model.structure import Structure
from .checks import checks, table
from .states import StageResult, StageResults


def overview(results: StageResults) -> str:
    """Lines on each stage: its work, its largest displacement, extremes of each part, and its checks."""
    units = results.force_unit, results.length_unit
    return "\n".join(line for state in results.values() for line in _lines(state, *units))


def _lines(state: StageResult, force: str, length: str) -> Iterator[str]:
    iterations = sum(len(entry.iterations) - 1 + entry.extra_iterations for entry in state.increments)
    work = f"{counted(len(state.increments), 'increment')}, {counted(iterations, 'iteration')}"
    size = np.linalg.norm(state.displacement, axis=1)
    node = first_largest(size)
    yield f"Stage {state.name!r}: {work}"
    place = place_of(state.structure, state.structure.points[node])
    yield f"  largest displacement {size[node]:.4g} {length}, at node {node} at {place}"
    width = max(map(len, state.parts)) + 2
    for name, found in state.parts.items():
        per = "" if found.dimension == 1 else f"/{length}"
        yield f"  {name:{width}}{_extremes(state, name)} {force}{per}{_share(state, name)}"
    yield table(checks(state))


def _extremes(state: StageResult, name: str) -> str:
    """Least and largest force, or principal stress, of a part, each with its cell and place."""
    values = state.parts[name].principal
    ends: list[str] = []
    for cell in (first_largest(-values.min(axis=-1)), first_largest(values.max(axis=-1))) if values.size else ():
        number = values[cell].min() if not ends else values[cell].max()
        place = place_of(state.structure, state.structure.points[state.structure.parts[name].cells[cell]].mean(axis=0))
        ends.append(f"{number:.5g} (cell {cell} at {place})")
    return " to ".join(ends)


def place_of(structure: Structure, point: NDArray[np.float64]) -> str:
    """Show a place to a millionth of the size of the structure."""
    unit = 10.0 ** np.floor(np.log10(1e-6 * structure.size))
    return f"({', '.join(f'{np.round(value / unit) * unit + 0.0:.5g}' for value in point)})"


def _share(state: StageResult, name: str) -> str:
    found, part = state.parts[name], state.structure.parts[name]
    if part.carries_compression:
        return ""
    states = np.asarray(found.state) if found.dimension == 2 else np.where(found.slack, "slack", "taut")
    size = measures(state.structure.points, part.cells)
    shares = {word: size[states == word].sum() / size.sum() for word in ("wrinkled", "slack")}
    told = [f"{100 * share:.3g} % {word}" for word, share in shares.items() if share]
    return f"; {', '.join(told)}" if told else ""
