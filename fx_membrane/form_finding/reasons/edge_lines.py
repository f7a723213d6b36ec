"""Edges of membranes with cables, between supports, junctions and corners: chord, pull of the membrane, force."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...geometry.sizes import lengths, normals
from ...geometry.topology import boundary_cells, boundary_edges
from ...model.structure import Structure
from ..constraints.cable_lines import TINY, Line, lines_of

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]

EQUAL_FORCES = 1e-9  # relative difference of forces that counts as rounding


class Edge(NamedTuple):
    """Edge with a cable, between two ends.

    Attributes:
        part: Name of the cable.
        cells: Its cells in the part, shape (k,).
        ends: Its first and last node, shape (2,).
        chord: Vector between them, shape (3,) [m].
        pull: Sum of the forces of the membrane on it, normal to the chord, shape (3,) [N].
        given: Mean force of the cable [N]; its force density where that is given [N/m], the harmonic mean.
        middle: Place on it, shape (3,) [m].
        surface: Number of the surface that it bounds, of membranes joined along seams.
        by_density: True for a cable of given force density.
        is_seam: True between two membranes, whose difference pulls.
        slope: Force over the one given here, which is horizontal where a plan counts [-].
        is_found: True for a cable whose force is found, for a given geometry; `given` is then an ample one.
        group: Number of the edges of a part with one force, which they keep together.
    """

    part: str
    cells: Numbers
    ends: Numbers
    chord: Array
    pull: Array
    given: float
    middle: Array
    surface: int
    by_density: bool = False
    is_seam: bool = False
    slope: float = 1.0
    is_found: bool = False
    group: int = 0

    @property
    def need(self) -> float:
        """Least force of an arc over the chord [N], which is half the pull."""
        return float(np.linalg.norm(self.pull) / 2)

    @property
    def span(self) -> float:
        """Length of the chord [m]."""
        return float(np.linalg.norm(self.chord))

    def turn(self, given: float) -> float:
        """Turn of the arc from its chord at its ends under a force, at most a quarter circle [rad].

        An arc of given force density has that times the length of a segment, which grows with the turn a: half the pull
        is T sin(a), and T is the density times span a / (sin(a) segments).
        """
        if self.by_density:
            return min(np.pi / 2, self.need * len(self.cells) / (self.span * given))
        return float(np.arcsin(min(1.0, self.need / given)))

    def given_for(self, turn: float) -> float:
        """Force, or force density, of an arc of this turn [N or N/m]."""
        return self.need * len(self.cells) / (self.span * turn) if self.by_density else self.need / float(np.sin(turn))

    def shown(self, given: float) -> str:
        """Show a force, or a force density, in a message."""
        return f"{'a force density of ' * self.by_density}{given * self.slope:.4g}"


class Rim(NamedTuple):
    """Boundary of all membranes, without seams.

    Attributes:
        segments: Pairs of nodes, each once, shape (k, 2).
        pulls: Forces of the membranes on them, shape (k, 3) [N].
        surfaces: Number of the surface of each, of membranes joined along seams, shape (k,).
    """

    segments: Numbers
    pulls: Array
    surfaces: Numbers


def rims_of(structure: Structure, points: Array, stresses: Mapping[str, Array]) -> tuple[Rim, Rim]:
    """Boundary of the membranes with these stresses in space, by name, shape (cells, 3, 3) [N/m], and their seams."""
    segments, pulls, owners = [np.zeros((0, 2), dtype=np.int64)], [np.zeros((0, 3))], [np.zeros(0, dtype=np.int64)]
    for number, (name, stress) in enumerate(stresses.items()):
        triangles = structure.parts[name].cells
        edges, cells = boundary_edges(triangles), boundary_cells(triangles)
        outward = np.cross(points[edges[:, 1]] - points[edges[:, 0]], normals(points, triangles)[cells])
        segments.append(edges)
        pulls.append(-np.einsum("kij,kj->ki", stress[cells], outward))
        owners.append(np.full(len(edges), number))
    edges, owner = np.concatenate(segments), np.concatenate(owners)
    _, seam, count = np.unique(keys_of(edges, len(points)), return_inverse=True, return_counts=True)
    seam = seam.ravel()
    ties = sparse.coo_matrix((np.ones(len(seam)), (owner, seam)), shape=(len(stresses), len(count))).tocsr()
    surface = connected_components(ties @ ties.T, directed=False)[1] if len(stresses) else owner
    outer, first = count[seam] == 1, np.unique(seam, return_index=True)[1]
    total = np.zeros((len(count), 3))
    np.add.at(total, seam, np.concatenate(pulls))
    inner = first[count == 2]
    rim = Rim(edges[outer], np.concatenate(pulls)[outer], surface[owner[outer]])
    return rim, Rim(edges[inner], total[count == 2], surface[owner[inner]])


def edges_of(
    structure: Structure,
    points: Array,
    rim: Rim,
    forces: Mapping[str, Array],
    densities: Mapping[str, Array] = MappingProxyType({}),
    told: Mapping[str, Array] = MappingProxyType({}),
    found: Mapping[str, NDArray[np.bool_]] = MappingProxyType({}),
) -> list[Edge]:
    """Edges with cables of these forces, by name, shape (cells,) [N]; none for closed cables.

    Messages tell the forces of `told` instead, of which these are the horizontal parts. A line has a force density
    where its cells have one in `densities`, by name, shape (cells,) [N/m], else its force. Its force is one that is
    found where `found` says so, by name, shape (cells,).
    """
    if not len(rim.segments):
        return []
    loaded = [structure.parts[name].cells[force > 0].ravel() for name, force in forces.items()]
    count = np.bincount(np.concatenate([np.zeros(0, dtype=np.int64), *loaded]), minlength=len(points))
    # A kink of the first mesh is no end: the cable straightens there.
    stops = structure.supported.any(axis=1) | (count != 2)
    keys = keys_of(rim.segments, len(points))
    order = np.argsort(keys)
    keys, edges = keys[order], []
    for name, force in forces.items():
        cells = structure.parts[name].cells
        key = keys_of(cells, len(points))
        number = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
        on_edge = np.flatnonzero((keys[number] == key) & (force > 0))
        for line in lines_of(cells, on_edge, stops) if len(on_edge) else []:
            if not line.is_closed:
                at = order[number[line.cells]]
                density = densities[name][line.cells] if name in densities else np.zeros(1)
                by_density = bool((density > 0).all())
                given = float(1 / np.mean(1 / density) if by_density else force[line.cells].mean())
                edge = _edge(name, line, points, rim.pulls[at], given, rim.surfaces[at[0]])
                slope = 1.0 if by_density or name not in told else float(told[name][line.cells].mean() / given)
                is_found = name in found and bool(found[name][line.cells].any())
                edges.append(edge._replace(by_density=by_density, slope=slope, is_found=is_found))
    return _grouped(edges)


def _grouped(edges: list[Edge]) -> list[Edge]:
    """Give the edges of each part with one force, or one force density, one number."""
    found = list[Edge]()
    for edge in edges:
        mates = (
            other.group
            for other in found
            if (other.part, other.by_density) == (edge.part, edge.by_density)
            and abs(other.given * other.slope / (edge.given * edge.slope) - 1) <= EQUAL_FORCES
        )
        found.append(edge._replace(group=next(mates, len(found))))
    return found


def held_segments(structure: Structure, rim: Rim, edges: list[Edge]) -> tuple[Numbers, Numbers]:
    """Segments of a boundary that are held and have no cable, shape (k, 2), and their surfaces, shape (k,)."""
    count = len(structure.points)
    cables = [keys_of(structure.parts[edge.part].cells[edge.cells], count) for edge in edges]
    taken = np.concatenate([np.zeros(0, dtype=np.int64), *cables])
    free = structure.supported.all(axis=1)[rim.segments].all(axis=1) & ~np.isin(keys_of(rim.segments, count), taken)
    return rim.segments[free], rim.surfaces[free]


def keys_of(segments: Numbers, count: int) -> Numbers:
    """Key of each segment, the same in both senses."""
    return np.asarray(segments.min(axis=1) * count + segments.max(axis=1))


def _edge(name: str, line: Line, points: Array, pulls: Array, given: float, surface: int) -> Edge:
    nodes = line.nodes
    chord = points[nodes[-1]] - points[nodes[0]]
    pull = _flattened(np.diff(points[nodes], axis=0), chord, pulls)
    pull -= (pull @ chord) / (chord @ chord) * chord
    return Edge(name, line.cells, nodes[[0, -1]], chord, pull, given, points[nodes[len(nodes) // 2]], surface)


def _flattened(ways: Array, chord: Array, pulls: Array) -> Array:
    """Sum pulls at the segments of a line, turned about these into one plane: a slope of the membrane takes none away.

    Args:
        ways: The segments, shape (k, 3) [m].
        chord: Vector between the ends of the line, shape (3,) [m].
        pulls: Forces of the membrane on the segments, shape (k, 3) [N].
    """
    along = ways / lengths(ways)[:, None]
    shear = np.sum(pulls * along, axis=1, keepdims=True) * along
    across = pulls - shear
    normal = np.cross(chord, across.sum(axis=0))
    if np.linalg.norm(normal) <= TINY:
        return np.asarray(pulls.sum(axis=0))
    inward = np.cross(normal / np.linalg.norm(normal), along)  # shorter where a segment leaves the plane, as its span
    strength = np.copysign(lengths(across), np.sum(across * inward, axis=1))
    return np.asarray((strength[:, None] * inward + shear).sum(axis=0))
