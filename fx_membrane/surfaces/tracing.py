"""Many lines over triangles at once: straight ones, and those along a principal axis of tensors.

All lines advance together, cell by cell: each step is a few operations on arrays. A line along a field is straight in
each cell, along the field half way through it (the midpoint rule).
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures
from .walking import CORNER, PARALLEL_RATE, Terrain

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Truths = NDArray[np.bool_]

NODE_DISTANCE = 1e-9  # share of a corner by which lines pass beside a node
CLOSED = 0.03  # distance from its start, over that within which it ends, at which a line closes
TURN_COSINE = 0.5  # cosine of the angle of a turn within one cell that no smooth field has


class Field(NamedTuple):
    """Tensors in the planes of cells, of which lines follow one principal axis.

    Attributes:
        axes: Two unit vectors in the plane of each cell, shape (cells, 2, 3).
        corners: Components 11, 22 and 12 at the corners of each cell, shape (cells, 3, 3).
        second: True for lines across the axis of the largest principal value.
    """

    axes: Array
    corners: Array
    second: bool

    def direction(self, cells: Integers, shares: Array, before: Array) -> Array:
        """Directions at points, in the sense nearest to those before, shape (k, 3)."""
        a, b, c = np.einsum("kc,kcm->mk", shares, self.corners[cells])
        angle = np.arctan2(2 * c, a - b) / 2 + (np.pi / 2 if self.second else 0.0)
        found = np.cos(angle)[:, None] * self.axes[cells, 0] + np.sin(angle)[:, None] * self.axes[cells, 1]
        sense = np.where(np.einsum("ki,ki->k", found, before) < 0, -1.0, 1.0)
        return np.asarray(sense[:, None] * found)


class Track(NamedTuple):
    """A line: places, shape (k, 3), the cell between each two of them, shape (k - 1,), and True if it closes."""

    points: Array
    cells: Integers
    closed: bool


class Ends(NamedTuple):
    """Ends of lines: cells, shape (k,), shares (k, 3), directions (k, 3), and lengths (k,) [m]."""

    cells: Integers
    shares: Array
    directions: Array
    lengths: Array


def field_of(
    terrain: Terrain, tensors: Array, allowed: Truths, second: bool = False, sheets: Integers | None = None
) -> Field:
    """Field between means of tensors at the nodes, each over the allowed cells of a sheet around it.

    Args:
        terrain: The surface.
        tensors: Tensors of the cells, shape (cells, 3, 3).
        allowed: Cells of the field, shape (cells,).
        second: True for lines across the axis of the largest principal value.
        sheets: Number of the sheet of each cell, shape (cells,); None for one sheet.
    """
    triangles = terrain.triangles[allowed]
    apart = 0 if sheets is None else len(terrain.points) * sheets[allowed, None]
    corners = np.unique(triangles + apart, return_inverse=True)[1].ravel()
    area = np.repeat(measures(terrain.points, triangles), 3)
    weighted = area[:, None] * np.repeat(tensors[allowed].reshape(-1, 9), 3, axis=0)
    sums = np.stack([np.bincount(corners, entry) for entry in weighted.T], axis=1)
    at_corners: Array = np.zeros((len(tensors), 3, 3, 3))
    at_corners[allowed] = (sums / np.bincount(corners, area)[:, None])[corners].reshape(-1, 3, 3, 3)
    axes = plane_axes(terrain)
    pairs = ((0, 0), (1, 1), (0, 1))
    components = [np.einsum("ki,kcij,kj->kc", axes[:, a], at_corners, axes[:, b]) for a, b in pairs]
    return Field(axes, np.stack(components, axis=2), second)


def plane_axes(terrain: Terrain) -> Array:
    """Two unit vectors in the plane of each cell, shape (cells, 2, 3); zero in cells without area."""
    corners = terrain.points[terrain.triangles]
    side = np.where(terrain.sound[:, None], corners[:, 1] - corners[:, 0], 0.0)
    first = side / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), np.finfo(float).tiny)
    return np.stack([first, np.cross(np.nan_to_num(terrain.normals), first)], axis=1)


def trace(
    terrain: Terrain,
    cells: Integers,
    shares: Array,
    directions: Array,
    length: float,
    allowed: Truths,
    field: Field | None = None,
    near: float = 0.0,
) -> tuple[list[Track], Ends]:
    """Trace lines from points until the rim, the end of the allowed cells or a length.

    Args:
        terrain: The surface.
        cells: Cells of the starts, shape (k,).
        shares: Shares of their corners, shape (k, 3).
        directions: Unit vectors in their planes, shape (k, 3).
        length: Length after which a line ends [m].
        allowed: Cells in which lines go on, shape (cells,).
        field: Directions to follow; None for straight lines.
        near: Distance from its start within which a line that comes back ends, or closes; 0 for lines that go on [m].

    Returns:
        The lines, and their ends.
    """
    count = len(cells)
    cell, share, direction = cells.copy(), np.clip(shares, NODE_DISTANCE, None), directions.copy()
    share /= share.sum(axis=1, keepdims=True)
    start = terrain.places(cell, share)
    run, closed = np.zeros(count), np.zeros(count, dtype=bool)
    steps: list[tuple[Integers, Array, Integers]] = [(np.arange(count), start, cell)]
    active, travelled = np.flatnonzero(allowed[cell]), 0
    while len(active) and travelled <= 4 * len(terrain.triangles) + 100:
        c, s, d = cell[active], share[active], direction[active]
        out, way, d = _through(terrain, c, s, d, field)
        rest = length - run[active]
        ending = way >= rest
        out = np.where(ending[:, None], s + (np.minimum(way, rest) / np.maximum(way, 1e-300))[:, None] * (out - s), out)
        place = terrain.places(c, out)
        if near and travelled:
            back = (c == cells[active]) & (np.einsum("ki,ki->k", d, directions[active]) > TURN_COSINE)
            gap = _distance(start[active], terrain.places(c, s), place)
            once = back & (gap < CLOSED * near)
            place[once], ending = start[active[once]], ending | (back & (gap < near))
            closed[active[once]] = True
        run[active] += np.minimum(way, rest)
        steps.append((active, place, c))
        share[active], direction[active] = out, d
        gone = np.argmin(out, axis=1)
        across = terrain.beside[c, gone]
        on = ~ending & (across >= 0)
        on[on] = allowed[across[on]]
        active = active[on]
        across, entered, ahead = _into(terrain, c[on], out[on], d[on], gone[on], across[on])
        if field is not None:
            turned = field.direction(across, entered, ahead)
            inward = terrain.gradients[across, np.argmin(entered, axis=1)]
            ahead = np.where((np.einsum("ki,ki->k", turned, inward) > 0)[:, None], turned, ahead)
            smooth = np.einsum("ki,ki->k", turned, ahead) > TURN_COSINE
            active, across, entered, ahead = active[smooth], across[smooth], entered[smooth], ahead[smooth]
        cell[active], share[active], direction[active] = across, entered, ahead
        travelled += 1
    return _gathered(count, steps, closed), Ends(cell, share, direction, run)


def _through(
    terrain: Terrain, cells: Integers, shares: Array, directions: Array, field: Field | None
) -> tuple[Array, Array, Array]:
    """Shares where lines leave their cells, the lengths until there, and the directions."""
    out, way = _leaving(terrain, cells, shares, directions)
    if field is None:
        return out, way, directions
    middle = field.direction(cells, (shares + out) / 2, directions)
    better, farther = _leaving(terrain, cells, shares, middle)
    inside = farther > 0  # else the direction leads back over the edge that the line came from
    return (
        np.where(inside[:, None], better, out),
        np.where(inside, farther, way),
        np.where(inside[:, None], middle, directions),
    )


def _leaving(terrain: Terrain, cells: Integers, shares: Array, directions: Array) -> tuple[Array, Array]:
    """Shares where directions leave cells, beside nodes, and the lengths until there."""
    rate = np.einsum("kci,ki->kc", terrain.gradients[cells], directions)
    falling = rate < -PARALLEL_RATE * np.abs(rate).max(axis=1, keepdims=True)
    time = np.full(rate.shape, np.inf)
    np.divide(shares, -rate, where=falling, out=time)
    gone = time.argmin(axis=1)
    rows = np.arange(len(cells))
    way = np.maximum(time[rows, gone], 0.0)
    out = np.maximum(shares + way[:, None] * rate, NODE_DISTANCE)
    out[rows, gone] = 0.0
    return out / out.sum(axis=1, keepdims=True), np.where(way > CORNER, way, 0.0)


def _into(
    terrain: Terrain, cells: Integers, shares: Array, directions: Array, gone: Integers, across: Integers
) -> tuple[Integers, Array, Array]:
    """Cells across edges, shares in them, and directions straight on, as in the unfolded cells."""
    corners, others = terrain.triangles[cells], terrain.triangles[across]
    same = others[:, :, None] == corners[:, None, :]
    entered = np.einsum("kab,kb->ka", same, shares)
    rows = np.arange(len(cells))
    apex = np.argmin(same.any(axis=2), axis=1)
    entered[rows, apex] = 0.0
    edge = terrain.points[corners[rows, gone - 1]] - terrain.points[corners[rows, gone - 2]]
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    inward = terrain.gradients[across, apex]
    inward = inward / np.linalg.norm(inward, axis=1, keepdims=True)
    along = np.einsum("ki,ki->k", directions, edge)
    up = np.sqrt(np.maximum(1 - along**2, 0.0))
    return across, entered, along[:, None] * edge + up[:, None] * inward


def _distance(points: Array, first: Array, last: Array) -> Array:
    """Distance of points from segments, shape (k,)."""
    side = last - first
    square = np.maximum(np.einsum("ki,ki->k", side, side), 1e-300)
    t = np.clip(np.einsum("ki,ki->k", points - first, side) / square, 0, 1)
    return np.asarray(np.linalg.norm(points - first - t[:, None] * side, axis=1))


def _gathered(count: int, steps: Iterable[tuple[Integers, Array, Integers]], closed: Truths) -> list[Track]:
    """Lines one by one, from the steps of all."""
    numbers, places, cells = (np.concatenate(entries) for entries in zip(*steps, strict=True))
    order = np.argsort(numbers, kind="stable")
    bounds = np.cumsum(np.bincount(numbers, minlength=count))[:-1]
    return [
        Track(points, between[1:], bool(end))
        for points, between, end in zip(
            np.split(places[order], bounds), np.split(cells[order], bounds), closed, strict=True
        )
    ]


def shares_of(terrain: Terrain, cells: Integers, places: Array) -> Array:
    """Shares of the corners of cells at places in them, shape (k, 3)."""
    offset = places - terrain.points[terrain.triangles[cells]].mean(axis=1)
    shares = np.maximum(1 / 3 + np.einsum("kci,ki->kc", terrain.gradients[cells], offset), NODE_DISTANCE)
    return np.asarray(shares / shares.sum(axis=1, keepdims=True))
