"""Hollows of a surface: the cells whose water runs to one lowest node, and the ways over which they spill.

Water of a cell runs to its lowest node, and from node to node along the steepest edge. A way leads from one hollow to
another along an edge, at the height of its higher node. Outlets are ways, too, at their own heights. Below the lowest
of its ways, water of a hollow stands on cells of that hollow alone: a wet cell has a wet lowest node.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .spill import spill_nodes

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

OUTSIDE = -1
SHALLOW_SHARE = 1e-3  # depth over that of the deepest hollow, below which a hollow joins the one into which it spills
DEPTH_ROUNDING = 1e-9  # depth over the size of the surface that is rounding


class Hollows(NamedTuple):
    """Hollows of a surface.

    Attributes:
        of_cell: Hollow of each cell, shape (cells,); -1 where water runs off.
        pits: Lowest node of each hollow, shape (hollows,).
        ways: Lowest way between each two hollows, from the lowest on: the hollows, the second -1 for the outside, and
            the node, shape (ways, 3).
    """

    of_cell: Integers
    pits: Integers
    ways: Integers


def hollows_of(points: Array, triangles: Integers, outlets: Integers) -> Hollows:
    """Find the hollows of a surface; a surface without any, as a level sheet, is one up to its lowest outlet.

    Args:
        points: Positions, shape (n, 3) [m].
        triangles: The cells, shape (cells, 3).
        outlets: Nodes over which water leaves, shape (k,).
    """
    nodes, places = np.unique(triangles, return_inverse=True)
    points, cells = points[nodes], places.reshape(-1, 3)
    exits = np.searchsorted(nodes, outlets)
    height = points[:, 2]
    rank = np.empty(len(height), dtype=np.int64)
    rank[np.lexsort((nodes, height))] = np.arange(len(height))  # heights without ties
    root = _roots(points, cells, rank)
    pits, label = np.unique(root, return_inverse=True)
    label = label.ravel().astype(np.int64)
    off = np.isin(pits, exits)
    number = np.where(off, OUTSIDE, np.cumsum(~off) - 1)
    label, pits = number[label], pits[~off]
    ways = _lowest_ways(*_all_ways(cells, label, rank, exits))
    depth = height[spill_nodes(cells, height, exits)] - height
    least = max(SHALLOW_SHARE * float(depth.max(initial=0.0)), DEPTH_ROUNDING * float(np.ptp(points, axis=0).max()))
    label, pits, ways = _without_shallow(label, pits, ways, height, rank, least)
    if not len(pits):
        label, pits = np.zeros(len(points), dtype=np.int64), np.array([rank.argmin()])
        ways = np.array([[0, OUTSIDE, exits[rank[exits].argmin()]]] if len(exits) else np.zeros((0, 3)), dtype=np.int64)
    lowest = cells[np.arange(len(cells)), rank[cells].argmin(axis=1)]
    ways[:, 2] = nodes[ways[:, 2]]
    return Hollows(label[lowest], nodes[pits], ways)


def _roots(points: Array, cells: Integers, rank: Integers) -> Integers:
    """Node at which water from each node ends, shape (n,)."""
    a, b = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]).T
    upper, lower = np.where(rank[a] > rank[b], a, b), np.where(rank[a] > rank[b], b, a)
    run = np.linalg.norm(points[upper, :2] - points[lower, :2], axis=1)
    fall = points[upper, 2] - points[lower, 2]
    slope = np.divide(fall, run, where=run > 0, out=np.where(fall > 0, np.inf, 0.0))
    order = np.lexsort((rank[lower], -slope, upper))
    starts, first = np.unique(upper[order], return_index=True)
    to = np.arange(len(points))
    to[starts] = lower[order[first]]
    while (to != to[to]).any():  # each turn doubles the steps that are followed
        to = to[to]
    return to


def _all_ways(cells: Integers, label: Integers, rank: Integers, exits: Integers) -> tuple[Integers, Integers]:
    """Ways from hollow to hollow or outside, shape (ways, 3), and the rank of their nodes."""
    a, b = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]).T
    across = label[a] != label[b]
    a, b = a[across], b[across]
    over = exits[label[exits] != OUTSIDE]
    node = np.concatenate([np.where(rank[a] > rank[b], a, b), over])
    left = np.concatenate([label[a], label[over]])
    right = np.concatenate([label[b], np.full(len(over), OUTSIDE)])
    ways = np.column_stack([np.maximum(left, right), np.minimum(left, right), node])
    return ways, rank[node]


def _lowest_ways(ways: Integers, rank: Integers) -> Integers:
    """Lowest way between each two hollows, the lowest first."""
    ways = ways[np.lexsort((ways[:, 1], ways[:, 0], rank))]
    _, first = np.unique(ways[:, :2], axis=0, return_index=True)
    return ways[np.sort(first)]


def _without_shallow(
    label: Integers, pits: Integers, ways: Integers, height: Array, rank: Integers, least: float
) -> tuple[Integers, Integers, Integers]:
    """Join each hollow that is less deep than a limit with the one into which it spills, the shallowest first."""
    while len(pits):
        way = np.full(len(pits), len(ways))
        for column in (0, 1):
            inside = ways[:, column] != OUTSIDE
            np.minimum.at(way, ways[inside, column], np.flatnonzero(inside))
        open_ = way < len(ways)
        depth = np.full(len(pits), np.inf)
        depth[open_] = height[ways[way[open_], 2]] - height[pits[open_]]
        here = int(depth.argmin())
        if depth[here] > least:
            break
        a, b, _ = ways[way[here]]
        other = int(b if a == here else a)
        if other != OUTSIDE and rank[pits[here]] < rank[pits[other]]:
            pits[other] = pits[here]
        renamed = np.arange(len(pits) + 1)  # the last entry is the outside
        renamed[here] = other if other != OUTSIDE else len(pits)
        renamed = np.where(renamed == len(pits), OUTSIDE, renamed - (renamed > here))
        label, pits = renamed[label], np.delete(pits, here)
        sides = np.sort(renamed[ways[:, :2]], axis=1)[:, ::-1]
        kept = sides[:, 0] != sides[:, 1]
        node = ways[kept, 2]
        ways = _lowest_ways(np.column_stack([sides[kept], node]), rank[node])
    return label, pits, ways
