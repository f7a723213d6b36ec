"""Edges, boundaries, orientation of triangles and the graph of nodes: topology without positions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks import validation


class _Edges(NamedTuple):
    """Edges of triangles: all first ones, then all second, then all third ones.

    Attributes:
        edges: Their nodes in the sense of their triangle, shape (3 cells, 2).
        number: Number of each edge, equal for both senses, shape (3 cells,).
        triangles: Number of triangles of each number, shape (distinct edges,).
        order: The edges by ascending number, shape (3 cells,).
    """

    edges: NDArray[np.int64]
    number: NDArray[np.intp]
    triangles: NDArray[np.intp]
    order: NDArray[np.intp]


def distinct(numbers: NDArray[np.int64], bound: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Distinct whole numbers, ascending, and the position of each given one among them, without sorting.

    Args:
        numbers: Numbers from 0 up to, but without, the bound; any shape.
        bound: The bound; as many numbers are held for a while.
    """
    there = np.zeros(bound, dtype=bool)
    there[numbers] = True
    position = np.cumsum(there, dtype=np.int64) - 1
    return np.flatnonzero(there), position[numbers]


def boundary_edges(triangles: ArrayLike) -> NDArray[np.int64]:
    """Edges that belong to one triangle only, shape (edges, 2), in the sense of their triangle.

    Args:
        triangles: Cells, shape (cells, 3).

    Raises:
        ValueError: They are not triangles.

    Example:
        >>> boundary_edges([[0, 1, 2], [0, 2, 3]]).tolist()
        [[0, 1], [3, 0], [1, 2], [2, 3]]
    """
    senses, base = _senses(validation.cells("triangles", triangles, 3, distinct=False))
    edge = senses // 2
    other = np.diff(edge) != 0
    outer = np.append(True, other) & np.append(other, True)
    edges = np.column_stack(np.divmod(edge[outer], base))
    return np.where(senses[outer, None] % 2, edges, edges[:, ::-1])


def boundary_cells(triangles: NDArray[np.int64]) -> NDArray[np.intp]:
    """Triangles of the boundary edges, in the order of `boundary_edges`, shape (edges,)."""
    topology = _edges(triangles)
    alone = topology.triangles[topology.number[topology.order]] == 1
    return np.asarray(topology.order[alone] % len(triangles))


def orientation(triangles: NDArray[np.int64]) -> NDArray[np.float64] | None:
    """Signs that turn all triangles of a connected piece to the sense of its first, shape (cells,); or None.

    Edges with two triangles connect pieces; where more meet, each sheet has its own sense. None means that no signs do.
    """
    return _signs(_edges(triangles))


def _signs(topology: _Edges) -> NDArray[np.float64] | None:
    edges, number, count, order = topology
    n = len(edges) // 3
    owner = np.tile(np.arange(n), 3)
    forward = edges[:, 0] < edges[:, 1]
    first, second = order[count[number[order]] == 2].reshape(-1, 2).T
    a, b, same = owner[first], owner[second], forward[first] != forward[second]
    # Two copies of each triangle, one for each sense: a piece is one-sided if both copies are connected.
    rows = np.concatenate([a, a + n])
    columns = np.concatenate([np.where(same, b, b + n), np.where(same, b + n, b)])
    graph = sparse.coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(2 * n, 2 * n))
    label = connected_components(graph, directed=False)[1].reshape(2, n)
    if (label[0] == label[1]).any():
        return None
    piece = np.minimum(label[0], label[1])
    _, first, member = np.unique(piece, return_index=True, return_inverse=True)
    return np.where(label[0] == label[0, first][member.ravel()], 1.0, -1.0)


def with_one_sense(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], str]:
    """Turn triangles to the sense of the first of their connected piece, shape (cells, 3); also a reason, or "".

    The first node of a turned triangle stays first; the other two change places. The reason for a membrane without two
    sides ends a sentence that begins with the surface: it branches, or has one side only.
    """
    if np.diff(_senses(triangles)[0]).all():  # the usual case, in a third of the time
        return triangles, ""
    topology = _edges(triangles)
    signs, branch = _signs(topology), _branch(topology)
    if signs is None:
        return triangles, (
            "has only one side, like a Moebius strip: a normal, a pressure and a shear have no direction on it; "
            "cut it into parts along a line of edges."
        )
    turned = np.where(signs[:, None] > 0, triangles, triangles[:, [0, 2, 1]])
    if branch is None:
        return turned, ""
    return turned, (
        f"branches at the edge between nodes {branch[0]} and {branch[1]}, and has no two sides: a normal, a "
        "pressure and a shear no direction; make each sheet a part of its own."
    )


