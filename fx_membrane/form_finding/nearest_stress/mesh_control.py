"""Control of sliding: the mesh stays even within its surface and along its lines, whatever moves across them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ...geometry.topology import boundary_edges
from ...model.parts import Membrane
from ...model.structure import Structure
from ..reasons.line_tangents import line_tangents
from ..shape_change import nodal_normals

Array = NDArray[np.float64]
Segments = NDArray[np.int64]

NORMAL = 0.05  # component of a direction that supports leave, below which it counts as held


class Ways(NamedTuple):
    """Directions of free nodes: across surfaces and lines, and along them, each as columns, sparse (3 n, k)."""

    across: sparse.csc_matrix
    along: sparse.csc_matrix


class MeshControl:
    """Springs between neighbours, along lines and within surfaces, at rest where the mesh is even.

    A spring has the stiffness one over the usual length of edges at its ends in the first mesh: graded meshes stay
    graded, and one row of long cells is evened out.

    Args:
        structure: The first mesh.
    """

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        n, parts = len(structure.points), structure.parts.values()
        lines = [boundary_edges(part.cells) if part.dimension == 2 else part.cells for part in parts]
        self.segments = np.unique(np.sort(np.concatenate(lines)), axis=0)
        self.on_line = np.zeros(n, dtype=bool)
        self.on_line[self.segments] = True
        inside = sparse.diags((~self.on_line).astype(float))
        line = sparse.diags(self.on_line.astype(float))
        springs = inside @ _springs(structure.points, _edges(structure)) + line @ _springs(
            structure.points, self.segments
        )
        self.springs = sparse.kron(springs, sparse.eye(3)).tocsr()
        self.rest = np.zeros(3 * n)  # forces of the springs where they count as at rest, shape (3 n,)

    def ways(self, points: Array) -> Ways:
        """Directions across and along the surfaces and lines of a shape, in the components that supports leave."""
        normal = nodal_normals(self.structure, points)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, where=length > 0, out=np.zeros_like(normal))
        tangent = line_tangents(points, self.segments)
        first = np.where(length > 0, normal, _any_normal(tangent))
        first = first - np.sum(first * tangent, axis=1, keepdims=True) * tangent  # on a line, normal to it
        slide = np.where(self.on_line[:, None], tangent, _any_normal(first))
        stuck = self.on_line & ~tangent.any(axis=1)  # ends, corners and junctions of lines do not slide
        slide = np.where(stuck[:, None], _any_normal(first), slide)
        triads = np.stack([first, np.cross(slide, first), slide], axis=1)
        across = np.zeros((len(points), 3), dtype=bool)
        across[:, 0] = True
        across[:, 1] = self.on_line
        across[:, 2] = stuck
        return _ways(triads, across, ~self.structure.supported & self.structure.used[:, None])

    def imbalance(self, points: Array, ways: Ways) -> Array:
        """Sum the forces of the springs along the surfaces and lines, shape (k,)."""
        return np.asarray(ways.along.T @ (self.springs @ points.ravel() - self.rest))

    def evened(self, points: Array, times: int = 2) -> Array:
        """Slide the nodes until the springs are at rest, shape (n, 3) [m]."""
        for _ in range(times):
            ways = self.ways(points)
            if not ways.along.shape[1]:
                return points
            matrix = (ways.along.T @ self.springs @ ways.along).tocsc()
            slide = splu(matrix, permc_spec="MMD_AT_PLUS_A").solve(-self.imbalance(points, ways))
            points = points + (ways.along @ slide).reshape(points.shape)
        return points


def _ways(triads: Array, across: NDArray[np.bool_], free: NDArray[np.bool_]) -> Ways:
    """Directions of nodes, made orthonormal within their free components, in the order of the triads."""
    found = np.zeros_like(triads)
    for number in range(3):
        way = np.where(free, triads[:, number], 0.0)
        for before in range(number):
            way = way - np.sum(way * found[:, before], axis=1, keepdims=True) * found[:, before]
        length = np.linalg.norm(way, axis=1, keepdims=True)
        found[:, number] = np.divide(way, length, where=length > NORMAL, out=np.zeros_like(way))
    there = found.any(axis=2)
    return Ways(_columns(found, there & across), _columns(found, there & ~across))


def _columns(ways: Array, chosen: NDArray[np.bool_]) -> sparse.csc_matrix:
    node, number = np.nonzero(chosen)
    rows = (3 * node[:, None] + np.arange(3)).ravel()
    columns = np.repeat(np.arange(len(node)), 3)
    return sparse.coo_matrix((ways[node, number].ravel(), (rows, columns)), shape=(ways.size // 3, len(node))).tocsc()


def _any_normal(vectors: Array) -> Array:
    """Give unit vectors normal to vectors, shape (n, 3) [-]; some unit vector where they are zero."""
    axis = np.eye(3)[np.abs(vectors).argmin(axis=1)]
    size = np.sum(vectors**2, axis=1, keepdims=True)
    share = np.divide(np.sum(axis * vectors, axis=1, keepdims=True), size, where=size > 0, out=np.zeros_like(size))
    normal = axis - share * vectors
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _edges(structure: Structure) -> Segments:
    """List the edges of all cells, each once, shape (edges, 2)."""
    found = []
    for part in structure.parts.values():
        cells = part.cells
        found += [cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]] if isinstance(part, Membrane) else [cells]
    return np.unique(np.sort(np.concatenate(found), axis=1), axis=0)


def _springs(points: Array, edges: Segments) -> sparse.csr_matrix:
    """Matrix of springs, sparse (n, n); the usual length at a node is the median of its edges."""
    n = len(points)
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    node, lengths = edges.T.ravel(), np.tile(length, 2)
    order = np.lexsort((lengths, node))
    count = np.bincount(node, minlength=n)
    middle = np.searchsorted(node[order], np.arange(n)) + np.maximum(count - 1, 0) // 2
    usual = lengths[order][np.minimum(middle, len(lengths) - 1)]
    stiffness = 2 / (usual[edges[:, 0]] + usual[edges[:, 1]])
    a, b = edges.T
    rows, columns = np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a])
    values = np.concatenate([stiffness, stiffness, -stiffness, -stiffness])
    return sparse.coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()
