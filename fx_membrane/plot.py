"""Pictures: curves and wire frames (matplotlib), contours on the deformed structure (pyvista inside matplotlib).

Each function writes one picture, a PNG or what else its name ends in, and makes its folder. Under MPI call it on all
processes; the first one draws what it was given, and the others wait until it has, and raise what it raises.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import validation
from .parts import Part
from .processes import by_the_first
from .results import StageResult
from .scene import INK, Colours, picture, screen_axes
from .solver import Iteration

LINES = "#1f6f8b"
BANDS = 16
STATES = {"taut": "#8fc1b5", "wrinkled": "#f2b950", "slack": "#d1495b"}
PAPER = {"dpi": 160, "bbox_inches": "tight"}

Field = Mapping[str, ArrayLike] | ArrayLike


@by_the_first
def convergence(result: StageResult, path: str | Path, force_unit: str = "N", energy_unit: str = "J") -> None:
    """Total potential energy and largest unbalanced force against the iteration, as in Gil's Fig. 7.

    Args:
        result: A stage; all its increments are drawn one after the other.
        path: The picture to write.
        force_unit: Name of the unit of the forces as they are; no number is converted.
        energy_unit: The same for energies.

    Raises:
        ValueError: The result is not that of a stage; path ends in no format of pictures.
    """
    validation.instance("The first argument of convergence", result, StageResult)
    _check_path(path)
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
    _save(figure, path)


@by_the_first
def compare_convergence(
    histories: Mapping[str, Sequence[Iteration]],
    seconds: Mapping[str, float],
    path: str | Path,
    force_unit: str = "N",
    energy_unit: str = "J",
) -> None:
    """Energy above that at the end and largest unbalanced force of several solves, against iterations and time.

    The scale of the energies is logarithmic, and has no place for those at or below that at the end: the last ones, and
    starts in which prescribed displacements are still to come, or pressure, whose work is not in the energy. Where a
    curve of `Newton` begins at iteration 1, that is why; a first-order method brings what is prescribed to its place
    before its first iterate. Against time the starts are left out: its scale is logarithmic too.

    Args:
        histories: The iterates by name of the solver; all solves have the same solution.
        seconds: How long each solve took [s]; its iterates are drawn evenly over it.
        path: The picture to write.
        force_unit: Name of the unit of the forces as they are; no number is converted.
        energy_unit: The same for energies.

    Raises:
        ValueError: There are no histories, one has no iterate, or they are not those that have a time; path ends in no
            format of pictures.
    """
    validation.instance("histories", histories, Mapping)
    if not histories or not all(histories.values()):
        raise ValueError("histories is empty, or has one without iterates; give {name: iterates}.")
    if set(seconds) != set(histories):
        raise ValueError(f"seconds is for {list(seconds)}; give the time of each of {list(histories)}.")
    _check_path(path)
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
    _save(figure, path)


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
    """Edges of nets, membranes, cables and masts, with a legend and node numbers, as in Gil's Figs. 12 to 14.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        parts: Parts by name, as those of a structure, or their cells, shape (cells, 2) or (cells, 3).
        path: The picture to write.
        view: Direction from the structure to the eye; without it the plan (x, y).
        labels: Nodes whose number is written.
        first: The number written at node 0.

    Raises:
        ValueError: A cell or a label is of a node that does not exist; view is not a direction; path ends in no format
            of pictures.
    """
    positions = validation.positions("points", points)
    validation.instance("parts", parts, Mapping)
    lines = {name: np.asarray(getattr(part, "cells", part)) for name, part in parts.items()}
    for name, cells in lines.items():
        validation.in_range(f"Part {name!r}", cells, len(positions), "node")
    validation.in_range("labels", np.asarray(labels, dtype=np.int64), len(positions), "node")
    seen = positions @ screen_axes((0, 0, 1) if view is None else validation.direction("view", view)).T
    _check_path(path)
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
    for node in labels:
        axes.annotate(str(node + first), seen[node], fontsize=6, color=INK, xytext=(1, 1), textcoords="offset points")
    axes.autoscale()
    axes.set_aspect("equal")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=3, frameon=False)  # above: nodes may be anywhere
    if view is None:
        axes.set_xlabel("x")
        axes.set_ylabel("y")
    else:
        axes.axis("off")
    _save(figure, path)


@by_the_first
def contours(
    result: StageResult,
    fields: Mapping[str, Field],
    path: str | Path,
    *,
    scale: float = 1.0,
    view: Sequence[float] = (1.0, -1.6, 1.1),
    mirror: str | None = None,
    odd: Sequence[str] = (),
    limits: Mapping[str, Sequence[float]] | None = None,
) -> None:
    """Fields on the deformed structure, one picture beside the other; cables and masts are drawn as tubes.

    Args:
        result: A stage.
        fields: For each title, either nodal values, shape (n,), or cell values (cells,) of some parts by name, as the
            forces of cables; cell values may be the states "taut", "wrinkled" and "slack".
        path: The picture to write.
        scale: Displacements are drawn that many times larger.
        view: Direction from the structure to the eye; z points up, from straight above, (0, 0, 1), y.
        mirror: "x", "y" or "z" draws the mirror image about that coordinate's zero too, for half models.
        odd: Titles of the fields that have the other sign in the mirror image, as the displacement across it.
        limits: For the titles of some fields the least and the largest value of the colours, {"title": (low, high)};
            values beyond have the colour of that end, and the numbers at the ends are written with <= and >=. Without
            them the colours go from the least value to the largest, and one peak can leave the rest in one colour.

    Raises:
        ValueError: A field has a wrong number of values, values that are not finite, or names no part; mirror is none
            of the three; odd or limits name no field; limits are not two numbers, the lower first, or are given for
            states; view is not a direction; scale is not a number; path ends in no format of pictures.
        RuntimeError: There is no screen, and this version of VTK needs one.
    """
    validation.instance("The first argument of contours", result, StageResult)
    validation.instance("fields", fields, Mapping)
    if not fields:
        raise ValueError('fields is empty; give at least one, {"title": values}.')
    checked = {title: _checked(result, title, field) for title, field in fields.items()}
    if mirror not in (None, "x", "y", "z"):
        raise ValueError(f'mirror is {mirror!r}; give "x", "y", "z" or None.')
    for what, titles in (("odd", odd), ("limits", limits or {})):
        unknown = [title for title in titles if title not in checked]
        if unknown:
            raise ValueError(f"{what} names {unknown[0]!r}; the fields are {list(checked)}.")
    ranges = {title: _limits(title, checked[title], given) for title, given in (limits or {}).items()}
    validation.number("scale", scale)
    validation.direction("view", view)
    _check_path(path)
    figure = _figure(6.4 * len(checked), 5.6)
    panels = figure.subplots(1, len(checked), squeeze=False)[0]
    for axes, (title, field) in zip(panels, checked.items(), strict=True):
        colours, numbers = _colours(field, symmetric=title in odd, limits=ranges.get(title))
        axes.imshow(picture(result, numbers, colours, scale=scale, view=view, mirror=mirror, odd=title in odd))
        axes.axis("off")
        axes.set_title(title, color=INK, fontsize=15)
        _colour_bar(figure, axes, colours, limited=title in ranges)
    _save(figure, path)


def _checked(result: StageResult, title: str, field: Field) -> dict[str, NDArray[Any]] | NDArray[Any]:
    if not isinstance(field, Mapping):
        values = np.asarray(field)
        if values.shape != (len(result.structure.points),):
            raise ValueError(f"Field {title!r} has shape {values.shape}; give one value for each node.")
        if values.dtype.kind == "U":
            raise ValueError(f"Field {title!r} has states at nodes; states belong to cells, {{part: states}}.")
        return _finite(title, values)
    cells = {name: len(part.cells) for name, part in result.structure.parts.items()}
    if not field or not set(field) <= set(cells):
        raise ValueError(f"Field {title!r} is for the parts {list(field)}; give cell values for some of {list(cells)}.")
    checked = {name: _finite(title, np.asarray(values)) for name, values in field.items()}
    for name, values in checked.items():
        if values.shape != (cells[name],):
            raise ValueError(f"Field {title!r} on {name!r} has shape {values.shape}; give one value for each cell.")
    return checked


def _finite(title: str, values: NDArray[Any]) -> NDArray[Any]:
    if values.dtype.kind == "U":
        unknown = sorted(set(values.tolist()) - set(STATES))
        if unknown:
            raise ValueError(f"Field {title!r} has the state {unknown[0]!r}; the states are {list(STATES)}.")
    elif not np.isfinite(values).all():
        raise ValueError(f"Field {title!r} has values that are not finite.")
    return values


def _limits(title: str, field: dict[str, NDArray[Any]] | NDArray[Any], given: Sequence[float]) -> tuple[float, float]:
    if _values(field).dtype.kind == "U":
        raise ValueError(f"limits are given for {title!r}, which shows states; leave them out there.")
    pair = validation.finite(f"limits of {title!r}", given)
    if pair.shape != (2,) or not pair[0] < pair[1]:
        raise ValueError(f"limits of {title!r} is {validation.shown(given)}; give (low, high), the lower one first.")
    return float(pair[0]), float(pair[1])


def _values(field: dict[str, NDArray[Any]] | NDArray[Any]) -> NDArray[Any]:
    return np.concatenate(list(field.values())) if isinstance(field, dict) else field


def _colours(
    field: dict[str, NDArray[Any]] | NDArray[Any], symmetric: bool, limits: tuple[float, float] | None
) -> tuple[Colours, dict[str, NDArray[np.float64]] | NDArray[np.float64]]:
    """Colours of a field, and its values as numbers; two-sided and symmetric where both signs matter."""
    values = _values(field)
    if values.dtype.kind == "U":
        assert isinstance(field, dict)
        order = list(STATES)
        numbers = {name: np.array([order.index(state) for state in states]) for name, states in field.items()}
        return Colours(list(STATES.values()), -0.5, 2.5, len(order)), numbers
    if limits is not None:
        return Colours("coolwarm" if limits[0] == -limits[1] else "viridis", *limits, BANDS), field
    low, high = float(values.min()), float(values.max())
    largest = max(-low, high)
    if symmetric or min(-low, high) > 0.02 * largest:
        return Colours("coolwarm", -largest, largest, BANDS), field
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size:  # uniform: the last digits are no pattern to look at
        low, high = low - 0.05 * (size or 1.0), high + 0.05 * (size or 1.0)
    return Colours("viridis", low, high, BANDS), field


def _colour_bar(figure: Any, axes: Any, colours: Colours, limited: bool) -> None:
    import matplotlib.cm  # noqa: PLC0415
    import matplotlib.colors  # noqa: PLC0415

    named = not isinstance(colours.map, str)
    ticks = np.arange(len(STATES)) if named else np.linspace(colours.low, colours.high, 5)
    bounds = np.linspace(colours.low, colours.high, colours.bands + 1)
    shades: Any = matplotlib.colors.ListedColormap(list(colours.map)) if named else colours.map
    norm = matplotlib.colors.BoundaryNorm(bounds, colours.bands if named else 256)
    mappable = matplotlib.cm.ScalarMappable(norm, shades)
    bar = figure.colorbar(mappable, ax=axes, location="bottom", fraction=0.05, pad=0.02, shrink=0.8, ticks=ticks)
    labels = list(STATES) if named else [f"{tick:.3g}" for tick in ticks]
    if limited:
        labels = [f"≤ {labels[0]}", *labels[1:-1], f"≥ {labels[-1]}"]
    bar.ax.set_xticklabels(labels, color=INK)
    bar.ax.tick_params(which="both", length=0)
    bar.outline.set_visible(False)


def _figure(width: float, height: float) -> Any:
    import matplotlib.figure  # noqa: PLC0415  (numbers alone should not wait for it)

    return matplotlib.figure.Figure(figsize=(width, height), layout="constrained")


def _check_path(path: str | Path) -> None:
    """Refuses a name before anything is drawn, on all processes."""
    import matplotlib.backend_bases  # noqa: PLC0415

    validation.instance("path", path, str | Path)
    formats = sorted(matplotlib.backend_bases.FigureCanvasBase.get_supported_filetypes())
    ending = Path(path).suffix[1:]
    if ending and ending.lower() not in formats:
        raise ValueError(f"path is {str(path)!r}, which ends in no format of pictures; give .png, or one of {formats}.")


def _save(figure: Any, path: str | Path) -> None:
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, **PAPER)
