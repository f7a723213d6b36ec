"""Points and cells: ready-made grids, and what can be measured on any."""

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks import validation

# The inverse of the metric of a triangle loses digits as the square of its aspect: of its forces a share of about
# 4 eps aspect^2 is rounding, 9e-4 at 1e6, 0.09 at 1e7; at 7e7 nothing is left.
SLIVER = 1.001e7  # most slender triangle
SLENDER = 5e5  # rounding of 2e-4
FLAT = 1e-10  # height over side that is none

Diagonals = Literal["right", "left", "to centre"]


def rectangle(
    width: float, height: float, columns: int, rows: int, diagonals: Diagonals = "to centre"
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Grid of triangles over a rectangle in the plane z = 0, centred on the origin.

    Nodes are numbered row by row from the corner (-width/2, -height/2), x running first; node
    `(columns + 1) * row + column`. All normals point along +z.

    Args:
        width: Size along x [m].
        height: Size along y [m].
        columns: Number of grid cells along x.
        rows: Number of grid cells along y.
        diagonals: How a grid cell is split: "right" from its lower left to its upper right corner, "left" the
            other way, "to centre" along the diagonal that points to the centre of the rectangle (the pattern of
            Gil's Fig. 6, symmetric about both axes where columns and rows are even; its centre node has eight triangles
            and so more than its share of a uniform load).

    Returns:
        Points, shape ((columns + 1) (rows + 1), 3) [m], and triangles, shape (2 columns rows, 3).

    Raises:
        ValueError: A size or a number is not positive, or diagonals is none of the three.
    """
    width, height = validation.positive("width", width), validation.positive("height", height)
    columns, rows = validation.whole("columns", columns), validation.whole("rows", rows)
    if 3 * (columns + 1) * (rows + 1) > validation.MOST:
        raise ValueError(f"columns is {columns} and rows is {rows}, more nodes than PETSc numbers; give smaller ones.")
    choices = ("right", "left", "to centre")
    diagonals = validation.choice("diagonals", diagonals, choices, '"right", "left" or "to centre"')
    x = np.linspace(-width / 2, width / 2, columns + 1)
    y = np.linspace(-height / 2, height / 2, rows + 1)
    points = np.stack([*np.meshgrid(x, y), np.zeros((rows + 1, columns + 1))], axis=-1).reshape(-1, 3)

    row, column = (index.ravel() for index in np.mgrid[:rows, :columns])
    a = (columns + 1) * row + column  # lower left, then counter-clockwise
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    same_sign = (2 * row + 1 > rows) == (2 * column + 1 > columns)
    right = {"right": np.ones_like(same_sign), "left": np.zeros_like(same_sign), "to centre": same_sign}[diagonals]
    first = np.where(right, [a, b, c], [a, b, d])
    second = np.where(right, [a, c, d], [b, c, d])
    return points, np.stack([first, second], axis=-1).transpose(1, 2, 0).reshape(-1, 3)


def polyline(nodes: ArrayLike) -> NDArray[np.int64]:
    """Segments between consecutive nodes, shape (n - 1, 2): cells for a cable along them.

    Args:
        nodes: Node numbers in order, shape (n,); to close the line, the first once more at the end.

    Raises:
        ValueError: They are not at least two whole numbers.
    """
    line = validation.rows("nodes", nodes)
    if len(line) < 2:
        raise ValueError(f"nodes is {validation.shown(nodes)}; give at least two.")
    return np.column_stack([line[:-1], line[1:]])


def boundary(triangles: ArrayLike) -> NDArray[np.int64]:
    """Edges that belong to one triangle only, shape (edges, 2), in the sense of their triangle.

    Args:
        triangles: Cells, shape (cells, 3).

    Raises:
        ValueError: They are not triangles.
    """
    edges, edge, count = _edges(validation.cells("triangles", triangles, 3, distinct=False))
    outer = count[edge] == 1
    return np.asarray(edges[outer][np.argsort(edge[outer])])


def orientation(triangles: NDArray[np.int64]) -> NDArray[np.float64] | None:
    """Signs that give all triangles of a connected piece one sense, that of its first, shape (cells,); None if none do.

    Pieces are connected through edges with two triangles; where more meet, each sheet has its own sense.
    """
    n = len(triangles)
    edges, edge, count = _edges(triangles)
    owner = np.tile(np.arange(n), 3)
    forward = edges[:, 0] < edges[:, 1]
    order = np.argsort(edge, kind="stable")
    order = order[count[edge[order]] == 2].reshape(-1, 2)
    (a, b), same = owner[order].T, forward[order[:, 0]] != forward[order[:, 1]]
    # Two copies of each triangle, one for each sense: a piece is one-sided if both copies are connected.
    rows = np.concatenate([a, a + n])
    columns = np.concatenate([np.where(same, b, b + n), np.where(same, b + n, b)])
    graph = sparse.coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(2 * n, 2 * n))
    label = connected_components(graph, directed=False)[1].reshape(2, n)
    if (label[0] == label[1]).any():
        return None
    piece = np.minimum(label[0], label[1])
    _, first, member = np.unique(piece, return_index=True, return_inverse=True)
    return np.where(label[0] == label[0, first][member.ravel()], 1.0, -1.0)


def with_one_sense(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], str]:
    """Triangles turned to the sense of the first of their connected piece, shape (cells, 3); why they have no sides.

    The first node of a triangle stays its first; the other two change places where it is turned. The reason is the end
    of a sentence that begins with the surface: it branches, or has one side only; empty where it has two sides.
    """
    signs, branch = orientation(triangles), branching_edge(triangles)
    if signs is None:
        return triangles, (
            "has only one side, like a Moebius strip, so that a normal, a pressure and a shear have no direction on "
            "it; cut it into parts along a line of edges."
        )
    turned = np.where(signs[:, None] > 0, triangles, triangles[:, [0, 2, 1]])
    if branch is None:
        return turned, ""
    return turned, (
        f"branches at the edge between nodes {branch[0]} and {branch[1]}, so that it has no two sides, and a normal, a "
        "pressure and a shear no direction; make each sheet a part of its own."
    )


def branching_edge(triangles: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """An edge with three triangles or more, shape (2,); None if there is none."""
    edges, edge, count = _edges(triangles)
    return np.sort(edges[edge == np.argmax(count)][0]) if count.max() > 2 else None


def from_smallest(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells with their smallest node first, shape of cells: the sense of triangles stays, that of segments does not."""
    order = np.argmin(cells, axis=1)[:, None] + np.arange(cells.shape[1])
    return np.take_along_axis(cells, order % cells.shape[1], axis=1)


def measures(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Areas of triangles [m2] or lengths of segments [m], shape (cells,)."""
    side = np.diff(points[cells], axis=1)
    if cells.shape[1] == 2:
        return np.asarray(np.linalg.norm(side[:, 0], axis=1))
    return np.asarray(np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1) / 2)


def normals(points: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Unit normals of triangles, by the right-hand rule from the order of their nodes, shape (cells, 3) [-]."""
    side = np.diff(points[triangles], axis=1)
    area = np.cross(side[:, 0], side[:, 1])
    return np.asarray(area / np.linalg.norm(area, axis=1, keepdims=True))


def projected(vectors: NDArray[np.float64], normal: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit vectors along the projections of vectors on the planes normal to unit normals, all of shape (n, 3) [-].

    Zero where a vector is zero, or normal to its plane but for rounding.
    """
    tangent = vectors - np.sum(vectors * normal, axis=1, keepdims=True) * normal
    length = np.linalg.norm(tangent, axis=1, keepdims=True)
    there = length > 1e-8 * np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(tangent, length, where=there, out=np.zeros_like(tangent))


def degenerate(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.intp]:
    """Triangles more slender than `SLIVER`, segments without length but for rounding, shape (k,)."""
    return np.flatnonzero(aspects(points, cells) > SLIVER)


def aspects(points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Longest side of triangles over the height on it, shape (cells,) [-]; of segments 1.

    Infinite where height or length are nothing but rounding.
    """
    corners = points[cells]
    side = np.roll(corners, -1, axis=1) - corners
    span = np.maximum(np.abs(side).max(axis=(1, 2)), np.finfo(float).tiny)
    side = side / span[:, None, None]  # squares of any size are numbers
    longest = np.linalg.norm(side, axis=2).max(axis=1)
    height = longest if cells.shape[1] == 2 else np.linalg.norm(np.cross(side[:, 0], side[:, 1]), axis=1) / longest
    rounding = np.maximum(8 * np.finfo(float).eps * np.abs(corners).max(axis=(1, 2)) / span, FLAT)
    return np.divide(longest, height, where=height > rounding, out=np.full(len(cells), np.inf))


def _edges(triangles: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.intp], NDArray[np.intp]]:
    """First all first edges, then all second, then all third ones, shape (3 cells, 2).

    With them the number of each, the same for the two directions, shape (3 cells,), and how many have it.
    """
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    low, high = edges.min(axis=1), edges.max(axis=1)
    pair = low * (high.max() + 1) + high  # one whole number: sorting rows is many times slower
    _, number, count = np.unique(pair, return_inverse=True, return_counts=True)
    return edges, number.ravel(), count
