"""Order of the nodes along lines of segments."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import depth_first_order

Integers = NDArray[np.int64]


def path_along(segments: Integers) -> Integers:
    """Nodes in the order of one line of segments in any order, shape (k,); a ring ends with its first node.

    Raises:
        ValueError: They branch, or are in several pieces.
    """
    nodes, ends = np.unique(segments, return_inverse=True)
    ends = ends.reshape(segments.shape)
    meeting = np.bincount(ends.ravel())
    branching = np.flatnonzero(meeting > 2)
    if len(branching):
        raise ValueError(f"the cells branch at node {nodes[branching[0]]}; give one line")
    closed = bool((meeting == 2).all())
    start = int(ends[0, 0]) if closed else int(np.flatnonzero(meeting == 1)[0])
    kept = ends[1:] if closed else ends
    graph = sparse.coo_matrix((np.ones(len(kept)), tuple(kept.T)), shape=(len(nodes), len(nodes)))
    order = depth_first_order(graph.tocsr(), start, directed=False, return_predecessors=False)
    if len(order) < len(nodes):
        missed = np.setdiff1d(np.arange(len(nodes)), order)
        raise ValueError(f"the cells are in several pieces, one of them at node {nodes[missed[0]]}; give one line")
    return np.append(nodes[order], nodes[start]) if closed else nodes[order]


def lines_between(segments: Iterable[tuple[int, int]], ends: Collection[int] = ()) -> list[list[int]]:
    """Nodes along each line of segments, from end to end; of a closed line the first comes last again.

    Args:
        segments: Pairs of nodes, each once.
        ends: Nodes at which lines end beside those where one segment ends, or more than two meet.
    """
    meeting: dict[int, list[int]] = defaultdict(list)
    left = {(a, b) if a < b else (b, a) for a, b in segments}
    for a, b in sorted(left):
        meeting[a].append(b)
        meeting[b].append(a)
    known = {node for node, others in meeting.items() if len(others) != 2}.union(ends)
    found = []
    for start in [*sorted(known & meeting.keys()), *sorted(meeting)]:  # closed lines come last
        for following in meeting[start]:
            if (min(start, following), max(start, following)) not in left:
                continue
            nodes = [start, following]
            while nodes[-1] not in known and nodes[-1] != start:
                nodes.append(next(node for node in meeting[nodes[-1]] if node != nodes[-2]))
            left.difference_update((min(pair), max(pair)) for pair in pairwise(nodes))
            found.append(nodes)
    return found
