"""Depth of the water on the cells of membranes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.water_on_triangles import plan_areas, volumes
from .forces_of_state import PondResult

Array = NDArray[np.float64]


def mean_depths(ponds: tuple[PondResult, ...], part: str, cells: NDArray[np.int64], position: Array) -> Array:
    """Mean depth of the water on each cell of a membrane, its volume over the area in plan, shape (cells,) [m].

    Args:
        ponds: The water.
        part: Name of the membrane.
        cells: Its cells, shape (cells, 3).
        position: Current positions of all nodes, shape (n, 3) [m].
    """
    depth = np.zeros(len(cells))
    for pond in ponds:
        if pond.pond.part != part:
            continue
        mine = np.arange(len(cells)) if pond.pond.cells is None else np.asarray(pond.pond.cells)
        corners, here = position[cells[mine]], pond.depth[cells[mine]]
        wet = np.flatnonzero((here > 0).any(axis=1))
        deepest = here[wet].argmax(axis=1)
        level = here[wet, deepest] + corners[wet, deepest, 2]  # water of one level stands on each cell
        corners = corners[wet] - level[:, None, None] * [0, 0, 1]
        area = np.abs(plan_areas(corners))
        volume = np.abs(volumes(corners, 0.0)[0])
        depth[mine[wet]] += np.divide(volume, area, where=area > 0, out=np.zeros(len(wet)))
    return depth
