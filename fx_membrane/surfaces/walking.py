"""Ways over triangles: straight ones, across edges and through nodes, and those along a field of directions."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import measures, normals
from ..geometry.topology import branching_edge
from .shapes import Surface

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CORNER = 1e-11  # share of a corner that is rounding
PARALLEL_RATE = 1e-12  # rate of a share, relative to the largest, that is rounding
ANGLE = 1e-9  # angle that is rounding [rad]

Direction = Callable[[int, Array, Array], Array]


class Way(NamedTuple):
    """Places along a way, shape (k, 3), and the cell between each two of them, shape (k - 1,)."""

    points: Array
    cells: Integers


class Terrain:
    """Triangles, with their neighbours and gradients of the shares of their corners.

    Args:
        surface: The surface.
        cut: Take edges at which it branches for rims instead of refusing it. Allow cells without area, whose normals
            are not finite.

    Raises:
        ValueError: It branches.
    """

    def __init__(self, surface: Surface, cut: bool = False) -> None:
        self.points, self.triangles = surface
        branch = None if cut else branching_edge(self.triangles)
        if branch is not None:
            where = validation.format_point(self.points[branch].mean(axis=0))
            raise ValueError(f"The surface branches at {where}, where a line has no one way; name one part, part=...")
        self.beside = _neighbours(self.triangles)
        corners = self.points[self.triangles]
        opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        with np.errstate(invalid="ignore" if cut else "warn", divide="ignore" if cut else "warn"):
            normal = normals(self.points, self.triangles)
            area = measures(self.points, self.triangles)
            self.gradients = np.cross(normal[:, None, :], opposite) / (2 * area)[:, None, None]
        self.normals = normal
        order = np.argsort(self.triangles.ravel(), kind="stable")
        self._around = np.split(order // 3, np.cumsum(np.bincount(self.triangles.ravel(), minlength=len(self.points))))

    @property
    def sound(self) -> NDArray[np.bool_]:
        """Cells with an area, shape (cells,)."""
        return np.asarray(np.isfinite(self.gradients).all(axis=(1, 2)))

    def around(self, node: int) -> Integers:
        """Cells around a node."""
        return self._around[node]

    def place(self, cell: int, shares: Array) -> Array:
        """Position of a point of a cell, shape (3,)."""
        return np.asarray(shares @ self.points[self.triangles[cell]])

    def places(self, cells: Integers, shares: Array) -> Array:
        """Positions of points of cells, shape (k, 3)."""
        return np.asarray(np.einsum("kc,kci->ki", shares, self.points[self.triangles[cells]]))

    def cells_at(self, cell: int, shares: Array) -> list[tuple[int, Array]]:
        """Cells that a point belongs to, each with its shares: several on edges and at nodes."""
        there = np.flatnonzero(shares > CORNER)
        if len(there) == 3:
            return [(cell, shares)]
        nodes = self.triangles[cell, there]
        cells = self.around(int(nodes[0]))
        cells = cells[(self.triangles[cells][:, :, None] == nodes).any(axis=1).all(axis=1)]
        found = []
        for other in cells.tolist():
            mine = np.zeros(3)
            for node, share in zip(nodes, shares[there], strict=True):
                mine[self.triangles[other] == node] = share
            found.append((other, mine / mine.sum()))
        return found

    def cell_towards(self, cell: int, shares: Array, vector: Array) -> tuple[int, Array, Array] | None:
        """Cell into which a vector leads from a point, shares in it, and unit vector in its plane; None off the rim."""
        best, most = None, 0.0
        for other, mine in self.cells_at(cell, shares):
            flat = vector - (vector @ self.normals[other]) * self.normals[other]
            length = float(np.linalg.norm(flat))
            if length <= most * (1 + 1e-9) or length < 1e-9 * np.linalg.norm(vector):
                continue
            rate = self.gradients[other] @ flat
            if (rate[mine <= CORNER] >= -1e-9 * np.abs(rate).max()).all():
                best, most = (other, mine, flat / length), length
        return best

    def fan(self, node: int, cell: int) -> tuple[list[int], list[int], bool]:
        """Cells around a node in order, the nodes at their edges, one more, and True if they close; from a cell on."""
        cells, rim = [cell], []
        first, last = _others(self.triangles[cell], node)
        rim = [first, last]
        while True:
            following = self._across(cells[-1], node, rim[-1])
            if following < 0:
                break
            if following == cell:
                return cells, rim, True
            cells.append(following)
            rim.append(sum(self.triangles[following].tolist()) - node - rim[-1])
        while (before := self._across(cells[0], node, rim[0])) >= 0:
            cells.insert(0, before)
            rim.insert(0, sum(self.triangles[before].tolist()) - node - rim[0])
        return cells, rim, False

    def _across(self, cell: int, a: int, b: int) -> int:
        """Cell across the edge between two nodes of a cell, or -1."""
        corner = np.flatnonzero((self.triangles[cell] != a) & (self.triangles[cell] != b))[0]
        return int(self.beside[cell, corner])


def _others(triangle: Integers, node: int) -> tuple[int, int]:
    a, b, c = triangle.tolist()
    return {a: (b, c), b: (c, a), c: (a, b)}[node]


def _neighbours(triangles: Integers) -> Integers:
    """Cell across the edge opposite to each corner, or -1, shape (cells, 3)."""
    edges = np.sort(np.concatenate([triangles[:, [1, 2]], triangles[:, [2, 0]], triangles[:, [0, 1]]]), axis=1)
    order = np.lexsort(edges.T)
    same = (edges[order[1:]] == edges[order[:-1]]).all(axis=1)
    more = same[1:] & same[:-1]  # three cells and more at an edge
    same[1:] &= ~more
    same[:-1] &= ~more
    beside = np.full(3 * len(triangles), -1)
    a, b = order[:-1][same], order[1:][same]
    beside[a], beside[b] = b % len(triangles), a % len(triangles)
    return beside.reshape(3, -1).T.copy()


def walk(
    terrain: Terrain, cell: int, shares: Array, direction: Array, length: float, field: Direction | None = None
) -> Way | None:
    """Walk from a point until the rim, or to a length; None where the way does not end.

    Without a field the way is straight: across an edge as in the unfolded cells, through a node with equal angles on
    both sides.

    Args:
        terrain: The surface.
        cell: Cell of the point, into which the direction leads.
        shares: Shares of its corners, shape (3,).
        direction: Unit vector in the plane of the cell, shape (3,).
        length: Length after which the way ends [m]; infinite for none.
        field: Function of a cell, shares and a direction that gives the next direction, a unit vector in its plane.

    Source:
        K. Polthier, M. Schmies, Straightest geodesics on polyhedral surfaces, in: Mathematical Visualization, Springer
        (1998) 135-150.
    """
    points, cells, left = [terrain.place(cell, shares)], [], length
    for _ in range(20 * len(terrain.triangles) + 100):
        step, run = _step(terrain, cell, shares, direction)
        if field is not None:
            middle = (shares + step) / 2
            direction = field(cell, middle, direction)
            step, run = _step(terrain, cell, shares, direction)
        if run >= left:
            points.append(points[-1] + left * direction)
            cells.append(cell)
            return Way(np.array(points), np.array(cells))
        if run > 0:
            points.append(terrain.place(cell, step))
            cells.append(cell)
            left -= run
        onward = _onward(terrain, cell, step, direction, field)
        if onward is None:
            return Way(np.array(points), np.array(cells, dtype=np.int64))
        cell, shares, direction = onward
    return None


def _step(terrain: Terrain, cell: int, shares: Array, direction: Array) -> tuple[Array, float]:
    """Shares where a direction leaves a cell, and the length until there."""
    rate = terrain.gradients[cell] @ direction
    falling = rate < -PARALLEL_RATE * np.abs(rate).max()
    time = np.where(falling, np.divide(shares, -rate, where=falling, out=np.full(3, np.inf)), np.inf)
    run = max(float(time.min()), 0.0)
    step = shares + run * rate
    step[time.argmin()] = 0.0
    step[step < CORNER] = 0.0
    return step / step.sum(), run


def _onward(
    terrain: Terrain, cell: int, shares: Array, direction: Array, field: Direction | None
) -> tuple[int, Array, Array] | None:
    """Next cell, shares in it, and direction there; None at the rim."""
    gone = np.flatnonzero(shares == 0)
    if len(gone) == 2:
        node = int(terrain.triangles[cell, shares.argmax()])
        if field is None:
            return _through_node(terrain, cell, node, direction)
        return terrain.cell_towards(cell, shares, field(cell, shares, direction))
    across = int(terrain.beside[cell, gone[0]])
    if across < 0:
        return None
    corners, others = terrain.triangles[cell], terrain.triangles[across]
    apex = int(np.flatnonzero(~np.isin(others, corners))[0])
    mine = np.zeros(3)
    for corner in np.flatnonzero(shares > 0):
        mine[others == corners[corner]] = shares[corner]
    a, b = (corner for corner in corners[np.arange(3) != gone[0]])
    edge = terrain.points[b] - terrain.points[a]
    edge = edge / np.linalg.norm(edge)
    along, inward = direction @ edge, terrain.gradients[across, apex]
    straight = along * edge + np.sqrt(max(1 - along**2, 0.0)) * inward / np.linalg.norm(inward)
    if field is not None:
        turned = field(across, mine, straight)
        straight = turned if turned @ inward > 0 else straight  # else the field leads back over the edge
    return across, mine, straight


def _through_node(terrain: Terrain, cell: int, node: int, direction: Array) -> tuple[int, Array, Array] | None:
    """Straight way on through a node: half of the angle around it is on either side; None at the rim."""
    cells, rim, closed = terrain.fan(node, cell)
    rays = terrain.points[rim] - terrain.points[node]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    angles = np.arctan2(np.linalg.norm(np.cross(rays[:-1], rays[1:]), axis=1), np.sum(rays[:-1] * rays[1:], axis=1))
    at = np.append(0.0, np.cumsum(angles))
    here = cells.index(cell)
    back = np.arctan2(np.linalg.norm(np.cross(rays[here], direction)), -rays[here] @ direction) + at[here]
    if closed:
        out = (back + at[-1] / 2) % at[-1]
    else:
        ways = [way for way in (back - np.pi, back + np.pi) if -ANGLE <= way <= at[-1] + ANGLE]
        if len(ways) != 1:
            return None
        out = float(np.clip(ways[0], 0, at[-1]))
    number = min(int(np.searchsorted(at, out, side="right")) - 1, len(cells) - 1)
    across = rays[number + 1] - (rays[number + 1] @ rays[number]) * rays[number]
    turn = out - at[number]
    onward = np.cos(turn) * rays[number] + np.sin(turn) * across / np.linalg.norm(across)
    return cells[number], (terrain.triangles[cells[number]] == node).astype(np.float64), onward
