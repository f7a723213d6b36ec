"""Folds of strips: cells that lie on their neighbours, which flattening would spread beside each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..checks.validation import format_point
from ..geometry.sizes import normals

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

FOLD_ANGLE = np.radians(170)  # angle between the normals of neighbours from which on they lie on each other


def refuse_folded(name: str, points: Array, triangles: Integers) -> None:
    """Refuse a strip with two neighbours that lie on each other.

    Args:
        name: Name of the strip.
        points: Points of the strip, cut open along its seams, shape (n, 3) [m].
        triangles: Its cells, of one sense, shape (k, 3).

    Raises:
        ValueError: There are two.
    """
    ends = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    cell = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort(ends.T)
    same = (np.diff(ends[order], axis=0) == 0).all(axis=1)
    first, second = cell[order[:-1][same]], cell[order[1:][same]]
    normal = normals(points, triangles)
    cosine = np.einsum("ki,ki->k", normal[first], normal[second])
    if cosine.min(initial=1.0) < np.cos(FOLD_ANGLE):
        where = points[ends[order[:-1][same][cosine.argmin()]]].mean(axis=0)
        raise ValueError(
            f"Strip {name!r} is folded at {format_point(where)}: two cells beside an edge lie on each other; lead a "
            "seam along the fold, or find the form anew."
        )
