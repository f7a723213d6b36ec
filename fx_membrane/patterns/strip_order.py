"""Strips of a split surface: pieces between seams, in an order in which neighbours follow each other."""

from __future__ import annotations

from collections import defaultdict

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from .split_mesh import Pair

Integers = NDArray[np.int64]


def pieces(cells: Integers, seams: dict[Pair, int]) -> Integers:
    """Find the number of the strip of each cell of a membrane, shape (cells,).

    The first strip is that beside the first seams; each one is followed by a neighbour where there is one.

    Args:
        cells: Its cells, shape (cells, 3).
        seams: Number of the seam on each edge that is on one, by the nodes of the edge, ascending.
    """
    count, base = len(cells), int(cells.max()) + 1
    ends = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    code = ends[:, 0] * base + ends[:, 1]
    order = np.argsort(code, kind="stable")
    start = np.flatnonzero(np.append(True, np.diff(code[order]) != 0))
    double = start[np.diff(np.append(start, len(order))) == 2]
    first, second = order[double] % count, order[double + 1] % count
    on = np.array([seams.get((a, b), -1) for a, b in ends[order[double]].tolist()], dtype=np.int64)
    free = on < 0
    graph = sparse.coo_array((np.ones(free.sum()), (first[free], second[free])), shape=(count, count))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    beside = np.column_stack([label[first], label[second], on])[~free]
    rank = np.empty(label.max() + 1, dtype=np.int64)
    rank[_sequence(len(rank), beside)] = np.arange(len(rank))
    return np.asarray(rank[label])


def _sequence(count: int, beside: Integers) -> list[int]:
    """Order of strips, from pairs of them and the seam between, shape (k, 3)."""
    seams: dict[int, set[int]] = defaultdict(set)
    others: dict[int, set[int]] = defaultdict(set)
    for a, b, seam in np.unique(beside, axis=0).tolist():
        seams[a].add(seam)
        seams[b].add(seam)
        others[a].add(b)
        others[b].add(a)
    key = [(sorted(seams[strip], reverse=True), strip) for strip in range(count)]
    left, found = set(range(count)), list[int]()
    while left:
        near = others[found[-1]] & left if found else left
        near = near or {strip for strip in left if others[strip] & set(found)} or left
        found.append(min(near, key=lambda strip: key[strip]))
        left.discard(found[-1])
    return found
