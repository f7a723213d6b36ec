"""Lines of cables between their ends: length, chord, sag and angle at the ends."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components

from ...geometry.sizes import lengths

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

TINY = float(np.finfo(float).tiny)


class Line(NamedTuple):
    """Line of a cable.

    Attributes:
        cells: Its cells in their part, in order along it, shape (m,).
        nodes: Its nodes in that order, shape (m + 1,); of a closed line, the first again at the end.
    """

    cells: Numbers
    nodes: Numbers

    @property
    def is_closed(self) -> bool:
        """True for a line without ends."""
        return bool(self.nodes[0] == self.nodes[-1])

    def length(self, points: Array) -> float:
        """Length in a shape [m]."""
        return float(lengths(np.diff(points[self.nodes], axis=0)).sum())

    def chord(self, points: Array) -> float:
        """Distance of the ends in a shape [m]."""
        return float(np.linalg.norm(points[self.nodes[-1]] - points[self.nodes[0]]))

    def sag(self, points: Array, along: Array | None) -> float:
        """Largest distance of its nodes from the chord, along a direction or normal to the chord [m].

        Along a direction, nodes are compared with the chord at the same share of its extent across it.
        """
        place = points[self.nodes]
        chord, offset = place[-1] - place[0], place - place[0]
        if along is None:
            share = offset @ chord / max(chord @ chord, TINY)
            return float(lengths(offset - share[:, None] * chord).max())
        across = chord - (chord @ along) * along
        share = offset @ across / max(across @ across, TINY)
        return float(np.abs((offset - share[:, None] * chord) @ along).max())

    def angle(self, points: Array) -> float:
        """Larger angle between chord and tangent at an end [rad]; exact for an arc with nodes at any distance."""
        place = points[self.nodes]
        chord = place[-1] - place[0]
        return max(_angle(_end_tangent(place), chord), _angle(_end_tangent(place[::-1]), -chord))


def lines_of(cells: Numbers, chosen: Numbers, stops: NDArray[np.bool_]) -> list[Line]:
    """Lines of chosen cells of a cable.

    Args:
        cells: Cells of the part, shape (cells, 2).
        chosen: Numbers of those that make the lines, shape (k,).
        stops: Nodes at which lines end wherever they are, shape (n,).
    """
    ends = cells[chosen]
    inner = (np.bincount(ends.ravel(), minlength=len(stops)) == 2) & ~stops
    # A node where lines end is a node of its own in each cell: numbered behind those that join two cells.
    own = len(stops) + np.arange(ends.size).reshape(ends.shape)
    label = np.where(inner[ends], ends, own)
    size = len(stops) + ends.size
    links = sparse.coo_matrix((np.ones(len(ends)), label.T), shape=(size, size)).tocsr()
    piece = connected_components(links, directed=False)[1][label[:, 0]]
    order = np.argsort(piece, kind="stable")
    node = np.arange(size)
    node[own] = ends
    groups = np.split(order, np.flatnonzero(np.diff(piece[order])) + 1)
    return [_ordered(chosen[group], label[group], links, node) for group in groups]


def _ordered(cells: Numbers, label: Numbers, links: sparse.csr_matrix, node: Numbers) -> Line:
    """Order the cells of a line along it, from the end with the smaller label; a closed one from any cell."""
    names, count = np.unique(label, return_counts=True)
    if (count == 1).any():
        way = breadth_first_order(links, names[count == 1][-1], directed=False, return_predecessors=False)
    else:  # opened at one cell: the way around without it
        rest = sparse.coo_matrix((np.ones(len(label) - 1), label[1:].T), shape=links.shape).tocsr()
        a = label[0, 0]
        way = breadth_first_order(rest, a, directed=False, return_predecessors=False)
        way = np.append(way, a)
    position = {tuple(sorted(pair)): cell for pair, cell in zip(label.tolist(), cells.tolist(), strict=True)}
    pairs = np.sort(np.stack([way[:-1], way[1:]], axis=1), axis=1).tolist()
    return Line(np.array([position[tuple(pair)] for pair in pairs]), node[way])


def _end_tangent(place: Array) -> Array:
    """Tangent at the first of some points, of the circle through three of them, or of the first segment."""
    first = (place[1] - place[0]) / np.linalg.norm(place[1] - place[0])
    if len(place) < 3:
        return np.asarray(first)
    second, width = place[2] - place[1], np.linalg.norm(place[2] - place[0])
    across = second - (second @ first) * first
    sine = np.linalg.norm(across)
    if sine <= np.finfo(float).eps * np.linalg.norm(second) or width == 0:
        return np.asarray(first)
    # The chord-tangent angle of the first segment is the inscribed angle at the third point over it.
    half = np.arcsin(min(1.0, float(sine / np.linalg.norm(second) * np.linalg.norm(place[1] - place[0]) / width)))
    return np.asarray(np.cos(half) * first - np.sin(half) * across / sine)


def _angle(a: Array, b: Array) -> float:
    """Angle between two vectors [rad], exact for small ones too."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
