"""Lines in which planes cut surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.line_order import lines_between
from .shapes import Shape, Surface, surface_of
from .surface_lines import SurfaceLine

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

ON = 1e-9  # distance from the plane over the size of the surface within which a node is in it


def planar_cut(shape: Shape, point: ArrayLike, normal: ArrayLike, part: str | None = None) -> list[SurfaceLine]:
    """Lines in which a plane cuts a surface, the longest first: seams, sections, lines of one height.

    They are straight in each cell. Where several meet at a node, as in a saddle, each ends there.

    Args:
        shape: A `Structure`, a `Form`, a `StageResult`, taken as deformed; or points and triangles as a pair.
        point: Point of the plane, shape (3,) [m].
        normal: Normal of the plane, of any length, shape (3,).
        part: Name of the membrane; None for all, joined where they share nodes.

    Raises:
        ValueError: The plane does not cut the surface, or a cell lies in it.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 8, 4)
        >>> points[:, 2] = points[:, 0] ** 2
        >>> first, second = planar_cut((points, triangles), point=(0, 0, 1), normal=(0, 0, 1))
        >>> first.length, sorted({float(abs(x)) for x in np.concatenate([first.points, second.points])[:, 0]})
        (2.0, [1.0])
    """
    surface = surface_of("planar_cut", shape, part)
    place, axis = validation.vector("point", point), validation.direction("normal", normal)
    height = (surface.points - place) @ (axis / np.linalg.norm(axis))
    size = float(np.ptp(surface.points[np.unique(surface.triangles)], axis=0).max())
    height[np.abs(height) < ON * size] = 0.0
    whole = np.flatnonzero((height[surface.triangles] == 0).all(axis=1))
    if len(whole):
        where = validation.format_point(surface.points[surface.triangles[whole[0]]].mean(axis=0))
        raise ValueError(f"The plane has cell {whole[0]} in it, at {where}; move or turn it a little.")
    places, segments, cells = _segments(surface, height)
    if not len(segments):
        nearest = surface.points[np.unique(surface.triangles)]
        near = nearest[np.abs((nearest - place) @ axis).argmin()]
        raise ValueError(
            f"The plane through {validation.format_point(place)} with the normal {validation.format_point(axis)} does "
            f"not cut the surface; the nearest node is at {validation.format_point(near)}."
        )
    cell_of = {(a, b): cell for (a, b), cell in zip(segments.tolist(), cells.tolist(), strict=True)}
    found = []
    for chain in lines_between(cell_of):
        pairs = np.sort(np.column_stack([chain[:-1], chain[1:]]), axis=1).tolist()
        found.append(SurfaceLine(places[chain], np.array([cell_of[a, b] for a, b in pairs])))
    return sorted(found, key=lambda line: -round(line.length / size, 9))


def _segments(surface: Surface, height: Array) -> tuple[Array, Integers, Integers]:
    """Places where a plane meets nodes and edges, pairs of them across cells, and these cells.

    Args:
        surface: The surface.
        height: Distance of the nodes from the plane, exactly zero of those in it, shape (n,) [m].
    """
    count = len(surface.points)
    ends = np.sort(surface.triangles[:, [[1, 2], [2, 0], [0, 1]]], axis=2)  # opposite to each corner
    low, high = ends[..., 0], ends[..., 1]
    crossed = height[low] * height[high] < 0
    touched = height[surface.triangles] == 0
    met = crossed.sum(axis=1) + touched.sum(axis=1) == 2
    key = np.where(touched, surface.triangles, np.where(crossed, count + low * count + high, -1))
    other = np.where(touched & crossed, count + low * count + high, -1)  # a node, and the edge opposite to it
    keys = np.sort(np.column_stack([key, other])[met], axis=1)[:, -2:]
    used, rows = np.unique(keys, return_inverse=True)
    a, b = np.divmod(np.maximum(used - count, 0), count)
    node = used < count
    a, b = np.where(node, used, a), np.where(node, used, b)
    share = np.divide(height[a], height[a] - height[b], where=~node, out=np.zeros(len(used)))
    places = surface.points[a] + share[:, None] * (surface.points[b] - surface.points[a])
    segments, first = np.unique(np.sort(rows.reshape(-1, 2), axis=1), axis=0, return_index=True)
    return places, segments, np.flatnonzero(met)[first]
