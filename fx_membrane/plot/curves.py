"""Curves of convergence: energy and unbalanced force against iterations and time (matplotlib)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..checks import validation
from ..results.states import StageResult
from ..runtime.processes import by_the_first
from ..solvers.base import Iteration
from .figures import checked_path, empty, plain, save
from .scene import INK

LINES = "#1f6f8b"


@by_the_first
def convergence(result: StageResult, path: str | Path, force_unit: str = "N", energy_unit: str = "J") -> None:
    """Plot total potential energy and largest unbalanced force against the iteration, as in Gil's Fig. 7.

    Args:
        result: A stage; all its increments are drawn one after the other.
        path: Path of the picture.
        force_unit: Name of the force unit; no number is converted.
        energy_unit: Name of the energy unit.

    Raises:
        ValueError: The result is not that of a stage; path ends in no picture format.
    """
    validation.instance("The first argument of convergence", result, StageResult)
    file = checked_path(path)
    validation.text("force_unit", force_unit)
    validation.text("energy_unit", energy_unit)
    iterations = [entry for _, entry in result.history]
    count = np.arange(len(iterations))
    figure = empty(9, 3.6)
    energy, residual = figure.subplots(1, 2)
    energy.plot(count, [entry.energy for entry in iterations], "o-", color=LINES)
    energy.set_ylabel(f"Total potential energy [{energy_unit}]")
    residual.semilogy(count, [max(entry.residual, 1e-300) for entry in iterations], "o-", color=LINES)
    residual.set_ylabel(f"Largest unbalanced force [{force_unit}]")
    for axes in (energy, residual):
        axes.set_xlabel("Iteration")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.grid(color="#e3e5e8", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"Convergence of stage “{plain(result.name)}”", color=INK, fontsize=12)
    save(figure, file)


@by_the_first
def compare_convergence(
    histories: Mapping[str, Sequence[Iteration]],
    seconds: Mapping[str, float],
    path: str | Path,
    force_unit: str = "N",
    energy_unit: str = "J",
) -> None:
    """Plot energy above the final one and largest unbalanced force of several solves, against iterations and time.

    The energy scale is logarithmic and omits energies at or below the final one. These are the last ones, and starts
    before prescribed displacements, or before pressure, whose work is not in the energy. So a curve of `Newton` may
    begin at iteration 1; a first-order method imposes displacements before its first iterate. The time scale is
    logarithmic, too, and omits the starts.

    Args:
        histories: The iterates by name of the solver; all solves have the same solution.
        seconds: Duration of each solve [s]; its iterates are spread evenly over it.
        path: Path of the picture.
        force_unit: Name of the force unit; no number is converted.
        energy_unit: Name of the energy unit.

    Raises:
        ValueError: There are no histories, one has no iterate, or their names differ from those of the times; path ends
            in no picture format.
    """
    seconds = _checked_times(histories, seconds)
    file = checked_path(path)
    validation.text("force_unit", force_unit)
    validation.text("energy_unit", energy_unit)
    lowest = min(history[-1].energy for history in histories.values())
    figure = empty(10, 7.5)
    panels = figure.subplots(2, 2, sharex="col", sharey="row")
    for number, (name, history) in enumerate(histories.items()):
        count = np.arange(len(history))
        error = np.array([entry.energy for entry in history]) - lowest
        error[error <= 1e-15 * abs(lowest)] = np.nan  # rounding, or a start before the supports move
        residual = np.array([max(entry.residual, 1e-300) for entry in history])
        style = {
            "color": f"C{number}",
            "marker": "o" if len(history) < 50 else "",
            "markersize": 3,
            "label": plain(name),
        }
        for axes, values in zip(panels, (error, residual), strict=True):
            axes[0].plot(count, values, **style)
            axes[1].plot(count[1:] * seconds[name] / max(len(history) - 1, 1), values[1:], **style)
    for axes in panels.flat:
        axes.set_yscale("log")
        axes.grid(color="#e3e5e8", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0, 0].set_ylabel(f"Energy above the least at the end [{energy_unit}]")
    panels[1, 0].set_ylabel(f"Largest unbalanced force [{force_unit}]")
    panels[1, 0].set_xscale("symlog", linthresh=1)
    panels[1, 0].set_xlim(left=0)
    panels[1, 0].set_xlabel("Iteration")
    panels[1, 1].set_xscale("log")
    panels[1, 1].set_xlabel("Time [s]")
    handles, names = panels[0, 0].get_legend_handles_labels()
    figure.legend(handles, names, loc="lower left", bbox_to_anchor=(0.05, 1), ncols=4, frameon=False)
    save(figure, file)


def _checked_times(histories: Mapping[str, Sequence[Iteration]], seconds: Mapping[str, float]) -> dict[str, float]:
    """Check the times of some solves [s], each with iterates."""
    validation.instance("histories", histories, Mapping)
    validation.instance("seconds", seconds, Mapping)
    for name, history in histories.items():
        validation.name("history", name)
        validation.instance(f"The history of {name!r}", history, Sequence)
    if not histories or not all(map(len, histories.values())):
        raise ValueError("histories is empty, or has one without iterates; give {name: iterates}.")
    if set(seconds) != set(histories):
        raise ValueError(f"seconds is for {list(seconds)}; give the time of each of {list(histories)}.")
    for name, history in histories.items():
        validation.instances(f"The history of {name!r}", history, Iteration)
    return {name: validation.not_negative(f"seconds of {name!r}", value) for name, value in seconds.items()}
