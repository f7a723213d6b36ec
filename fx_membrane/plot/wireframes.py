"""Wire frames of nets and structures, with node numbers (matplotlib)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.array_entries import entries
from ..model.base_classes import AnyPart
from ..runtime.processes import by_the_first
from .figures import checked_path, empty, plain, save
from .scene import INK
from .windows import screen_axes


@by_the_first
def wireframe(
    points: ArrayLike,
    parts: Mapping[str, AnyPart | NDArray[np.int64]],
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
    file = checked_path(path)
    import matplotlib.collections  # noqa: PLC0415

    figure = empty(7, 7)
    axes = figure.subplots()
    for number, (name, cells) in enumerate(lines.items()):
        edges = np.concatenate([cells[:, [i, (i + 1) % cells.shape[1]]] for i in range(cells.shape[1])])
        thin = number == 0
        drawn = matplotlib.collections.LineCollection(
            seen[np.unique(np.sort(edges, axis=1), axis=0)],
            colors="#9fb3bd" if thin else f"C{number}",
            linewidths=0.7 if thin else 2.0,
            label=plain(name),
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
    save(figure, file)


def _cells(name: str, part: AnyPart | NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Cells of a part, or cells given directly, shape (cells, 2) or (cells, 3)."""
    given: Any = getattr(part, "cells", part)
    nodes = 3 if entries(f"Part {name!r}", given, "an array of cells").shape[1:] == (3,) else 2
    cells = validation.cells(f"Part {name!r}", given, nodes, distinct=False)
    validation.in_range(f"Part {name!r}", cells, count, "node")
    return cells