def edge_pieces(triangles: NDArray[np.int64]) -> NDArray[np.intp]:
    """Pieces that edges of two triangles connect, in the order of their first triangles, shape (cells,)."""
    _, number, count, order = _edges(triangles)
    n = len(triangles)
    first, second = (order[count[number[order]] == 2] % n).reshape(-1, 2).T
    graph = sparse.coo_matrix((np.ones(len(first), dtype=np.int8), (first, second)), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    _, start, member = np.unique(label, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(start))[member.ravel()]


def branching_edge(triangles: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """Find an edge with three triangles or more, shape (2,); None if there is none."""
    return _branch(_edges(triangles))


def _branch(topology: _Edges) -> NDArray[np.int64] | None:
    edges, number, count, _ = topology
    return np.sort(edges[number == np.argmax(count)][0]) if count.max() > 2 else None


def from_smallest(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rotate cells to their smallest node first, shape of cells: triangles keep their sense, segments do not."""
    order = np.argmin(cells, axis=1)[:, None] + np.arange(cells.shape[1])
    return np.take_along_axis(cells, order % cells.shape[1], axis=1)


class Connected(NamedTuple):
    """Connected pieces, numbered from 0.

    Attributes:
        pieces: Number of pieces; a node or a cell that nothing joins is one of its own.
        nodes: Piece of each node, shape (n,).
        cells: For each part, the piece of each cell, shape (cells,).
    """

    pieces: int
    nodes: NDArray[np.int32]
    cells: list[NDArray[np.int32]]


def connected(cells: Sequence[NDArray[np.int64]], joining: NDArray[np.bool_]) -> Connected:
    """Find the pieces of cells that some nodes join.

    Args:
        cells: For each part, rows of node numbers, shape (cells, nodes per cell).
        joining: Nodes that join their cells, shape (n,).
    """
    n, counts = len(joining), [len(part) for part in cells]
    joins = [joining[part] for part in cells]
    ends = np.concatenate([part[where] for part, where in zip(cells, joins, strict=True)])
    # Rows of the graph: nodes, which are empty, then cells with the nodes that join them.
    lengths = np.concatenate([np.zeros(n + 1, dtype=np.int64), *(np.count_nonzero(where, axis=1) for where in joins)])
    total = n + sum(counts)
    graph = sparse.csr_matrix((np.ones(len(ends), dtype=np.int8), ends, np.cumsum(lengths)), shape=(total, total))
    count, label = connected_components(graph, directed=False)
    nodes, *parts = np.split(label, np.cumsum([n, *counts])[:-1])
    return Connected(count, nodes, parts)


def node_graph(cells: Iterable[NDArray[np.int64]], count: int) -> sparse.csr_array:
    """Graph of nodes that share a cell: sparse matrix (count, count), a node with itself included.

    Args:
        cells: For each part, rows of node numbers, shape (cells, nodes per cell).
        count: Number of nodes.
    """
    graph = sparse.csr_matrix((count, count), dtype=np.int32)
    for part in cells:
        n, width = part.shape
        ones = np.ones(part.size, dtype=np.int32)
        incidence = sparse.csr_matrix((ones, part.ravel(), np.arange(0, part.size + 1, width)), shape=(n, count))
        graph = graph + incidence.T @ incidence
    return graph


def _senses(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], int]:
    """Senses in which triangles run along their edges, ascending, shape (3 cells,); also the base of the numbers.

    A sense is a whole number: 2 (low base + high) of the nodes of the edge, plus one for the way from low to high.
    """
    a, b = triangles.T.ravel(), triangles.T[[1, 2, 0]].ravel()
    base = int(triangles.max()) + 1
    return np.sort(2 * (np.minimum(a, b) * base + np.maximum(a, b)) + (a < b)), base


def _edges(triangles: NDArray[np.int64]) -> _Edges:
    a, b = triangles.T.ravel(), triangles.T[[1, 2, 0]].ravel()
    high = np.maximum(a, b)
    pair = np.minimum(a, b) * (high.max() + 1) + high  # one whole number: sorting rows is many times slower
    order = np.argsort(pair)
    new = np.concatenate([[True], np.diff(pair[order]) != 0])
    number = np.empty(len(pair), dtype=np.intp)
    number[order] = np.cumsum(new) - 1
    count = np.diff(np.append(np.flatnonzero(new), len(pair)))
    return _Edges(np.column_stack([a, b]), number, count, order)
