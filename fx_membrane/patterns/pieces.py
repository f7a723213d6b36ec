"""Strips cut open along their edges: rows of points of their own, and the way around each strip."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks.validation import format_point
from ..geometry.line_order import path_along
from .flat_strips import FlatStrip, Side
from .strips import Strips

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Pieces:
    """All strips side by side, apart from each other.

    Attributes:
        names: Names of the strips, in order.
        nodes: Node of the structure at each point, shape (n,).
        triangles: Cells of all strips as rows of points, counter-clockwise, shape (k, 3).
        strip_of_point: Number of the strip of each point, ascending, shape (n,).
        strip_of_cell: Number of the strip of each cell, ascending, shape (k,).
        border: Segments of all borders as rows of points, in the sense of their cells, shape (m, 2).
        edge: Number of the edge that each of them belongs to, shape (m,).
        segment: Number of the segment of the edge, shape (m,).
    """

    names: tuple[str, ...]
    nodes: Integers
    triangles: Integers
    strip_of_point: Integers
    strip_of_cell: Integers
    border: Integers
    edge: Integers
    segment: Integers

    def points_of(self, strip: int) -> slice:
        """Rows of the points of a strip."""
        return slice(*np.searchsorted(self.strip_of_point, [strip, strip + 1]))

    def cells_of(self, strip: int) -> slice:
        """Rows of the cells of a strip."""
        return slice(*np.searchsorted(self.strip_of_cell, [strip, strip + 1]))

    def seam_pairs(self) -> tuple[Integers, Integers]:
        """Rows of `border` that are sewn together, each shape (pairs,)."""
        order = np.lexsort((self.segment, self.edge))
        here, there = order[:-1], order[1:]
        same = (self.edge[here] == self.edge[there]) & (self.segment[here] == self.segment[there])
        return here[same], there[same]

    def flat_strips(self, strips: Strips, points: Array) -> dict[str, FlatStrip]:
        """Flat strips from the places of all points, shape (n, 2), each centred at zero along the weft."""
        found = {}
        for number, name in enumerate(self.names):
            rows, cells = self.points_of(number), self.cells_of(number)
            corner = points[rows].min(axis=0)
            found[name] = FlatStrip(
                name=name,
                nodes=self.nodes[rows],
                points=points[rows] - corner,
                triangles=self.triangles[cells] - rows.start,
                sides=self._sides(number, strips),
            )
        return found

    def _sides(self, strip: int, strips: Strips) -> tuple[Side, ...]:
        rows = self.points_of(strip)
        mine = np.flatnonzero((self.border[:, 0] >= rows.start) & (self.border[:, 0] < rows.stop))
        around = _around(self.border[mine])
        place = np.empty(rows.stop - rows.start, dtype=np.int64)
        place[self.border[mine, 0] - rows.start] = mine
        border = place[around - rows.start]  # in the order around the strip
        edge, segment = self.edge[border], self.segment[border]
        first = np.array([strips.edges[one].nodes[at] for one, at in zip(edge, segment, strict=True)])
        sense = np.where(self.nodes[self.border[border, 0]] == first, 1, -1)
        counts = np.array([len(strips.edges[one].nodes) - 1 for one in edge])
        onward = np.roll(segment, 1) + sense
        closed = np.array([strips.edges[one].nodes[0] == strips.edges[one].nodes[-1] for one in edge])
        onward = np.where(closed, onward % counts, onward)
        begins = np.flatnonzero((edge != np.roll(edge, 1)) | (sense != np.roll(sense, 1)) | (segment != onward))
        if not len(begins):  # one closed edge
            begins = np.flatnonzero(segment == (0 if sense[0] > 0 else counts[0] - 1))
        ends = np.roll(begins, -1)
        ends[-1] += len(border)
        ring = np.concatenate([around, around, around[:1]]) - rows.start
        return tuple(Side(strips.edges[edge[a]].name, ring[a : b + 1]) for a, b in zip(begins, ends, strict=True))


def pieces_of(strips: Strips) -> Pieces:
    """Cut strips open along all their edges.

    Raises:
        ValueError: A strip is no disc: in several pieces, or with a hole; it branches; a border of it is on no edge.
    """
    names = strips.names
    cells = [strips.membrane(name).cells for name in names]
    strip_of_cell = np.repeat(np.arange(len(names)), [len(some) for some in cells])
    nodes = np.concatenate(cells)
    corners = np.arange(nodes.size).reshape(nodes.shape)
    starts, ends = corners.T.ravel(), corners.T[[1, 2, 0]].ravel()
    owner = np.tile(strip_of_cell, 3)
    pair = _pairs(nodes.ravel()[starts], nodes.ravel()[ends], len(strips.structure.points))
    known, edge, segment = _segments(strips)
    place = np.minimum(np.searchsorted(known, pair), len(known) - 1)
    cut = known[place] == pair
    order = np.lexsort((pair, owner))
    same = (np.diff(pair[order]) == 0) & (np.diff(owner[order]) == 0)
    if (same[1:] & same[:-1]).any():
        at = order[1:-1][same[1:] & same[:-1]][0]
        raise ValueError(f"Strip {names[owner[at]]!r} branches; make each sheet a strip of its own.")
    inner = same & ~cut[order[:-1]]
    first, second = order[:-1][inner], order[1:][inner]
    links = np.concatenate([starts[first], ends[first]]), np.concatenate([ends[second], starts[second]])
    graph = sparse.coo_array((np.ones(len(links[0]), dtype=np.int8), links), shape=(nodes.size,) * 2)
    label = connected_components(graph, directed=False)[1]
    _, corner, row = np.unique(label, return_index=True, return_inverse=True)
    strip_of_point, node_of_point = strip_of_cell[corner // 3], nodes.ravel()[corner]
    order_of_points = np.lexsort((node_of_point, strip_of_point))
    rank = np.empty(len(corner), dtype=np.int64)
    rank[order_of_points] = np.arange(len(corner))
    row = rank[row.ravel()]
    outer = np.ones(len(pair), dtype=bool)
    outer[first] = outer[second] = False
    _check_covered(strips, names, cut | ~outer, owner, nodes.ravel()[starts])
    pieces = Pieces(
        names=names,
        nodes=node_of_point[order_of_points],
        triangles=row.reshape(nodes.shape),
        strip_of_point=strip_of_point[order_of_points],
        strip_of_cell=strip_of_cell,
        border=np.column_stack([row[starts], row[ends]])[outer],
        edge=edge[place][outer],
        segment=segment[place][outer],
    )
    _check_discs(pieces, strips.structure.points)
    return pieces


def _pairs(a: Integers, b: Integers, count: int) -> Integers:
    return np.asarray(np.minimum(a, b) * count + np.maximum(a, b))


def _segments(strips: Strips) -> tuple[Integers, Integers, Integers]:
    """Pairs of nodes of all edges, ascending, and the number of their edge and of the segment of it."""
    count = len(strips.structure.points)
    pair = np.concatenate([_pairs(edge.nodes[:-1], edge.nodes[1:], count) for edge in strips.edges])
    lengths = [len(edge.nodes) - 1 for edge in strips.edges]
    order = np.argsort(pair, kind="stable")
    edge = np.repeat(np.arange(len(lengths)), lengths)
    return pair[order], edge[order], np.concatenate([np.arange(n) for n in lengths])[order]


def _check_covered(
    strips: Strips, names: tuple[str, ...], covered: NDArray[np.bool_], owner: Integers, nodes: Integers
) -> None:
    bare = np.flatnonzero(~covered)
    if len(bare):
        where = format_point(strips.structure.points[nodes[bare[0]]])
        raise ValueError(
            f"Strip {names[owner[bare[0]]]!r} has a border that is on no edge, at {where}; add an Edge along it."
        )


def _check_discs(pieces: Pieces, points: Array) -> None:
    """Refuse strips in several pieces or with holes."""
    n = len(pieces.nodes)
    a, b, c = pieces.triangles.T
    graph = sparse.coo_array((np.ones(2 * len(a), dtype=np.int8), (np.r_[a, b], np.r_[b, c])), shape=(n, n))
    label = connected_components(graph, directed=False)[1]
    for number, name in enumerate(pieces.names):
        rows, cells = pieces.points_of(number), pieces.cells_of(number)
        parts, size = np.unique(label[rows], return_counts=True)
        if len(parts) > 1:
            least = pieces.nodes[rows][label[rows] == parts[size.argmin()]]
            where = format_point(points[least].mean(axis=0))
            raise ValueError(
                f"Strip {name!r} is no disc: it is in {len(parts)} pieces, one around {where}; make each a strip of "
                "its own."
            )
        borders = int(np.count_nonzero((pieces.border[:, 0] >= rows.start) & (pieces.border[:, 0] < rows.stop)))
        edges = (3 * (cells.stop - cells.start) + borders) // 2
        euler = (rows.stop - rows.start) - edges + (cells.stop - cells.start)
        if euler != 1:
            where = format_point(points[pieces.nodes[rows]].mean(axis=0))
            raise ValueError(
                f"Strip {name!r} is no disc: it has {2 - euler} borders in place of one, around {where}; cut it open "
                "by a seam from one border to another."
            )


def _around(border: Integers) -> Integers:
    """Start rows of the segments of one closed border, in order, in their sense."""
    ring = path_along(border)[:-1]
    start = np.flatnonzero(border[:, 0] == ring[0])[0]
    return ring if border[start, 1] == ring[1 % len(ring)] else np.roll(ring[::-1], 1)
