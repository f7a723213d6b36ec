"""Pictures: curves and wire frames (matplotlib), contours on the deformed structure (pyvista inside matplotlib).

Each function writes one picture, a PNG or another format by its ending, and makes its folder. An unwritable path is
refused before anything is drawn. Under MPI call it on all processes. The first one draws its own arguments; the others
wait for it, and raise its exceptions.
"""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import paths, validation
from ..checks.entries import entries
from ..model.parts import Part
from ..results.states import StageResult
from ..runtime.processes import by_the_first
from ..solvers.base import Iteration
from .colours import colour_bar, colours
from .fields import Field, checked, checked_range, checked_scale
from .scene import INK, picture, screen_axes
from .screen import obstacle

LINES = "#1f6f8b"
PAPER = {"dpi": 160, "bbox_inches": "tight"}


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
    file = _checked_path(path)
    validation.text("force_unit", force_unit)
    validation.text("energy_unit", energy_unit)
    paths.check_writable("path", file)
    iterations = [entry for _, entry in result.history]
    count = np.arange(len(iterations))
    figure = _figure(9, 3.6)
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
    figure.suptitle(f"Convergence of stage “{result.name}”", color=INK, fontsize=12)
    _save(figure, file)


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
    file = _checked_path(path)
    validation.text("force_unit", force_unit)
    validation.text("energy_unit", energy_unit)
    paths.check_writable("path", file)
    lowest = min(history[-1].energy for history in histories.values())
    figure = _figure(10, 7.5)
    panels = figure.subplots(2, 2, sharex="col", sharey="row")
    for number, (name, history) in enumerate(histories.items()):
        count = np.arange(len(history))
        error = np.array([entry.energy for entry in history]) - lowest
        error[error <= 1e-15 * abs(lowest)] = np.nan  # rounding, or a start before the supports move
        residual = np.array([max(entry.residual, 1e-300) for entry in history])
        style = {"color": f"C{number}", "marker": "o" if len(history) < 50 else "", "markersize": 3, "label": name}
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
    _save(figure, file)


@by_the_first
def wireframe(
    points: ArrayLike,
    parts: Mapping[str, Part | NDArray[np.int64]],
    path: str | Path,
    *,
    view: Sequence[float] | None = None,
    labels: Sequence[int] = (),
    first: int = 0,
) -> None:
    """Plot edges of nets, membranes, cables and masts, with a legend and node numbers, as in Gil's Figs. 12 to 14.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        parts: Parts by name, as those of a structure, or their cells, shape (cells, 2) or (cells, 3).
        path: Path of the picture.
        view: Direction from the structure to the eye; without it the plan (x, y).
        labels: Nodes to number.
        first: Printed number of node 0.

    Raises:
        ValueError: A cell or a label is of a node that does not exist; view is not a direction; path ends in no picture
            format.
    """
    positions = validation.positions("points", points)
    validation.instance("parts", parts, Mapping)
    lines = {validation.name("part", name): _cells(name, part, len(positions)) for name, part in parts.items()}
    if not lines:
        raise ValueError('parts is empty; give at least one, {"name": cells}.')
    marked = validation.indices("labels", labels, empty=True)
    validation.in_range("labels", marked, len(positions), "node")
    first = validation.integer("first", first)
    seen = positions @ screen_axes((0, 0, 1) if view is None else validation.direction("view", view)).T
    file = _checked_path(path)
    paths.check_writable("path", file)
    import matplotlib.collections  # noqa: PLC0415

    figure = _figure(7, 7)
    axes = figure.subplots()
    for number, (name, cells) in enumerate(lines.items()):
        edges = np.concatenate([cells[:, [i, (i + 1) % cells.shape[1]]] for i in range(cells.shape[1])])
        thin = number == 0
        drawn = matplotlib.collections.LineCollection(
            seen[np.unique(np.sort(edges, axis=1), axis=0)],
            colors="#9fb3bd" if thin else f"C{number}",
            linewidths=0.7 if thin else 2.0,
            label=name,
        )
        axes.add_collection(drawn)
    for node in marked:
        axes.annotate(str(node + first), seen[node], fontsize=6, color=INK, xytext=(1, 1), textcoords="offset points")
    axes.autoscale()
    axes.set_aspect("equal")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False)  # above: nodes may be anywhere
    if view is None:
        axes.set_xlabel("x")
        axes.set_ylabel("y")
    else:
        axes.axis("off")
    _save(figure, file)


