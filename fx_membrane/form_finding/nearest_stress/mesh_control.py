"""Control of sliding: the mesh stays even within its surface and along its lines, whatever moves across them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from ...geometry.sizes import measures, normals
from ...geometry.vector_columns import columns, dot
from ...model.structure import Structure
from ..constraints.motions import Motions
from ..shape_change import nodal_normals
from .assembly import Pattern
from .guide import BodyWays, MotionGuide
from .lines_of_mesh import MeshLines
from .triangle_evenness import evenness_of, triangles_of

Array = NDArray[np.float64]
Segments = NDArray[np.int64]

# Half and double of each were tried on a cone, a roof under snow and one with sags: forms move by less than 1e-8 of
# their size.
NORMAL = 0.05  # component of a direction that supports leave, below which it counts as held
HALVINGS = 8  # of a slide that turns a triangle over
SLIDES = 20  # maximum number of slides to an even mesh
EVEN_MOTION = 0.02  # motion in a slide over the usual edge, at which a mesh counts as even


class Ways(NamedTuple):
    """Directions of free nodes: across surfaces and lines, and along them, each as columns, sparse (3 n, k).

    The last columns of each are those of bodies, combinations of all their motions.
    """

    across: sparse.csc_matrix
    along: sparse.csc_matrix
    bodies: BodyWays


class _Slope(NamedTuple):
    """Shape, its ways, and the imbalance of its mesh along them."""

    points: Array
    ways: Ways
    imbalance: Array


class MeshControl:
    """Even mesh: equal segments along lines, and triangles as near to equal sides as sliding brings them.

    A body that slides along its own line, as a ring that spins, leaves the shape as it is: its triangles rule it, too.

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
        n, surfaces = len(structure.points), [part.cells for part in structure.membranes.values()]
        self.triangles = np.concatenate([np.zeros((0, 3), dtype=np.int64), *surfaces])
        rim, other = (sparse.diags(on.astype(float)) for on in (lines.on_rim, lines.on_line & ~lines.on_rim))
        springs = rim @ _springs(n, lines.rim) + other @ _springs(n, lines.segments)
        self._springs = sparse.kron(springs, sparse.eye(3)).tocsr()
        inside = ~lines.on_line
        for body in motions.bodies:
            inside[body.nodes] = True
        self._inside = np.repeat(inside, 3)
        self._pattern = Pattern(n, self.triangles)
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
        single = _ways(self.guide.projected(triads), across, self.guide.free)
        if not self.guide.motions.bodies:
            return Ways(*single, self.guide.split(points, self.lines.segments))
        split, moves = self.guide.split(points, self.lines.segments), self.guide.of_bodies(points)
        of_bodies = moves @ split.across, moves @ split.along
        both = [sparse.hstack(pair).tocsc() for pair in zip(single, of_bodies, strict=True)]
        return Ways(both[0], both[1], split)

    def forces(self, points: Array) -> Array:
        """Gradient of the evenness, of triangles at inner nodes and of segments on lines, shape (3 n,)."""
        slopes = self._total(triangles_of(self._corners(points)).slopes())
        return np.where(self._inside, slopes.ravel(), self._springs @ points.ravel())

    def _corners(self, points: Array) -> Array:
        """Corners of the triangles, shape (3, 3, cells) [m]."""
        return columns(points[self.triangles])

    def _total(self, slopes: Array) -> Array:
        """Sum slopes of the triangles at the nodes, shape (n, 3)."""
        nodes, n = self.triangles.T.ravel(), len(self.structure.points)
        return np.stack([np.bincount(nodes, slopes[:, way].ravel(), n) for way in range(3)], axis=1)

    def imbalance(self, points: Array, ways: Ways) -> Array:
        """Project the forces on the directions along surfaces and lines, shape (k,)."""
        return np.asarray(ways.along.T @ (self.forces(points) - self.rest))

    def derivatives(self, points: Array, ways: Ways, near: bool) -> sparse.csr_matrix:
        """Jacobian of the imbalance, sparse (k, 3 n): convex, or if near exact but for the turns of lines."""
        evenness = evenness_of(self._corners(points))
        if not near:
            return (ways.along.T @ self._matrix(evenness.convex)).tocsr()
        nodal = nodal_normals(self.structure, points)
        size = np.sum(nodal**2, axis=1)
        pull = np.sum(self._total(evenness.slopes) * nodal, axis=1)
        share = np.divide(pull, size, where=size > 0, out=np.zeros_like(size))[self.triangles].T
        sense = np.sign(np.stack([dot(nodal[corner].T, evenness.normal) for corner in self.triangles.T]))
        gradients = (share * sense)[:, None, None] * evenness.gradients  # (nodes, nodes, 3, cells)
        turning = gradients.swapaxes(1, 2)[:, :, :, None] * evenness.normal
        found = ways.along.T @ self._matrix(evenness.convex + evenness.bent + turning)
        if ways.bodies.along.shape[1]:
            turned = self.guide.turning(points, (self.forces(points) - self.rest).reshape(-1, 3))
            rows = ways.bodies.along.T @ turned @ self.guide.of_bodies(points).T
            none = sparse.csr_matrix((found.shape[0] - rows.shape[0], rows.shape[1]))
            found = found + sparse.vstack([none, rows])
        return found.tocsr()

    def _matrix(self, blocks: Array) -> sparse.csr_matrix:
        inside = self._inside[::3][self.triangles]
        rows = np.moveaxis(blocks, -1, 0) * inside[:, :, None, None, None]
        return self._pattern.summed(rows) + self._springs

    def evened(self, points: Array) -> Array:
        """Slide the nodes to an even mesh, by steps of Newton where they bring it nearer, else by convex ones."""
        at = self._slope(points)
        for _ in range(SLIDES):
            if not at.ways.along.shape[1]:
                return points
            following = self._slid(at, near=True)
            after = at if following is at.points else self._slope(following)
            if not np.linalg.norm(after.imbalance) < np.linalg.norm(at.imbalance) / 2:
                following = self._slid(at, near=False)
                after = self._slope(following)
            moved, at = np.abs(following - at.points).max(), after
            if moved < EVEN_MOTION * self.mean_edge(at.points):
                break
        return at.points

    def _slope(self, points: Array) -> _Slope:
        ways = self.ways(points)
        return _Slope(points, ways, self.imbalance(points, ways))

    def _slid(self, at: _Slope, near: bool) -> Array:
        """Points after a step along the ways, shortened until no triangle turns over."""
        points, ways, imbalance = at
        matrix = self.derivatives(points, ways, near) @ ways.along
        slide = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A").solve(-imbalance)
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


def _ways(
    triads: Array, across: NDArray[np.bool_], free: NDArray[np.bool_]
) -> tuple[sparse.csc_matrix, sparse.csc_matrix]:
    """Directions across and along, made orthonormal within their free components, in the order of the triads."""
    found = np.zeros_like(triads)
    for number in range(3):
        way = np.where(free, triads[:, number], 0.0)
        for before in range(number):
            way = way - np.sum(way * found[:, before], axis=1, keepdims=True) * found[:, before]
        length = np.linalg.norm(way, axis=1, keepdims=True)
        found[:, number] = np.divide(way, length, where=length > NORMAL, out=np.zeros_like(way))
    there = found.any(axis=2)
    return _columns(found, there & across), _columns(found, there & ~across)


def _columns(ways: Array, chosen: NDArray[np.bool_]) -> sparse.csc_matrix:
    node, number = np.nonzero(chosen)
    rows = (3 * node[:, None] + np.arange(3)).ravel()
    starts = 3 * np.arange(len(node) + 1)
    return sparse.csc_matrix((ways[node, number].ravel(), rows, starts), shape=(ways.size // 3, len(node)))


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
