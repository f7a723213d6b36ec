"""Direction of the warp along geodesics between pairs of nodes, traced anew on each shape of a surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..checks import validation
from ..geometry.sizes import lengths, measures, normals, projected
from ..geometry.topology import with_one_sense
from ..model.by_value import ByValue
from .geodesics import flipped
from .nearest_points import nearest
from .shapes import Surface
from .transfer import main_direction
from .walking import Terrain
from .warp_directions import in_one_sense, links

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

VAGUE = 0.1  # difference of principal values of the mean of directions, of one for one, that leaves no direction
FIRM = 10.0  # weight of the lines, times the mean edge, against the change of the direction from place to place


@dataclass(frozen=True, eq=False)
class GeodesicDirection(ByValue):
    """Direction along the geodesics between pairs of nodes of a membrane: the warp of strips cut along them.

    `prescribed_stress` traces the geodesics anew on each shape. Between them the direction changes as little from place
    to place as they allow. It is a least square over the surface, with the integral of the difference from the lines
    along them; so it changes steadily where the lines move across nodes and edges.

    Args:
        ends: First and last node of each geodesic, shape (k, 2).

    Raises:
        ValueError: There is no pair, a pair is one node, or two pairs are the same.

    Source:
        Geodesics: N. Sharp, K. Crane, You can find geodesic paths in triangle meshes by just flipping edges, ACM
        Transactions on Graphics 39 (2020) 249.

    Example:
        >>> points, triangles = rectangle(4.0, 4.0, 8, 8)
        >>> warp = GeodesicDirection([[0, 80], [1, 71]]).vectors("film", points, triangles)
        >>> bool(np.allclose(np.abs(warp[0]), [np.sqrt(0.5), np.sqrt(0.5), 0], atol=1e-2))
        True
    """

    ends: ArrayLike

    def __post_init__(self) -> None:
        validation.keep(self, ends=validation.cells("GeodesicDirection ends", self.ends, 2, row="geodesic"))

    def vectors(self, name: str, points: Array, triangles: Integers) -> Array:
        """Direction in the cells of a shape: unit tangents, shape (cells, 3) [-].

        Args:
            name: Name of the membrane, for messages.
            points: Positions of the nodes, shape (n, 3) [m].
            triangles: Cells of the membrane, shape (cells, 3).

        Raises:
            ValueError: An end is no node of the membrane; it has one side only, or branches; a piece of it has no
                geodesic; geodesics leave a cell without a direction.
            ImportError: potpourri3d is not installed.
        """
        nodes, cells = np.unique(triangles, return_inverse=True)
        cells = cells.reshape(-1, 3)
        ends = np.asarray(self.ends)
        stray = np.argwhere(~np.isin(ends, nodes))
        if len(stray):
            node, number = ends[tuple(stray[0])], stray[0, 0]
            raise ValueError(
                f"warp of part {name!r}: geodesic {number}, from node {ends[number, 0]} to node {ends[number, 1]}, has "
                f"its end at node {node}, which is none of the membrane; give nodes of its cells."
            )
        surface = Surface(points[nodes], cells)
        pairs = np.searchsorted(nodes, ends)
        _check_pieces(name, surface, pairs)
        sided, reason = with_one_sense(cells)
        if reason:
            raise ValueError(f"warp of part {name!r} is along geodesics, and the surface {reason}")
        return _between(name, surface, flipped(surface.points, sided, pairs))


def _check_pieces(name: str, surface: Surface, pairs: Integers) -> None:
    """Refuse geodesics between pieces of a surface, and pieces without one."""
    points, cells = surface
    count = len(points)
    ties = sparse.coo_array(
        (np.ones(2 * len(cells)), (cells[:, [0, 0]].T.ravel(), cells[:, 1:].T.ravel())), (count,) * 2
    )
    piece = connected_components(ties, directed=False)[1]
    apart = np.flatnonzero(piece[pairs[:, 0]] != piece[pairs[:, 1]])
    if len(apart):
        there = " and ".join(validation.format_point(points[node]) for node in pairs[apart[0]])
        raise ValueError(
            f"warp of part {name!r}: geodesic {apart[0]} has its ends at {there}, on pieces of the membrane that share "
            "no node; give ends on one piece."
        )
    bare = np.flatnonzero(~np.isin(piece, piece[pairs[:, 0]]))
    if len(bare):
        raise ValueError(
            f"warp of part {name!r}: the piece of the membrane at {validation.format_point(points[bare[0]])} has no "
            "geodesic; give it one."
        )


def _between(name: str, surface: Surface, paths: list[Array]) -> Array:
    """Directions of cells, nearest to those of lines and of least change, unit tangents, shape (cells, 3) [-]."""
    points, cells = surface
    matrix, right = _of_lines(surface, paths)
    firm = FIRM / float(np.sqrt(2 * measures(points, cells)).mean())
    tensors = splu(sparse.csc_matrix(_laplace(surface) + firm * matrix)).solve(firm * right)
    normal = normals(points, cells)
    flat = np.eye(3) - normal[:, :, None] * normal[:, None, :]
    within = flat @ tensors[cells].mean(axis=1).reshape(-1, 3, 3) @ flat
    values = np.linalg.eigvalsh(within)
    vague = np.flatnonzero(values[:, 2] - values[:, 1] <= VAGUE)
    if len(vague):
        where = validation.format_point(points[cells[vague[0]]].mean(axis=0))
        raise ValueError(
            f"warp of part {name!r}: the geodesics leave cell {vague[0]} at {where} without a direction, as between "
            "lines at right angles; give one more there."
        )
    return in_one_sense(projected(main_direction(within), normal), *links(Terrain(surface)))


def _of_lines(surface: Surface, paths: list[Array]) -> tuple[sparse.csr_array, Array]:
    """Integrals along lines of products of the shares of corners, sparse (n, n), and with their directions, (n, 9)."""
    points, cells = surface
    starts, ends = (np.concatenate([path[piece] for path in paths]) for piece in (slice(None, -1), slice(1, None)))
    length = lengths(ends - starts)
    corners = cells[nearest(surface, (starts + ends) / 2)[0]]
    first, last = (_shares(points[corners], places) for places in (starts, ends))
    middle = (first + last) / 2
    blocks = length[:, None, None] / 6 * sum(each[:, :, None] * each[:, None, :] for each in (first, last))
    blocks += length[:, None, None] / 6 * 4 * middle[:, :, None] * middle[:, None, :]  # Simpson, exact for squares
    rows, columns = np.repeat(corners, 3, axis=1).ravel(), np.tile(corners, 3).ravel()
    matrix = sparse.coo_array((blocks.ravel(), (rows, columns)), (len(points),) * 2).tocsr()
    unit = (ends - starts) / length[:, None]
    tensors = (unit[:, :, None] * unit[:, None, :]).reshape(-1, 9)
    right = np.zeros((len(points), 9))
    np.add.at(right, corners, (length[:, None] * middle)[:, :, None] * tensors[:, None])
    return matrix, right


def _shares(corners: Array, places: Array) -> Array:
    """Shares of the corners of triangles, shape (k, 3, 3), at places in their planes, both of shape (k, 3)."""
    sides = corners[:, 1:] - corners[:, :1]
    system = sides @ sides.swapaxes(1, 2)
    found = np.linalg.solve(system, (sides @ (places - corners[:, 0])[:, :, None]))[:, :, 0]
    return np.column_stack([1 - found.sum(axis=1), found])


def _laplace(surface: Surface) -> sparse.csr_array:
    """Integral of products of gradients of the shares of nodes, sparse (n, n)."""
    points, cells = surface
    corners = points[cells]
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    blocks = opposite @ opposite.swapaxes(1, 2) / (4 * measures(points, cells))[:, None, None]
    rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel()
    return sparse.coo_array((blocks.ravel(), (rows, columns)), (len(points),) * 2).tocsr()
