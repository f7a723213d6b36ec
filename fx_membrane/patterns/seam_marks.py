"""Places of marks for assembly along seams, the same on both strips."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .flat_strips import CuttingPattern
from .strip_edges import CORNER
from .strips import Edge

Array = NDArray[np.float64]

MAX_MARKS = 10_000  # marks along one seam: beyond it the spacing has another unit


def stations_of(pattern: CuttingPattern, spacing: float) -> dict[str, Array]:
    """Places of marks by seam, as fractional rows of its nodes.

    They stand at corners of the seam, and where a closed seam begins. Between these and its ends they stand at equal
    distances. Ends of open seams are corners of the strips, which need no mark.

    Args:
        pattern: The cutting pattern.
        spacing: Distance between marks, nearly [m].

    Raises:
        ValueError: There are too many.
    """
    return {
        edge.name: _stations(pattern.strips.structure.points[edge.nodes], _corners(pattern, edge), edge, spacing)
        for edge in pattern.strips.edges
        if edge.is_seam
    }


def _corners(pattern: CuttingPattern, edge: Edge) -> Array:
    """Rows of the nodes at which the seam turns in the flat cloth of a strip, ascending, without its ends."""
    nodes = []
    for name in dict.fromkeys(edge.strips):
        flat = pattern.flat[name]
        for side in flat.sides:
            if side.edge == edge.name:
                step = np.diff(flat.points[side.rows], axis=0)
                (ax, ay), (bx, by) = step[:-1].T, step[1:].T
                turn = np.abs(np.arctan2(ax * by - ay * bx, ax * bx + ay * by))
                nodes.append(flat.nodes[side.rows[1:-1][turn > CORNER]])
    return np.flatnonzero(np.isin(edge.nodes[1:-1], np.concatenate(nodes))).astype(np.float64) + 1


def _stations(points: Array, corners: Array, edge: Edge, spacing: float) -> Array:
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    rows = np.arange(len(along), dtype=np.float64)
    stops = np.concatenate([[0.0], along[corners.astype(int)], along[-1:]])
    counts = np.maximum(1, np.round(np.diff(stops) / spacing))
    if counts.sum() > MAX_MARKS:
        raise ValueError(
            f"mark_spacing is {spacing:g}: {counts.sum():.0f} marks along {edge.name!r} of length {along[-1]:.4g}; "
            "enlarge it."
        )
    runs = [np.linspace(*ends, int(n) + 1)[:-1] for ends, n in zip(pairwise(stops.tolist()), counts, strict=True)]
    places = np.interp(np.concatenate(runs), along, rows)
    return places if edge.nodes[0] == edge.nodes[-1] else places[1:]


def beside(points: Array, station: float, closed: bool = False) -> tuple[Array, Array]:
    """Point of a line at a fractional row, and the normal to its right; at a point of the line, the mean of two."""
    count = len(points) - 1
    row = min(int(station), count - 1)
    step = points[row + 1] - points[row]
    place = points[row] + (station - row) * step
    along = step / np.linalg.norm(step)
    if station == int(station):
        other = int(station) - 1 if row == station else 0
        if other >= 0 or closed:
            before = points[other % count + 1] - points[other % count]
            both = along + before / np.linalg.norm(before)
            along = both / np.linalg.norm(both) if np.linalg.norm(both) > 1e-6 else along
    return place, np.array([along[1], -along[0]])
