"""Control of sliding: the mesh stays even within its surface and along its lines, whatever moves across them."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ...geometry.measures import measures, normals
from ...model.structure import Structure
from ..constraints.motions import Motions
from ..shape_change import nodal_normals
from .assembly import assembled
from .guide import MotionGuide
from .mesh_lines import MeshLines
from .triangle_evenness import Evenness, evenness_of

Array = NDArray[np.float64]
Segments = NDArray[np.int64]

NORMAL = 0.05  # component of a direction that supports leave, below which it counts as held
HALVINGS = 8  # of a slide that turns a triangle over
SLIDES = 20  # maximum number of slides to an even mesh
EVEN = 0.02  # motion in a slide over the usual edge, at which a mesh counts as even


class Ways(NamedTuple):
    """Directions of free nodes: across surfaces and lines, and along them, each as columns, sparse (3 n, k)."""

    across: sparse.csc_matrix
    along: sparse.csc_matrix


class MeshControl:
    """Even mesh: equal segments along lines, and triangles as near to equal sides as sliding brings them.

    It is a property of the surface and of the numbering of the cells, not of the first mesh: all starts lead to one
    mesh, and a form is at rest. Inner nodes minimize the sum of the evenness of the triangles, which no size changes:
    cells that grow from a ring stay graded. Triangles without area have none, so that no cell folds.

    Args:
        structure: The first mesh.
        motions: Motions that its supports and constraints leave.
        lines: Its lines.

    Source:
        A. M. Winslow, Numerical solution of the quasilinear Poisson equation in a nonuniform triangle mesh, Journal of
        Computational Physics 1 (1966) 149-172; for its functional cell by cell see `evenness_of`.
    """

    def __init__(self, structure: Structure, motions: Motions, lines: MeshLines) -> None:
        self.structure, self.guide, self.lines = structure, MotionGuide(motions), lines
        n, parts = len(structure.points), structure.parts.values()
        surfaces = [part.cells for part in parts if part.dimension == 2]
        self.triangles = np.concatenate([np.zeros((0, 3), dtype=np.int64), *surfaces])
        rim, other = (sparse.diags(on.astype(float)) for on in (lines.on_rim, lines.on_line & ~lines.on_rim))
        springs = rim @ _springs(n, lines.rim) + other @ _springs(n, lines.segments)
        self._springs = sparse.kron(springs, sparse.eye(3)).tocsr()
        self._inside = np.repeat(~lines.on_line, 3)
        self.rest = np.zeros(3 * n)  # forces that count as none, shape (3 n,)

    def ways(self, points: Array) -> Ways:
        """Directions across and along the surfaces and lines of a shape, in the components that supports leave."""
        normal = nodal_normals(self.structure, points)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        normal = np.divide(normal, length, where=length > 0, out=np.zeros_like(normal))
        tangent, on_line = self.lines.tangents(points), self.lines.on_line
        first = np.where(length > 0, normal, _any_normal(tangent))
        first = first - np.sum(first * tangent, axis=1, keepdims=True) * tangent  # on a line, normal to it
        slide = np.where(on_line[:, None], tangent, _any_normal(first))
        stuck = on_line & ~tangent.any(axis=1)  # ends, corners and inner junctions of lines do not slide
        slide = np.where(stuck[:, None], _any_normal(first), slide)
        triads = np.stack([first, np.cross(slide, first), slide], axis=1)
        across = np.zeros((len(points), 3), dtype=bool)
        across[:, 0] = True
        across[:, 1] = on_line
        across[:, 2] = stuck
        ways = _ways(self.guide.projected(triads), across, self.guide.free)
        return ways._replace(across=sparse.hstack([ways.across, self.guide.of_bodies(points)]).tocsc())

    def forces(self, points: Array) -> Array:
        """Take the derivatives of the evenness of triangles at inner nodes, of segments on lines, shape (3 n,)."""
        slopes = self._total(points, evenness_of(points[self.triangles]))
        return np.where(self._inside, slopes.ravel(), self._springs @ points.ravel())

    def _total(self, points: Array, evenness: Evenness) -> Array:
        total = np.zeros_like(points)
        np.add.at(total, self.triangles, evenness.slopes)
        return total

    def imbalance(self, points: Array, ways: Ways) -> Array:
        """Project the forces on the directions along surfaces and lines, shape (k,)."""
        return np.asarray(ways.along.T @ (self.forces(points) - self.rest))

    def derivatives(self, points: Array, ways: Ways, near: bool) -> sparse.csr_matrix:
        """Take those of the imbalance by the nodes, sparse (k, 3 n): convex, or if near all but the turns of lines."""
        evenness = evenness_of(points[self.triangles])
        if not near:
            return ways.along.T @ self._matrix(points, evenness.convex)
        nodal = nodal_normals(self.structure, points)
        size = np.sum(nodal**2, axis=1)
        pull = np.sum(self._total(points, evenness) * nodal, axis=1)
        share = np.divide(pull, size, where=size > 0, out=np.zeros_like(size))[self.triangles]
        sense = np.sign(np.einsum("cix,cx->ci", nodal[self.triangles], evenness.normal))
        turning = np.einsum("ci,ckx,cy->cixky", share * sense, evenness.gradients, evenness.normal)
        return ways.along.T @ self._matrix(points, evenness.convex + evenness.bent + turning)

    def _matrix(self, points: Array, blocks: Array) -> sparse.csr_matrix:
        inside = sparse.diags(self._inside.astype(float))
        return inside @ assembled(len(points), [(self.triangles, blocks)]) + self._springs

    def evened(self, points: Array) -> Array:
        """Slide the nodes to an even mesh, by steps of Newton where they bring it nearer, else by convex ones."""
        for _ in range(SLIDES):
            ways = self.ways(points)
            if not ways.along.shape[1]:
                return points
            uneven = np.linalg.norm(self.imbalance(points, ways))
            following = self._slid(points, ways, near=True)
            after = np.inf if following is points else np.linalg.norm(self.imbalance(following, self.ways(following)))
            if not after < uneven / 2:
                following = self._slid(points, ways, near=False)
            moved, points = np.abs(following - points).max(), following
            if moved < EVEN * self.mean_edge(points):
                break
        return points

    def _slid(self, points: Array, ways: Ways, near: bool) -> Array:
        """Points after a step along the ways, shortened until no triangle turns over."""
        matrix = self.derivatives(points, ways, near) @ ways.along
        slide = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A").solve(-self.imbalance(points, ways))
        step = (ways.along @ slide).reshape(points.shape)
        for _ in range(HALVINGS):
            if self.keeps_sides(points, points + step):
                return points + step
            step /= 2
        return points

    def mean_edge(self, points: Array) -> float:
        """Mean length of the segments of lines and, by their areas, of the sides of triangles [m]."""
        sizes = [measures(points, self.lines.segments), np.sqrt(2 * measures(points, self.triangles))]
        return float(np.concatenate(sizes).mean())

    def keeps_sides(self, before: Array, after: Array) -> bool:
        """Tell if no triangle turns over."""
        sides = [normals(points, self.triangles) for points in (before, after)]
        return bool((np.sum(sides[0] * sides[1], axis=1) > 0).all())


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


def _springs(n: int, segments: Segments) -> sparse.csr_matrix:
    """Matrix of equal springs, at rest where segments are equally long, sparse (n, n)."""
    a, b = segments.T
    rows, columns = np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a])
    values = np.repeat([1.0, 1.0, -1.0, -1.0], len(segments))
    return sparse.coo_matrix((values, (rows, columns)), shape=(n, n)).tocsr()
