"""Edge cables too weak for the stress of the membrane that they bound: which, and the force that they need.

A stress n pulls at an edge of span L with n L in all. The ends of its cable turn from the chord by asin(n L / (2 T)).
So a force T below n L / 2 has no form: the radius T / n of the arc is then below half the span. Where two edges meet,
their turns together stay below the angle of their chords, or the cables cross. For a stress that is constant in a plane
both are exact; elsewhere they are a guide.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...checks import validation
from ...geometry.measures import normals
from ...geometry.topology import boundary_cells, boundary_edges
from ...model.structure import Structure
from ..constraints.cable_lines import lines_of
from .line_tangents import line_tangents

Array = NDArray[np.float64]

CORNER = 2  # edges that meet in a corner of a membrane
ENOUGH = 1e6  # factor on forces beyond which no corner is looked for


class Edge(NamedTuple):
    """Edge with a cable, between two ends.

    Attributes:
        part: Name of the cable.
        ends: Its first and last node, shape (2,).
        chord: Vector between them, shape (3,) [m].
        pull: Sum of the forces of the membrane on it, normal to the chord, shape (3,) [N].
        force: Mean force of the cable [N].
        middle: Place on it, shape (3,) [m].
    """

    part: str
    ends: NDArray[np.int64]
    chord: Array
    pull: Array
    force: float
    middle: Array

    @property
    def need(self) -> float:
        """Least force with a form [N], which is half the pull."""
        return float(np.linalg.norm(self.pull) / 2)


def weak_edges(structure: Structure, points: Array, stresses: Mapping[str, Array], forces: Mapping[str, Array]) -> str:
    """Tell of the edge cable that lacks most, in words; empty if none is too weak.

    Args:
        structure: The structure.
        points: Its shape, shape (n, 3) [m].
        stresses: By membrane, stress in space, shape (cells, 3, 3) [N/m].
        forces: By cable, its force, shape (cells,) [N].
    """
    edges = _edges(structure, points, stresses, forces)
    weak = [(edge.need / edge.force, _of_span(edge)) for edge in edges]
    for node in np.unique([edge.ends for edge in edges]):
        meeting = [edge for edge in edges if node in edge.ends]
        if len(meeting) == CORNER:
            weak.append(_of_corner(points, int(node), meeting))
    factor, words = max(weak, default=(0.0, ""))
    return words if factor > 1 else ""


def _edges(
    structure: Structure, points: Array, stresses: Mapping[str, Array], forces: Mapping[str, Array]
) -> list[Edge]:
    """Edges of membranes with cables, each between supports, junctions and corners."""
    segments, pulls = _pulls(structure, points, stresses)
    if not len(segments):
        return []
    stops = structure.supported.any(axis=1) | ~line_tangents(points, segments).any(axis=1)
    keys = _keys(segments, len(points))
    keys, pulls = np.sort(keys), pulls[np.argsort(keys)]
    found = []
    for name, force in forces.items():
        cells = structure.parts[name].cells
        key = _keys(cells, len(points))
        number = np.minimum(np.searchsorted(keys, key), len(keys) - 1)
        on_edge = np.flatnonzero((keys[number] == key) & (force > 0))
        for line in lines_of(cells, on_edge, stops) if len(on_edge) else []:
            if not line.is_closed:
                pull = pulls[number[line.cells]].sum(axis=0)
                found.append(_edge(name, line.nodes, points, pull, float(force[line.cells].mean())))
    return found


def _keys(segments: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """One number for each segment, whichever its sense."""
    return np.asarray(segments.min(axis=1) * count + segments.max(axis=1))


def _edge(name: str, nodes: NDArray[np.int64], points: Array, pull: Array, force: float) -> Edge:
    chord = points[nodes[-1]] - points[nodes[0]]
    across = pull - (pull @ chord) / (chord @ chord) * chord
    return Edge(name, nodes[[0, -1]], chord, across, force, points[nodes[len(nodes) // 2]])


def _pulls(structure: Structure, points: Array, stresses: Mapping[str, Array]) -> tuple[NDArray[np.int64], Array]:
    """Edges of one membrane each, shape (k, 2), and the force of the membrane on each, shape (k, 3) [N]."""
    segments, pulls = [np.zeros((0, 2), dtype=np.int64)], [np.zeros((0, 3))]
    for name, stress in stresses.items():
        triangles = structure.parts[name].cells
        edges, cells = boundary_edges(triangles), boundary_cells(triangles)
        outward = np.cross(points[edges[:, 1]] - points[edges[:, 0]], normals(points, triangles)[cells])
        segments.append(edges)
        pulls.append(-np.einsum("kij,kj->ki", stress[cells], outward))
    edges = np.concatenate(segments)
    _, number, count = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True, return_counts=True)
    outer = count[number.ravel()] == 1
    return edges[outer], np.concatenate(pulls)[outer]


def _of_span(edge: Edge) -> str:
    span = float(np.linalg.norm(edge.chord))
    return (
        f"Some edge cables are too weak: that of part {edge.part!r} around {validation.format_point(edge.middle)} has "
        f"{edge.force:.4g} over a span of {span:.4g}; the stress of {2 * edge.need / span:.4g} there needs more than "
        f"{edge.need:.4g}, stress times half the span"
    )


def _of_corner(points: Array, node: int, meeting: Sequence[Edge]) -> tuple[float, str]:
    """Factor by which two edges that meet lack force, and that in words; zero where the corner points inwards."""
    away = [edge.chord if edge.ends[0] == node else -edge.chord for edge in meeting]
    a, b = (vector / np.linalg.norm(vector) for vector in away)
    if meeting[0].pull @ b <= 0 or meeting[1].pull @ a <= 0:
        return 0.0, ""
    angle = float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))
    sines = np.array([edge.need / edge.force for edge in meeting])

    def excess(factor: float) -> float:
        return float(np.arcsin(np.minimum(sines / factor, 1.0)).sum()) - angle

    least = float(sines.max())
    factor = least if excess(least) <= 0 else brentq(excess, least, ENOUGH * least)
    names = " and ".join(dict.fromkeys(repr(edge.part) for edge in meeting))
    now, then = (" and ".join(f"{edge.force * k:.4g}" for edge in meeting) for k in (1.0, factor))
    spans = " and ".join(f"{np.linalg.norm(edge.chord):.4g}" for edge in meeting)
    return factor, (
        f"Some edge cables are too weak: those of part {names} that meet at node {node}, "
        f"{validation.format_point(points[node])}, have {now} over spans of {spans}, and would cross there as arcs of "
        f"radius force over stress; they need more than {then}"
    )
