"""Membranes of a structure split along seams, with the cables, supports and data on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.line_order import path_along
from ..geometry.topology import boundary_edges
from ..model.parts import Line, Membrane, Part
from ..model.structure import Structure
from ..model.supports import Support
from ..surfaces.shapes import Surface
from ..surfaces.surface_lines import SurfaceLine
from .seam_sites import laid, sites_of
from .split_mesh import Pair, SplitMesh, pair
from .strip_edges import CORNER

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

SNAPS = (0.05, 5e-3, 5e-4)  # distance of seams from nodes over the shortest edge there; less where seams would meet


class Split(NamedTuple):
    """Structure with its membranes split along seams, not yet in strips.

    Attributes:
        structure: The structure; its own nodes keep their numbers.
        seams: Number of the seam on each edge that is on one, by the nodes of the edge, ascending.
        mesh: The cells of all membranes.
    """

    structure: Structure
    seams: dict[Pair, int]
    mesh: SplitMesh


class _SeamsMeetError(ValueError):
    """Two seams are on the same edge."""


def split_along(structure: Structure, seams: Sequence[SurfaceLine | str], parts: Sequence[str], finest: bool) -> Split:
    """Split membranes along seams.

    Args:
        structure: The structure.
        seams: Lines on its membranes, or names of cables along them.
        parts: Names of the membranes that seams divide.
        finest: Move seams to nodes within the least of `SNAPS` only, apart from corners of the rim: an edge between
            a seam and a corner beside it would set the size of cells.

    Raises:
        ValueError: A seam leaves the surface, crosses itself, or coincides with another one.
    """
    lines = [_places(structure, number, seam) for number, seam in enumerate(seams)]
    snaps = [(SNAPS[-1], SNAPS[0]), (SNAPS[-1], SNAPS[-1])] if finest else [(snap, snap) for snap in SNAPS]
    for snap, at_corners in snaps:
        try:
            mesh, edges = _laid(structure, lines, parts, snap, at_corners)
            break
        except _SeamsMeetError as meeting:
            if at_corners == SNAPS[-1]:
                raise ValueError(str(meeting)) from None
    return Split(_rebuilt(structure, mesh), edges, mesh)


def _places(structure: Structure, number: int, seam: Any) -> Array:
    """Places along a seam, shape (k, 3) [m]."""
    if isinstance(seam, str):
        if seam not in structure.bars:
            lines = list(structure.bars)
            raise ValueError(f"seams, entry {number}, is {seam!r}, which is no cable; those are {lines}.")
        try:
            return structure.points[path_along(structure.parts[seam].cells)]
        except ValueError as error:
            raise ValueError(f"seams, entry {number}, is {seam!r}: {error}.") from None
    if not isinstance(seam, SurfaceLine):
        raise ValueError(
            f"seams, entry {number}, is {validation.short_repr(seam)}; give lines, as of geodesic(...) and "
            "planar_cut(...), or names of cables."
        )
    apart = np.append(True, np.diff(seam.points, axis=0).any(axis=1))
    if apart.sum() < 2:
        where = validation.format_point(seam.points[0])
        raise ValueError(f"seams, entry {number}, at {where}, has no length; leave it out.")
    return np.asarray(seam.points[apart])


def _laid(
    structure: Structure, lines: list[Array], parts: Sequence[str], snap: float, at_corners: float
) -> tuple[SplitMesh, dict[Pair, int]]:
    """Lay all seams on the membranes."""
    members = structure.parts_of(Membrane)
    mesh = SplitMesh(structure.points, np.concatenate([member.cells for member in members.values()]), snap)
    counts = [len(member.cells) for member in members.values()]
    starts = dict(zip(members, np.cumsum([0, *counts]).tolist(), strict=False))
    chosen = np.concatenate([starts[name] + np.arange(len(members[name].cells)) for name in parts])
    surface = Surface(structure.points, mesh.facets[chosen])
    shortest = _shortest_edges(surface)
    shortest[_rim_corners(surface)] *= at_corners / snap
    outer = {pair(a, b) for name in parts for a, b in boundary_edges(members[name].cells).tolist()}
    along = []
    for number, places in enumerate(lines):
        sites = sites_of(surface, number, places, snap, shortest)
        along.append(laid(mesh, [site._replace(facet=int(chosen[site.facet])) for site in sites]))
        _check_itself(mesh, number, along[-1])
    edges: dict[Pair, int] = {}
    for number, nodes in enumerate(along):
        split = [edge for a, b in pairwise(nodes) for edge in pairwise(_chain(mesh, a, b))]  # where later seams cross
        for edge in [pair(a, b) for a, b in split]:
            if edges.setdefault(edge, number) != number:
                there = validation.format_point((mesh.at(edge[0]) + mesh.at(edge[1])) / 2)
                raise _SeamsMeetError(
                    f"seams, entries {edges[edge]} and {number}, coincide at {there}; leave one out, or end it at the "
                    "other."
                )
    inner = {edge: number for edge, number in edges.items() if not _is_outer(mesh, edge, outer)}
    rim = {pair(a, b) for a, b in boundary_edges(surface.triangles).tolist()}
    for number in sorted(set(edges.values()) - set(inner.values())):
        if all(_is_outer(mesh, edge, rim) for edge, other in edges.items() if other == number):
            where = validation.format_point(lines[number].mean(axis=0))
            raise ValueError(f"seams, entry {number}, runs along the border around {where}; leave it out.")
    return mesh, inner


def _check_itself(mesh: SplitMesh, number: int, nodes: list[int]) -> None:
    inner = nodes[:-1] if nodes[0] == nodes[-1] else nodes
    seen: set[int] = set()
    for node in inner:
        if node in seen:
            raise ValueError(
                f"seams, entry {number}, crosses itself at {validation.format_point(mesh.at(node))}; make it of two."
            )
        seen.add(node)


def _is_outer(mesh: SplitMesh, edge: Pair, outer: set[Pair]) -> bool:
    """Return True for an edge on a border, where a seam divides nothing."""
    if edge in outer:
        return True
    for node, other in (edge, edge[::-1]):
        corners = mesh.between.get(node, ())
        if len(corners) == 2 and other in corners:
            return _is_outer(mesh, pair(*corners), outer)
    return False


def _shortest_edges(surface: Surface) -> Array:
    """Length of the shortest edge at each node, infinite off the surface, shape (n,) [m]."""
    found = np.full(len(surface.points), np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        ends = surface.triangles[:, [a, b]]
        length = np.linalg.norm(surface.points[ends[:, 0]] - surface.points[ends[:, 1]], axis=1)
        np.minimum.at(found, ends[:, 0], length)
        np.minimum.at(found, ends[:, 1], length)
    return found


def _rim_corners(surface: Surface) -> Integers:
    """Nodes at which the rim has a corner, shape (n,)."""
    points, rim = surface.points, boundary_edges(surface.triangles)
    before, after = np.full((2, len(points)), -1)
    before[rim[:, 1]], after[rim[:, 0]] = rim.T
    nodes = np.flatnonzero((before >= 0) & (after >= 0))
    a, b = points[nodes] - points[before[nodes]], points[after[nodes]] - points[nodes]
    turn = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
    return nodes[turn > CORNER]


def _rebuilt(structure: Structure, mesh: SplitMesh) -> Structure:
    """Structure with the cells of a split mesh."""
    cells, parent = np.array(mesh.cells), np.array(mesh.parent)
    order = np.argsort(parent, kind="stable")
    cells, parent = cells[order], parent[order]
    parts: dict[str, Part] = {}
    first = 0
    membranes, bars = structure.membranes, structure.bars
    for name in structure.parts:
        if name in membranes:
            count = len(membranes[name].cells)
            mine = (parent >= first) & (parent < first + count)
            parts[name] = of_rows(membranes[name], cells[mine], parent[mine] - first)
            first += count
        else:
            parts[name] = _line(bars[name], mesh)
    return replace(structure, points=mesh.points, parts=parts, supports=_supports(structure, mesh))


def of_rows(part: Membrane, cells: Integers, rows: Integers) -> Membrane:
    """Membrane of other cells, with the data per cell of some rows of the old ones."""
    count = len(part.cells)
    changes: dict[str, Any] = {}
    if part.warp is not None and np.ndim(part.warp) == 2:
        changes["warp"] = np.asarray(part.warp)[rows]
    for name, tensors in (("prestress", part.prestress_tensors()), ("natural_stretch", part.natural_tensors())):
        if tensors.strides[0] or (len(tensors) == 1 < count):
            changes[name] = tensors[rows]
        elif np.shape(getattr(part, name)) not in ((), (1,), (2,), (2, 2)):
            changes[name] = tensors[0]
    return replace(part, cells=cells, **changes)


def _line(part: Line, mesh: SplitMesh) -> Part:
    """Cable, mast or rope with the new nodes of its edges."""
    if part.shares_tension:
        path = part.nodes.tolist()
        pieces = [_chain(mesh, a, b)[1:] for a, b in pairwise(path)]
        return replace(part, nodes=np.concatenate([path[:1], *pieces]))
    chains = [_chain(mesh, a, b) for a, b in part.cells.tolist()]
    counts = [len(chain) - 1 for chain in chains]
    changes: dict[str, Any] = {"cells": np.concatenate([np.column_stack([chain[:-1], chain[1:]]) for chain in chains])}
    for name in ("prestress", "natural_stretch"):
        if np.ndim(getattr(part, name)):
            changes[name] = np.repeat(getattr(part, name), counts)
    return replace(part, **changes)


def _chain(mesh: SplitMesh, a: int, b: int) -> list[int]:
    """Nodes along an edge that may be split, both ends included."""
    middle = mesh.midpoints.get(pair(a, b))
    return [a, b] if middle is None else [*_chain(mesh, a, middle), *_chain(mesh, middle, b)[1:]]


def _supports(structure: Structure, mesh: SplitMesh) -> list[Support]:
    """Supports, with the new nodes on edges and in cells that they hold."""
    lines = {pair(a, b) for part in structure.bars.values() for a, b in part.cells.tolist()}
    for part in structure.parts_of(Membrane).values():
        lines |= {pair(a, b) for a, b in boundary_edges(part.cells).tolist()}
    on = {node for line in lines for node in line}
    held = [set(np.asarray(support.nodes).ravel().tolist()) for support in structure.supports]
    more: list[list[int]] = [[] for _ in held]
    for node, corners in mesh.between.items():  # in the order in which they were made
        along = len(corners) == 2 and pair(*corners) in lines
        if along:
            lines |= {pair(corners[0], node), pair(node, corners[1])}
            on.add(node)
        across = not along and on.issuperset(corners)  # from rim to rim, where only the rim is held
        for nodes, new in zip(held, more, strict=True):
            if not across and nodes.issuperset(corners):
                nodes.add(node)
                new.append(node)
    return [
        Support(np.append(np.asarray(support.nodes, dtype=np.int64), new).astype(np.int64), support.components)
        for support, new in zip(structure.supports, more, strict=True)
    ]
