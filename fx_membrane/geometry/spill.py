"""Spill nodes of a surface: over which water leaves that stands at a node."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def edge_graph(triangles: Integers, weight: Array) -> sparse.coo_array:
    """Edges with the larger weight of their two nodes, shape (n, n)."""
    a, b = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]).T
    a, b = np.minimum(a, b), np.maximum(a, b)
    _, first = np.unique(a * len(weight) + b, return_index=True)
    a, b = a[first], b[first]
    return sparse.coo_array((np.maximum(weight[a], weight[b]), (a, b)), shape=(len(weight), len(weight)))


def spill_nodes(triangles: Integers, height: Array, outlets: Integers) -> Integers:
    """Highest node of the lowest way from each node to an outlet, shape (n,); the node itself if it drains."""
    count = len(height)
    rank = np.empty(count)
    rank[np.argsort(height, kind="stable")] = np.arange(1, count + 1)  # nonzero, and without ties
    edges = edge_graph(triangles, rank)
    # One more node, outside, beside all outlets.
    rows = np.concatenate([edges.row, outlets])
    columns = np.concatenate([edges.col, np.full(len(outlets), count)])
    weights = np.concatenate([edges.data, rank[outlets]])
    graph = sparse.csr_matrix((weights, (rows, columns)), shape=(count + 1, count + 1))
    tree = minimum_spanning_tree(graph)
    order, parent = breadth_first_order(tree, count, directed=False)
    parent[count] = count
    reached = np.zeros(count + 1, dtype=bool)
    reached[order] = True
    parent = np.where(reached, parent, np.arange(count + 1))
    highest = np.append(rank, 0)
    while (parent != parent[parent]).any():  # twice the way in each turn
        highest = np.maximum(highest, highest[parent])
        parent = parent[parent]
    at_rank = np.argsort(height, kind="stable")
    return np.asarray(at_rank[np.maximum(highest[:count], highest[parent[:count]]).astype(np.int64) - 1])
