"""Triangles that are split along lines, piece by piece, each new one within an old one."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..checks import validation

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Pair = tuple[int, int]

MAX_REPEATS = 6  # times that a stretch is laid anew where its own splits crossed it


def pair(a: int, b: int) -> Pair:
    """Edge between two nodes, the lower number first."""
    return (a, b) if a < b else (b, a)


class SplitMesh:
    """Triangles: facets as given, cells after splits.

    Nodes that a line passes nearer than `snap` times the shortest edge there are taken into it.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        facets: Triangles, shape (k, 3).
        snap: Distance from nodes over the length of edges [-].
    """

    def __init__(self, points: Array, facets: Integers, snap: float) -> None:
        self.snap = snap
        self._places, self._count = points, len(points)
        self.facets = facets
        self.cells: list[list[int]] = facets.tolist()
        self.parent = list(range(len(facets)))
        self.midpoints: dict[Pair, int] = {}
        self.between: dict[int, tuple[int, ...]] = {}  # corners of the edge or cell that a new node was put in
        self._children: dict[int, list[int]] = {}
        self._edges: dict[Pair, list[int]] = defaultdict(list)
        for number, (a, b, c) in enumerate(self.cells):
            for edge in (pair(a, b), pair(b, c), pair(c, a)):
                self._edges[edge].append(number)
        self._facets_at: dict[int, set[int]] = defaultdict(set)
        for number, facet in enumerate(self.cells):
            for node in facet:
                self._facets_at[node].add(number)

    @property
    def points(self) -> Array:
        """Positions of all nodes, shape (n, 3) [m]."""
        return self._places[: self._count]

    def at(self, node: int) -> Array:
        """Position of a node, shape (3,) [m]."""
        return np.asarray(self._places[node])

    def facet_of(self, node: int) -> int:
        """Return a facet that a node is on."""
        return min(self._facets_at[node])

    def has(self, a: int, b: int) -> bool:
        """Return True if an edge joins two nodes."""
        return pair(a, b) in self._edges

    def on_edge(self, a: int, b: int, place: Array) -> int:
        """Node at a place on an edge, split if need be."""
        while True:
            start, end = self.at(a), self.at(b)
            length, run = np.linalg.norm(end - start), np.linalg.norm(place - start)
            if run <= self.snap * length:
                return a
            if length - run <= self.snap * length:
                return b
            middle = self.midpoints.get(pair(a, b))
            if middle is None:
                return self._bisect(a, b, place)
            if run <= np.linalg.norm(self.at(middle) - start):
                b = middle
            else:
                a = middle

    def in_facet(self, facet: int, place: Array) -> int:
        """Node at a place in a facet, put there if need be."""
        cells = self._children.get(facet, [facet])
        corners = np.array([[self.at(node) for node in self.cells[cell]] for cell in cells])
        shares = barycentric(corners, place)
        best = int(shares.min(axis=1).argmax())
        nodes, share = self.cells[cells[best]], shares[best]
        there = np.flatnonzero(share > self.snap)
        if len(there) == 1:
            return nodes[there[0]]
        if len(there) == 2:
            a, b = (nodes[corner] for corner in there)
            share = share[there] / share[there].sum()
            return self.on_edge(a, b, share[0] * self.at(a) + share[1] * self.at(b))
        return self._part(cells[best], share @ corners[best])

    def lay(self, first: int, last: int, depth: int = 0) -> list[int]:
        """Lead a straight line between two nodes of a facet; return the nodes along it, these included.

        Raises:
            ValueError: The nodes have no facet in common.
        """
        if self.has(first, last):
            return [first, last]
        common = self._facets_at[first] & self._facets_at[last]
        if not common or depth > MAX_REPEATS:
            raise ValueError(
                f"a seam cannot be laid from {validation.format_point(self.at(first))} to "
                f"{validation.format_point(self.at(last))}; move it, or mesh the surface more finely there."
            )
        nodes = [first, *self._between(first, last, min(common)), last]
        found = [first]
        for a, b in pairwise(nodes):
            found += self.lay(a, b, depth + 1)[1:]
        return found

    def _between(self, first: int, last: int, facet: int) -> list[int]:
        """Nodes at which a straight line in a facet meets its cells, in order."""
        triangles = np.array([self.cells[cell] for cell in self._children.get(facet, [facet])])
        nodes, local = np.unique(triangles, return_inverse=True)
        local = local.reshape(-1, 3)
        edges = np.unique(np.sort(local[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        a, b, c = self._places[self.facets[facet]]
        start, normal = self.at(first), np.cross(b - a, c - a)
        along = self.at(last) - start
        length = float(np.linalg.norm(along))
        axes = np.stack([along / length, np.cross(normal, along) / np.linalg.norm(normal) / length])
        x, y = axes @ (self._places[nodes] - start).T
        low, high = edges.T
        size = np.hypot(x[low] - x[high], y[low] - y[high])
        least = np.full(len(nodes), np.inf)
        np.minimum.at(least, low, size)
        np.minimum.at(least, high, size)
        ends = np.isin(nodes, (first, last))
        hit = (x > 0) & (x < length) & (np.abs(y) <= self.snap * least) & ~ends
        off = ~(hit | ends)
        crossed = np.flatnonzero((y[low] * y[high] < 0) & off[low] & off[high])
        u, v = low[crossed], high[crossed]
        at = x[u] + y[u] / (y[u] - y[v]) * (x[v] - x[u])
        inside = (at > 0) & (at < length)
        found = [(x[row], nodes[row], nodes[row]) for row in np.flatnonzero(hit)]
        found += list(zip(at[inside], nodes[u[inside]], nodes[v[inside]], strict=True))
        return [
            int(one) if one == other else self._bisect(int(one), int(other), start + run * axes[0])
            for run, one, other in sorted(found)
        ]

    def _bisect(self, a: int, b: int, place: Array) -> int:
        """Split an edge and the cells beside it; return the new node."""
        node, cells = self._added(place, (a, b)), self._edges.pop(pair(a, b))
        self.midpoints[pair(a, b)] = node
        for cell in cells:
            c = next(corner for corner in self.cells[cell] if corner not in (a, b))
            other = self._copied(cell)
            self.cells[other] = [node if corner == a else corner for corner in self.cells[cell]]
            self.cells[cell] = [node if corner == b else corner for corner in self.cells[cell]]
            self._edges[pair(a, node)].append(cell)
            self._edges[pair(node, b)].append(other)
            self._edges[pair(node, c)] += [cell, other]
            beside = self._edges[pair(b, c)]
            beside[beside.index(cell)] = other
            self._facets_at[node].add(self.parent[cell])
        return node

    def _part(self, cell: int, place: Array) -> int:
        """Split a cell into three; return the new node."""
        a, b, c = self.cells[cell]
        node = self._added(place, (a, b, c))
        second, third = self._copied(cell), self._copied(cell)
        self.cells[cell], self.cells[second], self.cells[third] = [a, b, node], [node, b, c], [a, node, c]
        for edge, new in ((pair(b, c), second), (pair(c, a), third)):
            beside = self._edges[edge]
            beside[beside.index(cell)] = new
        for corner, both in ((a, [cell, third]), (b, [cell, second]), (c, [second, third])):
            self._edges[pair(corner, node)] += both
        self._facets_at[node].add(self.parent[cell])
        return node

    def _added(self, place: Array, corners: tuple[int, ...]) -> int:
        node = self._count
        if node == len(self._places):
            self._places = np.concatenate([self._places, np.empty((node + 1, 3))])
        self._places[node] = place
        self._count += 1
        self.between[node] = corners
        return node

    def _copied(self, cell: int) -> int:
        """Add a cell to the facet of another one."""
        facet = self.parent[cell]
        self.cells.append([])
        self.parent.append(facet)
        self._children.setdefault(facet, [facet]).append(len(self.cells) - 1)
        return len(self.cells) - 1


def barycentric(corners: Array, places: Array) -> Array:
    """Shares of the corners of triangles at places in their planes, shapes (k, 3, 3) and (k, 3) or (3,) to (k, 3)."""
    sides = corners[:, 1:] - corners[:, :1]
    matrix = sides @ sides.swapaxes(1, 2)
    right = sides @ (places - corners[:, 0])[:, :, None]
    found = np.linalg.solve(matrix, right)[:, :, 0]
    return np.column_stack([1 - found.sum(axis=1), found])
