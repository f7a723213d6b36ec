"""Arcs of edge cables: how far each may turn from its chord before it meets another one, or a held edge.

A stress n pulls at an edge of span L with n L in all. Its cable of the force T is an arc of the radius T / n. Its ends
turn from the chord by asin(n L / (2 T)), a quarter of a circle at most. With k segments of the force density q they
turn by k n / (2 q), as the force then grows with the length of the arc. Where two edges meet, their turns together stay
below the angle of their chords. Elsewhere arcs are compared in the plane that fits the boundary best.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .edge_lines import Edge

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

SIDES = 24  # segments of an arc: half a circle lies within 0.2 % of its radius, (pi / 24)^2 / 8, of them
HALVINGS = 40  # of a turn, to 1e-12 of it: far below the digits of forces in words


class Conflict(NamedTuple):
    """Edges whose arcs would meet, or one whose arc would meet a held edge.

    Attributes:
        edges: Numbers of the edges, one or two.
        node: Corner where they meet; None elsewhere.
        other: Place on the held edge, shape (3,) [m]; None for two edges.
        excess: Measure of how far the turns are from fitting, which is at or below zero if they do.
    """

    edges: tuple[int, ...]
    node: int | None
    other: Array | None
    excess: Callable[[Array], float]


def turns_of(edges: Sequence[Edge], given: Array) -> Array:
    """Return the turns of the ends of arcs from their chords under forces, both of shape (edges,) [rad]."""
    return np.array([edge.turn(float(force)) for edge, force in zip(edges, given, strict=True)], dtype=np.float64)


def least_forces(edges: Sequence[Edge], conflicts: Sequence[Conflict]) -> tuple[Array, list[Conflict]]:
    """Least forces, or force densities, of edges that have a form, and the conflicts met, the worst first.

    Each edge needs half its pull, and turns that leave no conflict. Of two edges that meet, the one with the larger
    turn is raised. Edges with one force keep to one. No result depends on the forces of edges that are raised.
    """
    forces = np.array([edge.given for edge in edges], dtype=np.float64)
    for k, edge in enumerate(edges):
        forces = _raised(edges, forces, [k], np.pi / 2) if edge.need else forces
    met, turns = list[Conflict](), turns_of(edges, forces)
    for conflict in sorted(conflicts, key=lambda one: -one.excess(turns)):
        if conflict.excess(turns_of(edges, forces)) <= 0:
            continue
        low, high = 0.0, np.pi / 2
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            fits = conflict.excess(turns_of(edges, _raised(edges, forces, conflict.edges, middle))) <= 0
            low, high = (middle, high) if fits else (low, middle)
        if low:  # straight edges fit where any do
            met.append(conflict)
            forces = _raised(edges, forces, conflict.edges, low)
    return forces, met


def _raised(edges: Sequence[Edge], forces: Array, among: Sequence[int], turn: float) -> Array:
    """Raise forces until some edges turn by no more than an angle, and those with one force with them."""
    found = forces.copy()
    for k in among:
        factor = edges[k].given_for(turn) / edges[k].given
        for j, edge in enumerate(edges):
            if edge.group == edges[k].group and edge.is_seam == edges[k].is_seam:
                found[j] = max(found[j], factor * edge.given)
    return found


def conflicts_of(points: Array, edges: Sequence[Edge], held: Numbers, surfaces: Numbers) -> list[Conflict]:
    """Possible conflicts of edges with each other and with held segments, shape (k, 2), of surfaces, shape (k,)."""
    found = []
    for i, edge in enumerate(edges):
        for j in range(i):
            if edges[j].surface == edge.surface:
                found += _of_pair(points, edges, j, i)
        found += _with_held(points, edges, i, held[surfaces == edge.surface])
    return found


def _of_pair(points: Array, edges: Sequence[Edge], i: int, j: int) -> list[Conflict]:
    """Conflicts of two edges: at the corners where they meet, and elsewhere."""
    a, b = edges[i], edges[j]
    common = np.intersect1d(a.ends, b.ends).tolist()
    found = []
    for node in common:
        one, other = _away(a, node), _away(b, node)
        if a.pull @ other > 0 and b.pull @ one > 0:
            found.append(Conflict((i, j), node, None, _corner((i, j), _angle(one, other))))
    if len(common) < 2:
        plane = _plane(points[np.concatenate([edge.ends for edge in edges if edge.surface == a.surface])])
        excess = _crossing(points, edges, (i, j), plane, len(common) > 0)
        if excess(np.zeros(len(edges))) <= 0:  # straight edges do not cross: the plane is a fair view of them
            found.append(Conflict((i, j), None, None, excess))
    return found


def _with_held(points: Array, edges: Sequence[Edge], i: int, held: Numbers) -> list[Conflict]:
    """Conflicts of an edge with held segments: at its ends, and elsewhere."""
    edge, found = edges[i], list[Conflict]()
    if not len(held):
        return found
    touching = np.isin(held, edge.ends)
    for segment, at_end in zip(held[touching.any(axis=1)], touching[touching.any(axis=1)], strict=True):
        node, there = segment[at_end][0], segment[~at_end]
        if len(there) and edge.pull @ (points[there[0]] - points[node]) > 0:
            angle = _angle(_away(edge, node), points[there[0]] - points[node])
            found.append(Conflict((i,), int(node), points[segment].mean(axis=0), _corner((i,), angle)))
    apart = held[~touching.any(axis=1)]
    if len(apart):
        others = np.concatenate([one.ends for one in edges if one.surface == edge.surface])
        plane = _plane(points[np.concatenate([others, held.ravel()])])
        flat = points[apart] @ plane

        def excess(turns: Array) -> float:
            return _met(_arc(points, edge, turns[i]) @ plane, flat[:, 0], flat[:, 1])

        if excess(np.zeros(len(edges))) <= 0:
            found.append(Conflict((i,), None, points[apart].mean(axis=(0, 1)), excess))
    return found


def _corner(among: tuple[int, ...], angle: float) -> Callable[[Array], float]:
    return lambda turns: float(turns[list(among)].sum() - angle)


def _crossing(
    points: Array, edges: Sequence[Edge], pair: tuple[int, int], plane: Array, is_corner: bool
) -> Callable[[Array], float]:
    """Measure of the crossing of two arcs in a plane, away from their common end."""
    a, b = (edges[k] for k in pair)

    def excess(turns: Array) -> float:
        one, other = (_arc(points, edge, turns[k]) @ plane for k, edge in zip(pair, (a, b), strict=True))
        if is_corner:
            one = one[1:] if a.ends[0] in b.ends else one[:-1]
            other = other[1:] if b.ends[0] in a.ends else other[:-1]
        return _met(one, other[:-1], other[1:])

    return excess


def _met(line: Array, starts: Array, ends: Array) -> float:
    """Share of the segments of a line that others cross in a plane, all of shape (..., 2); zero without one."""
    a, b = line[:-1, None], line[1:, None]
    c, d = starts[None], ends[None]
    crossed = (_side(a, b, c) * _side(a, b, d) < 0) & (_side(c, d, a) * _side(c, d, b) < 0)
    return float(crossed.any(axis=1).sum() / len(a))


def _side(a: Array, b: Array, c: Array) -> Array:
    return np.asarray((b - a)[..., 0] * (c - a)[..., 1] - (b - a)[..., 1] * (c - a)[..., 0])


def _arc(points: Array, edge: Edge, turn: float) -> Array:
    """Points of the arc over a chord, on the side to which the membrane pulls, shape (n, 3) [m]."""
    start, along = points[edge.ends[0]], edge.chord
    share = np.linspace(0, 1, SIDES + 1)[:, None]
    if turn <= 0:
        return np.asarray(start + share * along)
    inward = edge.pull / np.linalg.norm(edge.pull) * edge.span
    angle = (2 * share - 1) * turn
    half = 2 * np.sin(turn)
    sag = (np.cos(angle) - np.cos(turn)) / half
    return np.asarray(start + (0.5 + np.sin(angle) / half) * along + sag * inward)


def _plane(points: Array) -> Array:
    """Axes of the plane that fits points best, as columns, shape (3, 2)."""
    return np.asarray(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][:2].T)


def _away(edge: Edge, node: int) -> Array:
    return edge.chord if edge.ends[0] == node else -edge.chord


def _angle(a: Array, b: Array) -> float:
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
