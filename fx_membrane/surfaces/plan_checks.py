"""Checks of a plan: no curve crosses another, holes and lines are inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


def crossing(points: Array, segments: Integers, near: float) -> tuple[int, int, Array] | None:
    """Two segments that cross, touch or overlap, except in a common end, and the place; None without one.

    Args:
        points: Places of the nodes, shape (n, 2) [m].
        segments: Rows of their ends, shape (k, 2).
        near: Distance that counts as touching [m].
    """
    a, b = points[segments[:, 0]], points[segments[:, 1]]
    half = np.linalg.norm(b - a, axis=1) / 2
    pairs = _near_pairs((a + b) / 2, half, near)
    if not len(pairs):
        return None
    first, second = pairs.T
    common = (segments[first][:, :, None] == segments[second][:, None, :]).any(axis=(1, 2))
    meet = np.where(common, _folded(points, segments, pairs, near), _touch(a, b, first, second, near))
    found = np.flatnonzero(meet)
    if not len(found):
        return None
    i, j = (int(index) for index in pairs[found[0]])
    return i, j, _meeting(a[i], b[i], a[j], b[j])


def pinched(points: Array, segments: Integers, loops: Integers) -> tuple[int, int, Array] | None:
    """Two segments of loops that begin at the same node, and its place; None if no two do."""
    border = np.flatnonzero(loops >= 0)
    order = border[np.argsort(segments[border, 0], kind="stable")]
    starts = segments[order, 0]
    twice = np.flatnonzero(starts[1:] == starts[:-1])
    if not len(twice):
        return None
    return int(order[twice[0]]), int(order[twice[0] + 1]), points[starts[twice[0]]]


def _near_pairs(middles: Array, half: Array, near: float) -> NDArray[np.intp]:
    """Pairs of segments whose circles meet; by classes of length, so that one long segment is not near to all."""
    groups = np.floor(np.log2(np.maximum(half, near)) / 2).astype(int)
    found = [np.zeros((0, 2), dtype=np.intp)]
    trees = {group: (np.flatnonzero(groups == group)) for group in np.unique(groups)}
    for group, rows in trees.items():
        for other, others in trees.items():
            if other > group:
                continue
            reach = half[rows].max() + half[others].max() + 2 * near
            neighbours = cKDTree(middles[rows]).query_ball_tree(cKDTree(middles[others]), reach)
            i = np.repeat(rows, [len(hits) for hits in neighbours])
            j = others[np.concatenate([np.asarray(hits, dtype=np.intp) for hits in neighbours])]
            apart = np.linalg.norm(middles[i] - middles[j], axis=1) <= half[i] + half[j] + 2 * near
            keep = apart & ((i < j) if other == group else True)
            found.append(np.stack([i[keep], j[keep]], axis=1))
    return np.concatenate(found)


def _cross(u: Array, v: Array) -> Array:
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


def _touch(a: Array, b: Array, first: NDArray[np.intp], second: NDArray[np.intp], near: float) -> NDArray[np.bool_]:
    """Tell pairs of segments that cross, or of which an end is near the other segment."""
    p, q, r, s = a[first], b[first], a[second], b[second]
    sides = (_cross(q - p, r - p) > 0) != (_cross(q - p, s - p) > 0)
    sides &= (_cross(s - r, p - r) > 0) != (_cross(s - r, q - r) > 0)
    gaps = [_distance(r, p, q), _distance(s, p, q), _distance(p, r, s), _distance(q, r, s)]
    return np.asarray(sides | (np.min(gaps, axis=0) <= near))


def _distance(points: Array, a: Array, b: Array) -> Array:
    """Distances of points from segments, shape (n,) [m]."""
    along = b - a
    t = np.sum((points - a) * along, axis=1) / np.maximum(np.sum(along**2, axis=1), np.finfo(float).tiny)
    return np.asarray(np.linalg.norm(points - a - t.clip(0, 1)[:, None] * along, axis=1))


def _folded(points: Array, segments: Integers, pairs: NDArray[np.intp], near: float) -> NDArray[np.bool_]:
    """Tell pairs of segments with a common end of which one lies on the other."""
    one, other = segments[pairs[:, 0]], segments[pairs[:, 1]]
    own = ~(one[:, :, None] == other[:, None, :]).any(axis=2)
    foreign = ~(other[:, :, None] == one[:, None, :]).any(axis=2)
    gaps = np.full(len(pairs), np.inf)
    for corner in range(2):
        p, q = points[one[:, 0]], points[one[:, 1]]
        gaps = np.where(foreign[:, corner], np.minimum(gaps, _distance(points[other[:, corner]], p, q)), gaps)
        p, q = points[other[:, 0]], points[other[:, 1]]
        gaps = np.where(own[:, corner], np.minimum(gaps, _distance(points[one[:, corner]], p, q)), gaps)
    return np.asarray((gaps <= near) | ~(own.any(axis=1)))


def _meeting(a: Array, b: Array, c: Array, d: Array) -> Array:
    """Point where the lines of two segments meet, or the middle of the overlap of parallel ones, shape (2,)."""
    u, v = b - a, d - c
    area = u[0] * v[1] - u[1] * v[0]
    if abs(area) <= 1e-9 * np.linalg.norm(u) * np.linalg.norm(v):
        t = np.sort([np.clip((p - a) @ u / (u @ u), 0, 1) for p in (c, d)])
        return np.asarray(a + t.mean() * u)
    w = c - a
    return np.asarray(a + (w[0] * v[1] - w[1] * v[0]) / area * u)


def inside(points: Array, loop: Array) -> NDArray[np.bool_]:
    """Tell points inside a closed polygon, by the number of its sides to their right, shape (n,).

    Args:
        points: The points, shape (n, 2) [m].
        loop: Corners of the polygon, shape (k, 2) [m].
    """
    a, b = loop, np.roll(loop, -1, axis=0)
    x, y = points[:, :1], points[:, 1:]
    between = (a[:, 1] > y) != (b[:, 1] > y)
    slope = np.divide(b[:, 0] - a[:, 0], b[:, 1] - a[:, 1], where=b[:, 1] != a[:, 1], out=np.zeros(len(a)))
    return np.asarray((between & (x < a[:, 0] + (y - a[:, 1]) * slope)).sum(axis=1) % 2 == 1)


def area(loop: Array) -> float:
    """Area of a polygon, positive counter-clockwise [m2]."""
    x, y = (loop - loop.mean(axis=0)).T
    return float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2)
