"""Run-off of water from a surface: depressions that hold it, and the least slope."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree

from ..checks import validation
from ..geometry.measures import measures, normals
from ..geometry.topology import boundary_edges
from .shapes import Shape, Surface, surface_of

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

LEVEL = 1e-9  # slope that is rounding
SHALLOW = 1e-9  # depth over the size of the surface that is rounding


@dataclass(frozen=True, eq=False)
class Depression:
    """Part of a surface that holds water until it spills.

    Attributes:
        node: Its lowest node.
        place: Position of that node, shape (3,) [m].
        depth: Depth of the water there when it spills [m].
        area: Area of the water in plan then [m2].
        volume: Volume of the water then [m3].
        spill: Node over which it spills.
        level: Height of that node along the upward direction [m].
        pits: Lowest nodes of all ponds that have merged in it by then, the lowest first, shape (k,).
    """

    node: int
    place: Array
    depth: float
    area: float
    volume: float
    spill: int
    level: float
    pits: Integers


@dataclass(frozen=True, eq=False, repr=False)
class Drainage:
    """Run-off of water from a surface.

    Attributes:
        depressions: The depressions, the deepest first; empty if water runs off everywhere.
        depth: Depth of the water at each node when all depressions are full, shape (n,) [m].
        slope: Slope of each cell, rise over run, infinite for a vertical one, shape (cells,) [-].
        cell: The cell with the least slope.
        place: Centre of that cell, shape (3,) [m].
    """

    depressions: Sequence[Depression]
    depth: Array
    slope: Array
    cell: int
    place: Array

    @property
    def drains(self) -> bool:
        """True if water runs off everywhere."""
        return not self.depressions

    @property
    def least_slope(self) -> float:
        """Least slope, rise over run [-]."""
        return float(self.slope[self.cell])

    def __repr__(self) -> str:
        return f"Drainage({self})"

    def __str__(self) -> str:
        where = validation.format_point(self.place)
        words = [f"least slope {100 * self.least_slope:.3g} % in cell {self.cell} at {where}"]
        words += [
            f"a depression at node {pond.node}, {validation.format_point(pond.place)}, {pond.depth:.3g} deep, with an "
            f"area of {pond.area:.4g}"
            for pond in self.depressions
        ]
        if not self.depressions:
            words.insert(
                0, "water runs off everywhere" if self.least_slope > LEVEL else "no depression, but level cells"
            )
        return "; ".join(words)


def drainage(
    shape: Shape,
    part: str | None = None,
    *,
    up: ArrayLike = (0.0, 0.0, 1.0),
    walls: ArrayLike = (),
    drains: ArrayLike = (),
    least_depth: float = 0.0,
) -> Drainage:
    """Find where water stands on a surface, and the least slope.

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
    """
    surface = surface_of("drainage", shape, part)
    direction = validation.direction("up", up)
    least_depth = validation.not_negative("least_depth", least_depth)
    outlets = _outlets(surface, walls, drains)
    height = surface.points @ direction
    used = np.unique(surface.triangles)
    source = _spill_nodes(surface, height, outlets)
    depth = np.zeros(len(height))
    depth[used] = height[source[used]] - height[used]
    least = max(least_depth, SHALLOW * float(np.ptp(surface.points[used], axis=0).max()))
    slope = _slopes(surface, direction)
    flattest = int(slope.argmin())
    place = surface.points[surface.triangles[flattest]].mean(axis=0)
    return Drainage(_ponds(surface, height, depth, source, direction, least), depth, slope, flattest, place)


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
    graph = _graph(surface.triangles, np.ones(len(surface.points)))
    piece = connected_components(graph, directed=False)[1]
    closed = np.setdiff1d(piece[used], piece[outlets])
    if len(closed):
        node = used[piece[used] == closed[0]][0]
        raise ValueError(
            f"Water has no way out of the surface around node {node}, {validation.format_point(surface.points[node])}: "
            "it has no rim without walls; leave some of the rim open, or name drains."
        )
    return outlets


def _graph(triangles: Integers, weight: Array) -> sparse.coo_array:
    """Edges with the larger weight of their two nodes, shape (n, n)."""
    a, b = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]).T
    a, b = np.minimum(a, b), np.maximum(a, b)
    _, first = np.unique(a * len(weight) + b, return_index=True)
    a, b = a[first], b[first]
    return sparse.coo_array((np.maximum(weight[a], weight[b]), (a, b)), shape=(len(weight), len(weight)))


def _spill_nodes(surface: Surface, height: Array, outlets: Integers) -> Integers:
    """Highest node of the lowest way from each node to an outlet, shape (n,); the node itself if it drains."""
    count = len(height)
    rank = np.empty(count)
    rank[np.argsort(height, kind="stable")] = np.arange(1, count + 1)  # nonzero, and without ties
    edges = _graph(surface.triangles, rank)
    # One more node, outside, beside all outlets.
    rows = np.concatenate([edges.row, outlets])
    columns = np.concatenate([edges.col, np.full(len(outlets), count)])
    weights = np.concatenate([edges.data, rank[outlets]])
    graph = sparse.csr_matrix((weights, (rows, columns)), shape=(count + 1, count + 1))
    tree = minimum_spanning_tree(graph)
    order, parent = breadth_first_order(tree, count, directed=False)
    parent[count] = count
    reached = np.zeros(count + 1, dtype=bool)
    reached[order] = True
    parent = np.where(reached, parent, np.arange(count + 1))
    highest = np.append(rank, 0)
    while (parent != parent[parent]).any():  # twice the way in each turn
        highest = np.maximum(highest, highest[parent])
        parent = parent[parent]
    at_rank = np.argsort(height, kind="stable")
    return np.asarray(at_rank[np.maximum(highest[:count], highest[parent[:count]]).astype(np.int64) - 1])


def _ponds(
    surface: Surface, height: Array, depth: Array, source: Integers, up: Array, least: float
) -> tuple[Depression, ...]:
    """Depressions deeper than a least depth, the deepest first."""
    wet = depth > 0
    graph = _graph(surface.triangles, np.ones(len(height)))
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
