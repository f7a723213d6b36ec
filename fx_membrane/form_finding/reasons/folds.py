"""Folds of a first mesh: adjoining cells of a membrane that lie upon each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...checks.values import format_point
from ...geometry.sizes import normals
from ...geometry.topology import orientation
from ...model.structure import Structure
from .edge_lines import keys_of
from .sewn_surfaces import cell_in, cells_of, joined_membranes

Array = NDArray[np.float64]

FOLDED = (
    -0.5
)  # cosine of the angle between normals of adjoining cells, below which they count as folded: beyond 120 degrees


def fold(structure: Structure, points: Array) -> str:
    """Tell of the sharpest fold of a membrane, in words; empty without one."""
    for names in joined_membranes(structure):
        cells = cells_of(structure, names)
        sense = orientation(cells)
        if sense is None:
            continue
        pairs, edges = _adjoining(cells, len(points))
        normal = sense[:, None] * normals(points, cells)
        cosine = np.sum(normal[pairs[:, 0]] * normal[pairs[:, 1]], axis=1)
        if cosine.min(initial=1.0) < FOLDED:
            sharpest = int(cosine.argmin())
            a, b = np.sort(pairs[sharpest])
            where = format_point(points[edges[sharpest]].mean(axis=0))
            (name, a), (other, b) = (cell_in(structure, names, int(cell)) for cell in (a, b))
            if name != other:
                return (
                    f"Parts {name!r} and {other!r} fold over each other at their seam between cell {a} and cell {b}, "
                    f"at {where}: unfold their first mesh there"
                )
            return f"Part {name!r} folds over itself between cells {a} and {b}, at {where}: unfold its first mesh there"
    return ""


def _adjoining(cells: NDArray[np.int64], count: int) -> tuple[NDArray[np.intp], NDArray[np.int64]]:
    """Pairs of cells with a common edge, and the edge, both of shape (pairs, 2)."""
    edges = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    keys = keys_of(edges, count)
    order = np.argsort(keys, kind="stable")
    first = np.flatnonzero(np.diff(keys[order]) == 0)
    pairs = np.stack([order[first], order[first + 1]], axis=1)
    return pairs % len(cells), edges[pairs[:, 0]]
