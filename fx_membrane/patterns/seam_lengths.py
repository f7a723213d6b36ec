"""Lengths of the edges of a cutting pattern: on the surface, flat, and in the cloth on each side."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .flat_strips import CuttingPattern, FlatStrip
from .strips import Edge

Array = NDArray[np.float64]


class SeamLengths(NamedTuple):
    """Lengths of an edge [m].

    Attributes:
        surface: On the surface.
        flat: In the flat shapes, on each of its sides, shape (sides,).
        cloth: In the cloth, on each of its sides, shape (sides,).

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> seam = prove_pattern(cutting_pattern(cut_strips(roof, ["valley"]))).edges["seam 1"]
        >>> round(seam.surface, 6), seam.flat.round(6).tolist(), seam.difference < 1e-6
        (2.0, [2.0, 2.0], True)
    """

    surface: float
    flat: Array
    cloth: Array

    @property
    def difference(self) -> float:
        """Difference of both sides in the cloth, zero for a border [m]."""
        return float(np.ptp(self.cloth))


def edge_lengths(pattern: CuttingPattern) -> dict[str, SeamLengths]:
    """Lengths of all edges by name."""
    points = pattern.strips.structure.points
    return {
        edge.name: SeamLengths(
            surface=float(np.linalg.norm(np.diff(points[edge.nodes], axis=0), axis=1).sum()),
            flat=np.array([side.sum() for side in _sides(pattern.flat, edge)]),
            cloth=np.array([side.sum() for side in _sides(pattern.cloth, edge)]),
        )
        for edge in pattern.strips.edges
    }


def segment_differences(pattern: CuttingPattern) -> dict[str, Array]:
    """Differences of the sides of each segment of seams, over its mean length, by name, each shape (segments,) [-]."""
    found = {}
    for edge in pattern.strips.edges:
        if edge.is_seam:
            sides = np.stack(list(_sides(pattern.cloth, edge)))
            found[edge.name] = np.ptp(sides, axis=0) / sides.mean(axis=0)
    return found


def _sides(strips: Mapping[str, FlatStrip], edge: Edge) -> Iterator[Array]:
    """Lengths of the segments of an edge on each of its sides, in the order of its nodes, each (segments,) [m]."""
    for strip in strips.values():
        for side in strip.sides:
            if side.edge == edge.name:
                lengths = strip.side_lengths(side)
                onward = np.array_equal(strip.nodes[side.rows], edge.nodes)
                yield lengths if onward else lengths[::-1]