@by_the_first
def contours(
    result: StageResult,
    fields: Mapping[str, Field],
    path: str | Path,
    *,
    scale: float = 1.0,
    view: Sequence[float] = (1.0, -1.6, 1.1),
    mirror: str | None = None,
    antisymmetric: Sequence[str] = (),
    ranges: Mapping[str, Sequence[float]] | None = None,
) -> None:
    """Plot fields on the deformed structure, one picture beside the other; cables and masts are drawn as tubes.

    Without pyvista, or if VTK cannot draw on a screen or in memory, a warning replaces the file.

    Args:
        result: A stage.
        fields: For each title, either nodal values, shape (n,), or cell values (cells,) of some parts by name, such as
            forces of cables; cell values may be the states "taut", "wrinkled" and "slack".
        path: Path of the picture.
        scale: Factor of the displacements.
        view: Direction from the structure to the eye; z points up, from straight above, (0, 0, 1), y.
        mirror: "x", "y" or "z" adds the mirror image about that coordinate's zero, for half models.
        antisymmetric: Titles of the fields whose sign changes in the mirror image, such as the displacement across it.
        ranges: Minimum and maximum of the colours for the titles of some fields, {"title": (low, high)}; values beyond
            have the colour of that end, and the numbers at the ends are written with <= and >=. By default the colours
            go from the minimum to the maximum, and one peak can leave the rest in one colour.

    Raises:
        ValueError: A field has a wrong number of values, values that are not finite, or names no part; mirror is none
            of the three; antisymmetric or ranges name no field; a range is not two numbers, the lower first, or is
            given for states; view is not a direction; scale is not a number, or draws displacements 1e4 times as large
            as the structure; path ends in no picture format, or cannot be written.
    """
    validation.instance("The first argument of contours", result, StageResult)
    validation.instance("fields", fields, Mapping)
    if not fields:
        raise ValueError('fields is empty; give at least one, {"title": values}.')
    drawn = {title: checked(result, title, field) for title, field in fields.items()}
    validation.choice("mirror", mirror, (None, "x", "y", "z"), '"x", "y", "z" or None')
    validation.instance("ranges", ranges, Mapping | None)
    antisymmetric = validation.texts("antisymmetric", antisymmetric)
    for what, titles in (("antisymmetric", antisymmetric), ("ranges", ranges or {})):
        unknown = [title for title in titles if title not in drawn]
        if unknown:
            raise ValueError(f"{what} names {unknown[0]!r}; the fields are {list(drawn)}.")
    bounds = {title: checked_range(title, drawn[title], given) for title, given in (ranges or {}).items()}
    scale = checked_scale(result, scale)
    eye = validation.direction("view", view)
    file = _checked_path(path)
    paths.check_writable("path", file)
    if reason := obstacle():
        warnings.warn(f"{file} is not drawn: {reason}", stacklevel=3)
        return
    figure = _figure(6.4 * len(drawn), 5.6)
    panels = figure.subplots(1, len(drawn), squeeze=False)[0]
    for axes, (title, field) in zip(panels, drawn.items(), strict=True):
        shades, numbers = colours(field, symmetric=title in antisymmetric, limits=bounds.get(title))
        axes.imshow(
            picture(result, numbers, shades, scale=scale, view=eye, mirror=mirror, antisymmetric=title in antisymmetric)
        )
        axes.axis("off")
        axes.set_title(title, color=INK, fontsize=15)
        colour_bar(figure, axes, shades, limited=title in bounds)
    _save(figure, file)


def _cells(name: str, part: Part | NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Cells of a part, or cells given directly, shape (cells, 2) or (cells, 3)."""
    given: Any = getattr(part, "cells", part)
    nodes = 3 if entries(f"Part {name!r}", given, "an array of cells").shape[1:] == (3,) else 2
    cells = validation.cells(f"Part {name!r}", given, nodes, distinct=False)
    validation.in_range(f"Part {name!r}", cells, count, "node")
    return cells


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


def _figure(width: float, height: float) -> Any:
    import matplotlib.figure  # noqa: PLC0415  (numbers alone must not wait for it)

    return matplotlib.figure.Figure(figsize=(width, height), layout="constrained")


def _checked_path(path: str | Path) -> Path:
    """Check the path of a picture, before anything is drawn, on all processes."""
    import matplotlib.backend_bases  # noqa: PLC0415

    file = paths.path("path", path)
    formats = sorted(matplotlib.backend_bases.FigureCanvasBase.get_supported_filetypes())
    ending = file.suffix[1:]
    if ending and ending.lower() not in formats:
        raise ValueError(f"path is {str(path)!r}, which ends in no format of pictures; give .png, or one of {formats}.")
    return file


def _save(figure: Any, file: Path) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(file, **PAPER)
    except OSError as error:
        reason = error.strerror or error
        raise ValueError(f"path is {str(file)!r}, which cannot be written ({reason}); give another place.") from None
