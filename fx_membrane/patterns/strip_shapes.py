"""Strips as discs: opened along seams, laid out in a plane, with their axis and width."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull

from ..checks import validation
from ..geometry.sizes import normals, projected
from ..geometry.topology import boundary_edges
from ..surfaces.flattening import flattened
from .split_mesh import Pair

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

ROUND_DIFFERENCE = 0.05  # difference of two extents of a strip over the larger, below which neither is the axis


class Opened(NamedTuple):
    """Strip cut open along the seams within it.

    Attributes:
        nodes: Node of the structure of each opened one, shape (n,); nodes on a seam within the strip come twice.
        triangles: Cells as rows of these, shape (k, 3).
    """

    nodes: Integers
    triangles: Integers


class Layout(NamedTuple):
    """Strip laid out in a plane by a conformal map, which shows its axis and its size.

    Attributes:
        warp: Unit vectors along its axis in the cells, shape (k, 3) [-].
        width: Smallest width of a straight sheet along the axis that covers it [m].
        length: Length of that sheet [m].
    """

    warp: Array
    width: float
    length: float


def opened(cells: Integers, seams: set[Pair]) -> Opened:
    """Part the cells of a strip along the seams within it.

    Args:
        cells: Its cells, shape (k, 3).
        seams: Edges on seams, by their nodes, ascending.
    """
    count = len(cells)
    ends = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    corner = np.arange(3 * count).reshape(count, 3)
    corners = np.concatenate([corner[:, [0, 1]], corner[:, [1, 2]], corner[:, [2, 0]]])
    turned = ends[:, 0] > ends[:, 1]
    ends[turned], corners[turned] = ends[turned][:, ::-1], corners[turned][:, ::-1]
    code = ends[:, 0] * (int(cells.max()) + 1) + ends[:, 1]
    order = np.argsort(code, kind="stable")
    following = np.flatnonzero(np.diff(code[order]) == 0)
    first, second = order[following], order[following + 1]
    joined = np.array([(a, b) not in seams for a, b in ends[first].tolist()], dtype=bool)
    a, b = corners[first[joined]].T.ravel(), corners[second[joined]].T.ravel()
    graph = sparse.coo_array((np.ones(len(a), dtype=np.int8), (a, b)), shape=(3 * count, 3 * count))
    label = connected_components(graph, directed=False)[1].astype(np.int64)
    nodes = np.empty(label.max() + 1, dtype=np.int64)
    nodes[label] = cells.ravel()
    return Opened(nodes, label.reshape(count, 3))


def check_disc(name: str, points: Array, strip: Opened) -> None:
    """Refuse a strip that is not a disc.

    Raises:
        ValueError: It is closed, a tube, or has a hole.
    """
    rim = boundary_edges(strip.triangles)
    sides = (3 * len(strip.triangles) + len(rim)) // 2
    number = len(strip.nodes) - sides + len(strip.triangles)  # Euler's, 1 of a disc
    if number == 1:
        return
    where = validation.format_point(points[strip.nodes].mean(axis=0))
    if number > 1:
        raise ValueError(f"Strip {name!r} around {where} is closed, and cannot be laid flat; part it by seams.")
    loops = _loops(rim)
    inner = np.argmin([len(loop) for loop in loops])
    place = validation.format_point(points[strip.nodes[loops[inner]]].mean(axis=0))
    raise ValueError(
        f"Strip {name!r} around {where} is no disc, but a tube or with {2 - number - 1} hole{'s' * (number < 0)}, one "
        f"around {place}; lead a seam from there to another border."
    )


def _loops(rim: Integers) -> list[Integers]:
    nodes, ends = np.unique(rim, return_inverse=True)
    ends = ends.reshape(rim.shape)
    graph = sparse.coo_array((np.ones(len(ends)), tuple(ends.T)), shape=(len(nodes),) * 2)
    label = connected_components(graph, directed=False)[1]
    return [nodes[label == loop] for loop in range(label.max() + 1)]


def laid_out(name: str, points: Array, strip: Opened, warp: Array, wanted: Array | None = None) -> Layout:
    """Lay a strip out in a plane; find its axis, width and length.

    The axis is the principal one of the area. A strip about as wide as long takes the axis of its least width; of
    several that are as narrow to 5 %, that nearest to its present warp.

    Args:
        name: Name of the strip, for messages.
        points: Positions of the nodes, shape (n, 3) [m].
        strip: The strip, a disc.
        warp: Present warp of its cells, shape (k, 3) [-].
        wanted: Direction of the axis in the cells in place of that, shape (k, 3), or None.

    Raises:
        ValueError: It folds over itself in the plane.
    """
    corners, triangles = points[strip.nodes], strip.triangles
    flat = flattened(corners, triangles)
    if flat is None:
        where = validation.format_point(corners.mean(axis=0))
        raise ValueError(f"Strip {name!r} folds over itself when laid flat, around {where}; part it by one more seam.")
    places = flat.points[triangles]
    sides = places[:, 1:] - places[:, :1]
    area = np.abs(np.linalg.det(sides)) / 2
    gradients = np.linalg.inv(sides) @ (corners[triangles[:, 1:]] - corners[triangles[:, :1]])
    if wanted is None:
        values, axes = _moments(places, area)
        along = axes[:, 1]
        if np.sqrt(values[0]) > (1 - ROUND_DIFFERENCE) * np.sqrt(values[1]):
            along = _narrowest(flat.points, _mean_axis(warp, gradients, area))
    else:
        along = _mean_axis(wanted, gradients, area)
    across = np.array([-along[1], along[0]])
    thread = along @ gradients
    thread *= 1.0 if np.sum(thread * (warp if wanted is None else wanted), axis=1) @ area >= 0 else -1.0
    width, length = (float(np.ptp(flat.points @ axis)) for axis in (across, along))
    return Layout(projected(thread, normals(corners, triangles)), width, length)


def _moments(places: Array, area: Array) -> tuple[Array, Array]:
    """Principal moments of an area, the smaller first, and their axes as columns."""
    around = places - np.average(places.mean(axis=1), axis=0, weights=area)
    total = around.sum(axis=1)
    moments = np.einsum("c,cki,ckj->ij", area, around, around) + np.einsum("c,ci,cj->ij", area, total, total)
    values, axes = np.linalg.eigh(moments)
    return values, axes


def _mean_axis(directions: Array, gradients: Array, area: Array) -> Array:
    """Mean in the plane of directions in the cells, whatever their senses, shape (2,) [-]."""
    x, y = np.einsum("ki,kji->jk", directions, gradients)
    angle = 2 * np.arctan2(y, x)
    mean = np.arctan2(area @ np.sin(angle), area @ np.cos(angle)) / 2
    return np.array([np.cos(mean), np.sin(mean)])


def _narrowest(points: Array, present: Array) -> Array:
    """Axis of least width, which is along an edge of the convex hull; of several that nearest to a present one."""
    hull = points[ConvexHull(points).vertices]
    edges = np.roll(hull, -1, axis=0) - hull
    axes = np.vstack([present, edges / np.linalg.norm(edges, axis=1, keepdims=True)])
    width = np.ptp(hull @ np.stack([-axes[:, 1], axes[:, 0]]), axis=0)
    near = np.where(width <= (1 + ROUND_DIFFERENCE) * width.min(), np.abs(axes @ present), -1.0)
    return np.asarray(axes[near.argmax()])
