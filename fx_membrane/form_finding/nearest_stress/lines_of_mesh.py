"""Lines of a mesh: edges of its surface, and bars with a force; a seam between membranes is none."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...model.structure import Structure
from ..reasons.tangents import line_tangents

Array = NDArray[np.float64]
Segments = NDArray[np.int64]


class MeshLines(NamedTuple):
    """Lines of a mesh.

    A seam pulls at nothing, wherever it lies in the surface: its nodes are inner ones, as in a membrane of one part. An
    inner cable leaves its ends on an edge where equal segments have them: it pulls at both sides. The stress alone
    would move a cable between unlike membranes until one of them is gone.

    Attributes:
        segments: All segments, each once, shape (k, 2).
        rim: Those of edges of the surface, shape (r, 2).
        on_rim: Nodes of the latter, shape (n,).
        on_line: Nodes of all, shape (n,).
    """

    segments: Segments
    rim: Segments
    on_rim: NDArray[np.bool_]
    on_line: NDArray[np.bool_]

    def tangents(self, points: Array) -> Array:
        """Give unit tangents at nodes, of edges where these meet inner lines, (n, 3) [-]; zero at other junctions."""
        tangents = line_tangents(points, self.segments)
        return np.where(self.on_rim[:, None], line_tangents(points, self.rim), tangents)


def mesh_lines(structure: Structure, acting: Mapping[str, NDArray[np.bool_]]) -> MeshLines:
    """Lines of a structure.

    Args:
        structure: The structure.
        acting: Cells of bars that have a force, by part, shape (cells,).
    """
    none = np.zeros((0, 3), dtype=np.int64)
    rim = _rim(np.concatenate([none, *(part.cells for part in structure.membranes.values())]))
    bars = [structure.parts[name].cells[there] for name, there in acting.items()]
    segments = np.unique(np.sort(np.concatenate([rim, *bars])), axis=0)
    on_rim, on_line = (np.isin(np.arange(len(structure.points)), lines) for lines in (rim, segments))
    return MeshLines(segments, rim, on_rim, on_line)


def _rim(triangles: NDArray[np.int64]) -> Segments:
    """Edges where other than two triangles meet, shape (k, 2); triangles on the same nodes count as one."""
    single = np.unique(np.sort(triangles), axis=0)
    edges = single[:, [[0, 1], [1, 2], [0, 2]]].reshape(-1, 2)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    return np.asarray(pairs[count != 2])
