"""Run-off of water from a surface: depressions that hold it, and the least slope of cells and of valleys."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks import validation
from ..form_finding.form import Form
from ..geometry.sizes import measures, normals
from ..geometry.spill import edge_graph, spill_nodes
from ..geometry.topology import boundary_edges
from .depressions import Depression, Drainage
from .shapes import Shape, Surface, surface_of
from .valleys import valleys_of

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

DEPTH_ROUNDING = 1e-9  # depth over the size of the surface that is rounding


def drainage(
    shape: Shape,
    part: str | None = None,
    *,
    up: ArrayLike = (0.0, 0.0, 1.0),
    walls: ArrayLike = (),
    drains: ArrayLike = (),
    least_depth: float = 0.0,
    length_unit: str | None = None,
) -> Drainage:
    """Find where water stands on a surface, and the least slope of its cells and its valleys.

    Water runs off over the rim, rims of holes included, except at walls, and at drains. Depths, areas and volumes are
    exact for the surface of flat cells: a valley that crosses its edges has small depressions, which shrink as the
    square of the mesh size. Water has no weight here; give the state under water or snow to see that shape.

    Args:
        shape: A `Structure`, a `Form` or a `StageResult`, taken as deformed; or points, shape (n, 3), and triangles,
            shape (cells, 3), as a pair.
        part: Name of the membrane; None for all of a structure, joined where they share nodes. Cells of several are
            numbered in the order of the parts.
        up: Upward direction, shape (3,), any length.
        walls: Nodes of the rim that hold water back, shape (k,).
        drains: Nodes elsewhere into which water runs, shape (k,).
        least_depth: Depth from which on a depression counts [m]; zero for all but rounding.
        length_unit: Name of the length unit in the words of the result; by default that of a form, or else "m". No
            number is converted.

    Raises:
        ValueError: The shape is none of these; a wall is not on the rim, a drain not on the surface; all of the rim is
            walled, so that nothing drains.

    Source:
        R. Barnes, C. Lehman, D. Mulla, Priority-flood: An optimal depression-filling and watershed-labeling algorithm
        for digital elevation models, Computers & Geosciences 62 (2014) 117-127. The spill level of a node is the least
        highest point of a way to an outlet, which a minimum spanning tree of the edges has.

    Example:
        >>> points, triangles = rectangle(8.0, 8.0, 8, 8)
        >>> points[:, 2] = 0.05 * (points[:, 0] ** 2 + points[:, 1] ** 2)  # a bowl, lowest on the rim at 0.8
        >>> found = drainage((points, triangles))
        >>> found.drains, found.depressions[0].node, round(found.depressions[0].depth, 6)
        (False, 40, 0.8)
        >>> points[:, 2] = 0.1 * points[:, 0]
        >>> found = drainage((points, triangles))
        >>> found.drains, round(found.least_slope, 6)
        (True, 0.1)

        A valley between two steep slopes, which falls by 1 % along its bottom:

        >>> points[:, 2] = np.abs(points[:, 0]) + 0.01 * points[:, 1]
        >>> found = drainage((points, triangles))
        >>> round(found.least_slope, 2), round(found.least_valley_slope, 6)
        (1.0, 0.01)
    """
    surface = surface_of("drainage", shape, part)
    direction = validation.direction("up", up)
    least_depth = validation.not_negative("least_depth", least_depth)
    length = validation.text("length_unit", _unit_of(shape) if length_unit is None else length_unit)
    outlets = _outlets(surface, walls, drains)
    height = surface.points @ direction
    used = np.unique(surface.triangles)
    source = spill_nodes(surface.triangles, height, outlets)
    depth = np.zeros(len(height))
    depth[used] = height[source[used]] - height[used]
    least = max(least_depth, DEPTH_ROUNDING * float(np.ptp(surface.points[used], axis=0).max()))
    slope = _slopes(surface, direction)
    flattest = int(slope.argmin())
    place = surface.points[surface.triangles[flattest]].mean(axis=0)
    ponds = _ponds(surface, height, depth, source, direction, least)
    valleys, falls = valleys_of(surface, direction, outlets)
    return Drainage(ponds, depth, slope, flattest, place, valleys, falls, length)


def _unit_of(shape: Shape) -> str:
    """Name of the length unit of a form; that of docstrings for other shapes, which name none."""
    return shape.length_unit if isinstance(shape, Form) else "m"


def _slopes(surface: Surface, up: Array) -> Array:
    """Slopes of the cells, shape (cells,) [-]."""
    normal = normals(surface.points, surface.triangles)
    upright = np.abs(normal @ up)
    level = np.linalg.norm(normal - (normal @ up)[:, None] * up, axis=1)
    return np.divide(level, upright, where=upright > 0, out=np.full(len(level), np.inf))


def _outlets(surface: Surface, walls: ArrayLike, drains: ArrayLike) -> Integers:
    """Nodes over which water leaves, shape (k,)."""
    used, rim = np.unique(surface.triangles), np.unique(boundary_edges(surface.triangles))
    walled = validation.indices("walls", walls, empty=True)
    sinks = validation.indices("drains", drains, empty=True)
    for name, nodes, allowed, place in [("walls", walled, rim, "rim"), ("drains", sinks, used, "surface")]:
        stray = nodes[~np.isin(nodes, allowed)]
        if len(stray):
            raise ValueError(f"{name} names node {stray[0]}, which is not on the {place}; give nodes of the {place}.")
    outlets = np.union1d(np.setdiff1d(rim, walled), sinks)
    graph = edge_graph(surface.triangles, np.ones(len(surface.points)))
    piece = connected_components(graph, directed=False)[1]
    closed = np.setdiff1d(piece[used], piece[outlets])
    if len(closed):
        node = used[piece[used] == closed[0]][0]
        raise ValueError(
            f"Water has no way out of the surface around node {node}, {validation.format_point(surface.points[node])}: "
            "it has no rim without walls; leave some of the rim open, or name drains."
        )
    return outlets


def _ponds(
    surface: Surface, height: Array, depth: Array, source: Integers, up: Array, least: float
) -> tuple[Depression, ...]:
    """Depressions deeper than a least depth, the deepest first."""
    wet = depth > 0
    graph = edge_graph(surface.triangles, np.ones(len(height)))
    joined = wet[graph.row] & wet[graph.col]
    links = sparse.coo_array((graph.data[joined], (graph.row[joined], graph.col[joined])), shape=graph.shape)
    pond = connected_components(links, directed=False)[1]
    higher = np.where(height[graph.row] >= height[graph.col], graph.row, graph.col)
    lower = graph.row + graph.col - higher
    pit = wet.copy()
    pit[higher[height[higher] > height[lower]]] = False
    nodes = np.flatnonzero(wet)
    found = []
    wet_corner = wet[surface.triangles]
    cells = np.flatnonzero(wet_corner.any(axis=1))
    of_cell = pond[surface.triangles[cells, wet_corner[cells].argmax(axis=1)]]
    level = height[source[surface.triangles[cells, wet_corner[cells].argmax(axis=1)]]]
    areas, volumes = _water(surface, cells, level, height, up)
    for number in np.unique(pond[nodes]):
        members = nodes[pond[nodes] == number]
        lowest = members[np.argmax(depth[members])]
        if depth[lowest] <= least:
            continue
        pits = members[pit[members]]
        here = of_cell == number
        found.append(
            Depression(
                node=int(lowest),
                place=surface.points[lowest],
                depth=float(depth[lowest]),
                area=float(areas[here].sum()),
                volume=float(volumes[here].sum()),
                spill=int(source[lowest]),
                level=float(height[source[lowest]]),
                pits=pits[np.argsort(height[pits], kind="stable")],
            )
        )
    return tuple(sorted(found, key=lambda depression: -depression.depth))


def _water(surface: Surface, cells: NDArray[np.intp], level: Array, height: Array, up: Array) -> tuple[Array, Array]:
    """Area in plan and volume of the water on some cells, both of shape (k,)."""
    triangles = surface.triangles[cells]
    flat = measures(surface.points, triangles) * np.abs(normals(surface.points, triangles) @ up)
    d = np.sort(level[:, None] - height[triangles], axis=1)  # depths at the corners, the least first
    least, middle, most = d.T
    dry = np.divide(least**2, (most - least) * (middle - least), where=(least < 0) & (middle > 0), out=np.zeros(len(d)))
    tip = np.divide(most**2, (most - least) * (most - middle), where=middle <= 0, out=np.zeros(len(d)))
    area = np.where(middle > 0, 1 - dry, np.where(least >= 0, 1.0, tip))
    volume = np.where(
        middle > 0, d.mean(axis=1) - dry * least / 3, np.where(least >= 0, d.mean(axis=1), tip * most / 3)
    )
    return flat * area, flat * volume
