"""Closed surfaces of triangles: their open edges, and their volume.

A surface is closed if its oriented triangles have no boundary: each edge is run along as often one way as the other.
That allows edges of four triangles, as where two skins of a cushion share a corner cell.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

Nodes = NDArray[np.int64]


def boundary(triangles: Nodes) -> tuple[Nodes, Nodes]:
    """Boundary of oriented triangles: edges (k, 2), each once, low node first, and their number (k,), signed.

    The number counts the ways from the low to the high node, less those back.
    """
    if not len(triangles):
        return np.empty((0, 2), dtype=np.int64), np.empty(0, dtype=np.int64)
    a, b = triangles.T.ravel(), triangles.T[[1, 2, 0]].ravel()
    base = int(triangles.max()) + 1
    numbers, place = np.unique(np.minimum(a, b) * base + np.maximum(a, b), return_inverse=True)
    sums = np.bincount(place.ravel(), np.where(a < b, 1.0, -1.0), len(numbers)).astype(np.int64)
    numbers, sums = numbers[sums != 0], sums[sums != 0]
    return np.column_stack([numbers // base, numbers % base]), sums


def open_edges(triangles: Nodes) -> Nodes:
    """Edges of the boundary, in the sense of the triangles, each as often as it is open, shape (k, 2)."""
    edges, sums = boundary(triangles)
    turned = np.where(sums[:, None] > 0, edges, edges[:, ::-1])
    return np.repeat(turned, np.abs(sums), axis=0)


def holes(edges: Nodes) -> list[Nodes]:
    """Group open edges that share nodes: the rims of holes, the largest first, each of shape (k, 2)."""
    nodes, places = np.unique(edges, return_inverse=True)
    ends = places.reshape(-1, 2)
    graph = sparse.coo_matrix((np.ones(len(ends)), tuple(ends.T)), shape=(len(nodes),) * 2)
    label = connected_components(graph, directed=False)[1][ends[:, 0]]
    return sorted((edges[label == one] for one in np.unique(label)), key=len, reverse=True)


def volume(points: NDArray[np.float64], triangles: Nodes) -> float:
    """Volume within a closed surface, its normals outwards; negative if they point inwards."""
    corners = points[triangles] - points[triangles].mean(axis=(0, 1))
    return float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)
