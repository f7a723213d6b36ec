"""New nodes of a split mesh, moved from flat cells to the curved surface and lines that these approximate."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..model.parts import Membrane
from ..model.structure import Structure
from ..surfaces.feature_lines import features
from ..surfaces.transfer import rise_of_line, rise_of_surface
from .split_mesh import SplitMesh, barycentric, pair

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def curved(structure: Structure, mesh: SplitMesh) -> Array:
    """Positions of the nodes of a split mesh on the curved surface, old ones unchanged, shape (n, 3) [m].

    Args:
        structure: The structure before the split.
        mesh: Its membranes, one after the other, split.
    """
    points, count = mesh.points, len(structure.points)
    new = np.arange(count, len(points))
    facet = np.array([mesh.facet_of(node) for node in new.tolist()], dtype=np.int64)
    rise = np.zeros_like(points)
    first = 0
    for part in structure.parts_of(Membrane).values():
        mine = (facet >= first) & (facet < first + len(part.cells))
        used, local = np.unique(part.cells, return_inverse=True)
        triangles, rows = local.reshape(-1, 3), facet[mine] - first
        shares = barycentric(structure.points[part.cells[rows]], points[new[mine]])
        rise[new[mine]] = rise_of_surface(structure.points[used], triangles, rows, shares)
        first += len(part.cells)
    for line in features(structure, np.zeros(0, dtype=np.int64)).lines:
        nodes, corners = [], []
        for row, (a, b) in enumerate(pairwise(line.tolist())):
            within = _within(mesh, a, b)
            nodes += within
            corners += [[row, row + 1]] * len(within)
        if nodes:
            places = structure.points[line]
            ends = places[np.array(corners)]
            side = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
            share = np.linalg.norm(points[nodes] - ends[:, 0], axis=1) / side
            rise[nodes] = rise_of_line(places, np.array(corners), np.column_stack([1 - share, share]))
    return np.asarray(points + rise)


def _within(mesh: SplitMesh, a: int, b: int) -> list[int]:
    """Nodes within an edge that may be split, in order."""
    middle = mesh.midpoints.get(pair(a, b))
    return [] if middle is None else [*_within(mesh, a, middle), middle, *_within(mesh, middle, b)]
