"""Motions that supports and constraints leave to the nodes, as a linear map, with rings and rigid bodies in it.

The nodes of a body are its origin plus its frame times their coordinates in the frame: twelve unknowns, or nine if the
nodes lie in a plane. That is linear, also under supports. Rigid, or round, makes the frame orthogonal: a few quadratic
equations, solved for in `bodies`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...checks import validation
from ...model.structure import Structure
from .kinds import NodeConstraint, RigidBody, Ring, Slide

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

# Ranges: tests/benchmarks/form_finding_constants.py, on rings, rigid bodies, slides: with ROUND, FLAT and AXIS from a
# tenth to ten times forms are the same.
ROUND_DISTANCE = 1e-6  # distance of a node from its circle, over the radius, that counts as none
ZERO_EXTENT = 1e-9  # extent across a plane or a line, over the largest, that counts as none
TOLD_TURN = 45.0  # angle by which a body has turned, above which it is told [degrees]; it changes words, no form
TOLD_GROWTH = 1.5  # radius of a ring over the first one, above which it is told; the same
AXIS = 1e-12  # component of a unit vector, or a stiffness against a motion, that counts as none


@dataclass(frozen=True, eq=False)
class Body:
    """Nodes that move together, x = origin + coordinates frame, with reduced unknowns for origin and frame.

    Attributes:
        nodes: Their numbers, shape (k,).
        coordinates: Coordinates in the frame, with a leading 1 for the origin, shape (k, 1 + r) [-]; the cosine and
            sine of a ring.
        first: Origin and frame at the start, shape (1 + r, 3) [m].
        ways: Motions of origin and frame that supports leave, orthonormal columns, shape (3 (1 + r), p).
        scale: Length of the vectors of the frame, the radius of a ring [m]; None if it is found.
        label: Name in messages.
        is_ring: True for a ring.
    """

    nodes: NDArray[np.int64]
    coordinates: Array
    first: Array
    ways: Array
    scale: float | None
    label: str
    is_ring: bool

    @property
    def radius_given(self) -> bool:
        """True for a ring of given radius."""
        return self.is_ring and self.scale is not None

    @property
    def is_line(self) -> bool:
        """True for a rigid body of nodes on a line, as a mast."""
        return not self.is_ring and len(self.first) == 2

    def unknowns(self, points: Array) -> Array:
        """Reduced unknowns nearest to a shape, shape (p,) [m]."""
        found = np.linalg.lstsq(self.coordinates, points[self.nodes], rcond=None)[0]
        return np.asarray(self.ways.T @ (found - self.first).ravel())

    def _frames(self, points: Array) -> tuple[Array, Array]:
        """Vectors of the frame in a shape and at the start, both of shape (r, 3)."""
        return np.linalg.lstsq(self.coordinates, points[self.nodes], rcond=None)[0][1:], self.first[1:]

    def turned(self, points: Array) -> str:
        """Tell of a body that is far turned from its start, as a mast that falls, in words; empty if it is not."""
        now, then = (np.cross(each[0], each[1]) if len(each) > 1 else each[0] for each in self._frames(points))
        angle = float(np.degrees(np.arctan2(np.linalg.norm(np.cross(now, then)), now @ then)))
        if angle <= TOLD_TURN:
            return ""
        return (
            f"{self.label} has turned by {angle:.0f} degrees from its start: cables of given force do not hold a mast "
            "upright, and a flat start leaves its side open. Hold its head by supports and add mast and stays by "
            "masts_and_stays. Or give supports that guide it, or start it nearer to its place in the form."
        )

    def grown(self, points: Array, has_cable: bool) -> str:
        """Tell of a ring of free radius, with a tight cable or without, that has grown much; empty if it has not."""
        now, then = self._frames(points)
        growth = float(np.linalg.norm(now[0]) / np.linalg.norm(then[0]))
        if not self.is_ring or self.scale is not None or growth <= TOLD_GROWTH:
            return ""
        words = f"{self.label} has grown to {growth:.3g} times its radius at the start"
        if has_cable:
            return f"{words}: its cable balances the membrane at one radius only. Give the radius to hold it nearer."
        return (
            f"{words}, as nothing within it holds it: in further steps it may grow without bound. Give its radius, or "
            "a cable with a force along it."
        )


@dataclass(frozen=True, eq=False)
class Motions:
    """Free motions of the nodes.

    Attributes:
        held: Components held where they are, shape (n, 3): supported, unused, or blocked along an axis.
        reacting: Components on which supports and constraints act, shape (n, 3).
        slides: Nodes that slide along no axis or plane of axes, shape (s,).
        free: Their free directions as columns, padded by zeros, shape (s, 3, 2).
        bodies: Rings and rigid bodies.
        guided: Nodes with a constraint of their own, shape (n,).
    """

    held: Mask
    reacting: Mask
    slides: NDArray[np.int64]
    free: Array
    bodies: tuple[Body, ...]
    guided: Mask

    @property
    def couple(self) -> bool:
        """True if components of nodes depend on each other."""
        return bool(len(self.slides) or self.bodies)

    def turned(self, points: Array) -> str:
        """Tell of a body that is far turned from its start, in words; empty without one."""
        return next(filter(None, (body.turned(points) for body in self.bodies)), "")

    def reactions(self, unbalanced: Array) -> Array:
        """Return forces of supports and constraints from the unbalanced forces at the nodes, shape (n, 3) [N]."""
        found = np.where(self.reacting, unbalanced, 0.0)
        slid = np.einsum("sca,sc->sa", self.free, found[self.slides])
        found[self.slides] -= np.einsum("sca,sa->sc", self.free, slid)
        return found

    def basis(self) -> tuple[sparse.csr_matrix, list[NDArray[np.int64]]]:
        """Free motions as columns, shape (3 n, m), and the columns of each body."""
        n = len(self.held)
        single = ~self.held
        single[self.slides] = False
        for body in self.bodies:
            single[body.nodes] = False
        rows = [np.flatnonzero(single.ravel())]
        columns, values, count = [np.arange(len(rows[0]))], [np.ones(len(rows[0]))], len(rows[0])
        node, way = np.nonzero(self.free.any(axis=1))
        rows.append((3 * self.slides[node][:, None] + np.arange(3)).ravel())
        columns.append(np.repeat(count + np.arange(len(node)), 3))
        values.append(self.free[node, :, way].ravel())
        count += len(node)
        of_bodies = []
        for body in self.bodies:
            block = carried(body.coordinates) @ body.ways
            numbers = count + np.arange(block.shape[1])
            rows.append(np.repeat((3 * body.nodes[:, None] + np.arange(3)).ravel(), len(numbers)))
            columns.append(np.tile(numbers, 3 * len(body.nodes)))
            values.append(block.ravel())
            of_bodies.append(numbers)
            count += len(numbers)
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return sparse.coo_matrix(entries, shape=(3 * n, count)).tocsr(), of_bodies


def motions_of(structure: Structure, constraints: Sequence[NodeConstraint] = ()) -> Motions:
    """Motions that the supports of a structure and constraints of nodes leave.

    Raises:
        ValueError: A node has two constraints, or does not exist; supports leave no motion; a ring is not round.
    """
    held = structure.supported | ~structure.used[:, None]
    reacting, taken = structure.supported, np.zeros(len(held), dtype=bool)
    slides: list[NDArray[np.int64]] = [np.zeros(0, dtype=np.int64)]
    free, bodies = [np.zeros((0, 3, 2))], list[Body]()
    for constraint in constraints:
        nodes, kind = np.asarray(constraint.nodes), type(constraint).__name__
        structure.check_nodes(kind, nodes)
        twice = nodes[taken[nodes]]
        if len(twice):
            where = validation.format_point(structure.points[twice[0]])
            raise ValueError(f"Node {twice[0]} at {where} has two constraints, the second a {kind}; leave out one.")
        taken[nodes] = True
        if isinstance(constraint, Slide):
            ways = _ways(structure, constraint)
            projector = ways @ ways.swapaxes(1, 2)
            blocked = 1 - np.einsum("kii->ki", projector)
            inclined = np.abs(projector * (1 - np.eye(3))).max(axis=(1, 2)) > AXIS
            held[nodes] |= ~inclined[:, None] & (blocked > 0.5)
            reacting[nodes] |= blocked > AXIS
            slides.append(nodes[inclined])
            free.append(ways[inclined])
        else:
            bodies.append(_body(structure, constraint))
            reacting[nodes] = True
    return Motions(held, reacting, np.concatenate(slides), np.concatenate(free), tuple(bodies), taken)


def _ways(structure: Structure, slide: Slide) -> Array:
    """Free directions of sliding nodes under their supports, orthonormal columns padded by zeros, shape (k, 3, 2).

    Raises:
        ValueError: Supports leave none at a node.
    """
    nodes = np.asarray(slide.nodes)
    supported = structure.supported[nodes]
    unit = slide.unit()
    along = unit[:, :, None] * unit[:, None, :]
    blocked = along if slide.normal is not None else np.eye(3) - along
    blocked = blocked + np.eye(3) * supported[:, None, :]
    size, vectors = np.linalg.eigh(blocked)
    ways = vectors * (size <= AXIS)[:, None, :]  # ascending: the free ones first
    stuck = np.flatnonzero(~ways.any(axis=(1, 2)))
    if len(stuck):
        node = nodes[stuck[0]]
        by = "".join(np.array(list("xyz"))[supported[stuck[0]]])
        raise ValueError(
            f"Node {node} at {validation.format_point(structure.points[node])} is to slide, and its support in {by!r} "
            "leaves it no way; take that support, or the Slide, away from it."
        )
    return np.asarray(ways[:, :, :2])


def _body(structure: Structure, constraint: Ring | RigidBody) -> Body:
    """Body of the nodes of a ring or of a rigid body.

    Raises:
        ValueError: The nodes of a ring are not on a circle; supports hold the body.
    """
    nodes, points = np.asarray(constraint.nodes), structure.points[np.asarray(constraint.nodes)]
    label = f"The {type(constraint).__name__} with node {nodes[0]} at {validation.format_point(points[0])}"
    origin = points.mean(axis=0)
    _, extent, axes = np.linalg.svd(points - origin, full_matrices=False)
    if extent[0] == 0:
        raise ValueError(f"{label} has all its nodes at one place; move them apart.")
    if isinstance(constraint, Ring):
        origin, scale = _circle(points, origin, extent, axes, nodes, label)
        axes, radius = axes[:2], constraint.radius
    else:
        scale = radius = float(extent[0] / np.sqrt(len(nodes)))
        axes = axes[extent > ZERO_EXTENT * extent[0]]
    coordinates = np.column_stack([np.ones(len(nodes)), (points - origin) @ axes.T / scale])
    ways = _guided(coordinates, structure.supported[nodes])
    if not ways.shape[1]:
        raise ValueError(f"{label} is held by supports in all its motions; take some of them, or the constraint, away.")
    first = np.vstack([origin, scale * axes])
    return Body(nodes, coordinates, first, ways, radius, label, isinstance(constraint, Ring))


def _circle(
    points: Array, middle: Array, extent: Array, axes: Array, nodes: NDArray[np.int64], label: str
) -> tuple[Array, float]:
    """Centre of the circle through points, shape (3,), and its radius [m].

    Raises:
        ValueError: They are on no circle.
    """
    if extent[1] <= ZERO_EXTENT * extent[0]:
        raise ValueError(f"{label} has its nodes on a line, which is no circle; give nodes around the ring.")
    flat = (points - middle) @ axes[:2].T
    system = np.column_stack([2 * flat, np.ones(len(flat))])  # 2 c x + (r^2 - c^2) = x^2
    centre = np.linalg.lstsq(system, np.sum(flat**2, axis=1), rcond=None)[0]
    radius = float(np.sqrt(centre[2] + centre[:2] @ centre[:2]))
    height = (points - middle) @ axes[2] if len(axes) > 2 else np.zeros(len(points))
    off = np.hypot(np.linalg.norm(flat - centre[:2], axis=1) - radius, height)
    worst = int(off.argmax())
    if off[worst] > ROUND_DISTANCE * radius:
        raise ValueError(
            f"{label} is not round: node {nodes[worst]} at {validation.format_point(points[worst])} is "
            f"{off[worst]:.3g} from the circle of radius {radius:.4g} through its nodes; move the nodes onto a circle."
        )
    return middle + centre[:2] @ axes[:2], radius


def _guided(coordinates: Array, supported: Mask) -> Array:
    """Motions of origin and frame that move no supported component, orthonormal columns, shape (3 (1 + r), p)."""
    count = coordinates.shape[1]
    found = []
    for component in range(3):
        rows = coordinates[supported[:, component]]
        _, size, directions = np.linalg.svd(np.vstack([rows, np.zeros((count, count))]))
        for direction in directions[size <= ZERO_EXTENT * max(size[0], 1.0)]:
            way = np.zeros((count, 3))
            way[:, component] = direction
            found.append(way.ravel())
    return np.array(found).reshape(-1, 3 * count).T


def carried(coordinates: Array) -> Array:
    """Return the derivative of the positions of nodes by origin and frame, shape (3 k, 3 (1 + r))."""
    return np.asarray(np.kron(coordinates, np.eye(3)), dtype=np.float64)
