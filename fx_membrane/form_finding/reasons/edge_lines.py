"""Edges of membranes with cables, between supports, junctions and corners: chord, pull of the membrane, force."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...geometry.measures import lengths, normals
from ...geometry.topology import boundary_cells, boundary_edges
from ...model.structure import Structure
from ..constraints.cable_lines import TINY, Line, lines_of

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


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

    @property
    def need(self) -> float:
        """Least force of an arc over the chord [N], which is half the pull."""
        return float(np.linalg.norm(self.pull) / 2)

    @property
    def span(self) -> float:
        """Length of the chord [m]."""
        return float(np.linalg.norm(self.chord))

    @property
    def turn(self) -> float:
        """Turn of the ends of the arc from its chord, a quarter of a circle at most [rad].

        The force of an arc of given force density is that density times the length of a segment, which grows with the
        turn a: half the pull is T sin(a), and T is the density times span a / (sin(a) segments).
        """
        if self.by_density:
            return min(np.pi / 2, self.need * len(self.cells) / (self.span * self.given))
        return float(np.arcsin(min(1.0, self.need / self.given)))

    def given_for(self, turn: float) -> float:
        """Force, or force density, of an arc of this turn [N or N/m]."""
        return self.need * len(self.cells) / (self.span * turn) if self.by_density else self.need / float(np.sin(turn))

    def shown(self, given: float) -> str:
        """Show a force, or a force density, in a message."""
        return f"{'a force density of ' * self.by_density}{given:.4g}"


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


def rim_of(structure: Structure, points: Array, stresses: Mapping[str, Array]) -> Rim:
    """Boundary of the membranes with these stresses in space, by name, shape (cells, 3, 3) [N/m]."""
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
    outer = count[seam] == 1
    return Rim(edges[outer], np.concatenate(pulls)[outer], surface[owner[outer]])


def edges_of(
    structure: Structure,
    points: Array,
    rim: Rim,
    forces: Mapping[str, Array],
    densities: Mapping[str, Array] = MappingProxyType({}),
) -> list[Edge]:
    """Edges with cables of these forces, by name, shape (cells,) [N]; none for closed cables.

    A line has a force density where its cells have one in `densities`, by name, shape (cells,) [N/m], else its force.
    """
    if not len(rim.segments):
        return []
    loaded = [structure.parts[name].cells[force > 0].ravel() for name, force in forces.items()]
    count = np.bincount(np.concatenate([np.zeros(0, dtype=np.int64), *loaded]), minlength=len(points))
    # A kink of the first mesh is no end: the cable straightens there.
    stops = structure.supported.any(axis=1) | (count != 2)
    keys = keys_of(rim.segments, len(points))
    order = np.argsort(keys)
    keys, found = keys[order], []
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
                found.append(edge._replace(by_density=by_density))
    return found


def held_segments(structure: Structure, rim: Rim, edges: list[Edge]) -> tuple[Numbers, Numbers]:
    """Segments of a boundary that are held and have no cable, shape (k, 2), and their surfaces, shape (k,)."""
    count = len(structure.points)
    cables = [keys_of(structure.parts[edge.part].cells[edge.cells], count) for edge in edges]
    taken = np.concatenate([np.zeros(0, dtype=np.int64), *cables])
    free = structure.supported.all(axis=1)[rim.segments].all(axis=1) & ~np.isin(keys_of(rim.segments, count), taken)
    return rim.segments[free], rim.surfaces[free]


def keys_of(segments: Numbers, count: int) -> Numbers:
    """One number for each segment, whichever its sense."""
    return np.asarray(segments.min(axis=1) * count + segments.max(axis=1))


def _edge(name: str, line: Line, points: Array, pulls: Array, given: float, surface: int) -> Edge:
    nodes = line.nodes
    chord = points[nodes[-1]] - points[nodes[0]]
    pull = pulls.sum(axis=0)
    pull -= (pull @ chord) / (chord @ chord) * chord
    # Cells of a first mesh that stand out of its surface, at held nodes, would count more than their span.
    most = lengths(pulls).sum() / line.length(points) * np.linalg.norm(chord)
    pull *= min(1.0, most / max(float(np.linalg.norm(pull)), TINY))
    return Edge(name, line.cells, nodes[[0, -1]], chord, pull, given, points[nodes[len(nodes) // 2]], surface)
