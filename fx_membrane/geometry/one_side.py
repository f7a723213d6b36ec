"""Triangles of a surface turned to one side, across its pieces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .topology import edge_pieces, with_one_sense

ACROSS = 1e-3  # cosine between vector areas below which two pieces have no side in common
CLOSED = 1e-6  # vector area over area below which a piece is closed


def with_one_side(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], str]:
    """Turn triangles to one sense in each piece, and the pieces to one side, shape (cells, 3); also a reason, or "".

    Pieces share no edge: they are apart, or share nodes only. The vector area of a piece is the sum of the normals of
    its cells times their areas. Where its scalar product with that of the first piece that has one is negative, the
    piece is turned. A piece that is closed, or across the first, keeps the sense of its first cell.

    Args:
        points: Positions of the nodes, shape (n, 3).
        triangles: Cells, shape (cells, 3).

    Returns:
        The triangles, and the reason of `with_one_sense` for a surface without two sides, whose pieces are not turned.
    """
    cells, reason = with_one_sense(triangles)
    if reason:
        return cells, reason
    piece = edge_pieces(cells)
    if not piece.any():
        return cells, ""
    a, b, c = points[cells].transpose(1, 0, 2)
    areas = np.cross(b - a, c - a)
    vector = np.stack([np.bincount(piece, entry) for entry in areas.T], axis=1)
    size = np.linalg.norm(vector, axis=1)
    open_ = np.flatnonzero(size > CLOSED * np.bincount(piece, np.linalg.norm(areas, axis=1)))
    turned = np.zeros(len(size), dtype=bool)
    if len(open_):
        first = open_[0]
        turned[open_] = vector[open_] @ vector[first] < -ACROSS * size[open_] * size[first]
    return np.where(turned[piece, None], cells[:, [0, 2, 1]], cells), ""
