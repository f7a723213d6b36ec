"""Lines of edges that a new mesh of a structure keeps: rims, seams, cables along membranes, held lines."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..geometry.topology import boundary_edges
from ..model.structure import Structure

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CORNER_ANGLE = np.pi / 6  # largest angle between segments of a line; of the old line, that of a corner


class Patch(NamedTuple):
    """Connected piece of a membrane: its name, and the rows of its cells."""

    part: str
    rows: Integers


@dataclass(frozen=True, eq=False)
class Features:
    """Edges that a new mesh keeps, in lines, and nodes that it keeps.

    Attributes:
        patches: Connected pieces of membranes.
        lines: Old nodes along each line, shape (k,); those of a closed one end with the first.
        owners: For each line, what its edges belong to: ("rim", patch), ("bar", name) and ("held", support).
        nodes: Old nodes that remain, shape (k,).
        bars: For each cable or mast along lines, its cell on an edge, by the nodes of the edge, ascending.
        loose: Rows of the cells of each bar that are on no membrane.
    """

    patches: list[Patch]
    lines: list[Integers]
    owners: list[frozenset[tuple[str, object]]]
    nodes: Integers
    bars: dict[str, dict[tuple[int, int], int]]
    loose: dict[str, Integers]


def features(structure: Structure, keep: Integers) -> Features:
    """Find the lines and nodes that a new mesh keeps; `keep` has further nodes, shape (k,)."""
    patches = _patches(structure)
    owners: dict[tuple[int, int], set[tuple[str, object]]] = defaultdict(set)
    for number, patch in enumerate(patches):
        for edge in _pairs(boundary_edges(structure.parts[patch.part].cells[patch.rows])):
            owners[edge].add(("rim", number))
    fabric = _edges(np.concatenate([structure.parts[patch.part].cells[patch.rows] for patch in patches]))
    bars, loose = {}, {}
    for name, part in structure.bars.items():
        on = [edge in fabric for edge in _pairs(part.cells)]
        loose[name] = np.flatnonzero(~np.array(on))
        bars[name] = {edge: row for row, edge in enumerate(_pairs(part.cells)) if on[row]}
        for edge in bars[name]:
            owners[edge].add(("bar", name))
    on_rim = [edge for edge, names in owners.items() if any(kind == "rim" for kind, _ in names)]
    rim = np.unique(np.array(on_rim, dtype=np.int64))  # empty of closed membranes
    for number, support in enumerate(structure.supports):
        for edge in _held_edges(structure, patches, np.asarray(support.nodes), rim, owners):
            owners[edge].add(("held", number))
    ends = _ends(structure, owners, keep, loose)
    lines = _lines(structure.points, {edge: frozenset(names) for edge, names in owners.items()}, ends)
    corners = np.unique([*ends, *(line[0] for line, _ in lines), *(line[-1] for line, _ in lines)]).astype(np.int64)
    return Features(patches, [line for line, _ in lines], [names for _, names in lines], corners, bars, loose)


def _pairs(cells: NDArray[np.int64]) -> list[tuple[int, int]]:
    return [(a, b) for a, b in np.sort(cells, axis=1).tolist()]


def _edges(triangles: Integers) -> set[tuple[int, int]]:
    return set(_pairs(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])))


def _patches(structure: Structure) -> list[Patch]:
    """Pieces of membranes whose cells share edges."""
    found = []
    for name, part in structure.membranes.items():
        n, cells = len(part.cells), part.cells
        sides = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
        _, edge = np.unique(sides, axis=0, return_inverse=True)
        owner = np.tile(np.arange(n), 3)
        links = sparse.coo_matrix((np.ones(3 * n), (owner, n + edge.ravel())), shape=(n + 3 * n, n + 3 * n))
        label = connected_components(links, directed=False)[1][:n]
        found += [Patch(name, np.flatnonzero(label == piece)) for piece in np.unique(label)]
    return found


def _held_edges(
    structure: Structure, patches: list[Patch], nodes: Integers, rim: Integers, owners: Iterable[tuple[int, int]]
) -> set[tuple[int, int]]:
    """Edges with both ends held: those of other lines, and those that reach into a membrane, save of held cells."""
    held = np.zeros(len(structure.points), dtype=bool)
    held[nodes] = True
    found = {edge for edge in owners if held[edge[0]] and held[edge[1]]}
    inner = held.copy()
    inner[rim] = False
    for patch in patches:
        cells = structure.parts[patch.part].cells[patch.rows]
        whole = held[cells].all(axis=1)
        chosen = _edges(cells[held[cells].any(axis=1)]) - _edges(cells[whole]) if held[cells].any() else set()
        found |= {(a, b) for a, b in chosen if held[a] and held[b] and (inner[a] or inner[b])}
    return found


def _ends(
    structure: Structure,
    owners: dict[tuple[int, int], set[tuple[str, object]]],
    keep: Integers,
    loose: dict[str, Integers],
) -> set[int]:
    """Nodes that remain: ends of lines, corners, nodes held alone, nodes of other bars."""
    meeting: dict[int, list[int]] = defaultdict(list)
    for a, b in owners:
        meeting[a].append(b)
        meeting[b].append(a)
    ends = set(keep.tolist())
    for name, rows in loose.items():
        ends |= set(structure.parts[name].cells[rows].ravel().tolist())
    for number, support in enumerate(structure.supports):
        lines = {node for edge, names in owners.items() if ("held", number) in names for node in edge}
        ends |= set(np.asarray(support.nodes).tolist()) - lines - _areas(structure, np.asarray(support.nodes))
    for node, others in meeting.items():
        if len(others) != 2:
            ends.add(node)
            continue
        first, second = (owners[min(node, other), max(node, other)] for other in others)
        before, after = (
            structure.points[node] - structure.points[others[0]],
            (structure.points[others[1]] - structure.points[node]),
        )
        bend = np.arctan2(np.linalg.norm(np.cross(before, after)), before @ after)
        if first != second or bend > CORNER_ANGLE * 1.1:
            ends.add(node)
    return ends


def _areas(structure: Structure, nodes: Integers) -> set[int]:
    """Nodes of cells that are held as a whole, within a membrane."""
    found: set[int] = set()
    for part in structure.membranes.values():
        whole = np.isin(part.cells, nodes).all(axis=1)
        inner = ~np.isin(part.cells, boundary_edges(part.cells)).all(axis=1)
        found |= set(part.cells[whole & inner].ravel().tolist())
    return found


def _lines(
    points: Array, owners: dict[tuple[int, int], frozenset[tuple[str, object]]], ends: set[int]
) -> list[tuple[Integers, frozenset[tuple[str, object]]]]:
    """Lines of edges between ends, and closed ones without any."""
    meeting: dict[int, list[int]] = defaultdict(list)
    for a, b in sorted(owners):
        meeting[a].append(b)
        meeting[b].append(a)
    left, found = set(owners), []
    for start in [*sorted(ends & meeting.keys()), *sorted(meeting)]:  # closed lines come last
        for following in meeting[start]:
            if (min(start, following), max(start, following)) not in left:
                continue
            line = [start, following]
            left.discard((min(line), max(line)))
            while line[-1] not in ends and line[-1] != start:
                line.append(
                    next(node for node in meeting[line[-1]] if (min(node, line[-1]), max(node, line[-1])) in left)
                )
                left.discard((min(line[-2:]), max(line[-2:])))
            found.append((np.array(line), owners[min(line[:2]), max(line[:2])]))
    return found


class Division(NamedTuple):
    """New nodes along a line.

    Attributes:
        edge: For each new node, the old edge that it is on, from 0, shape (m,).
        share: Its share of that edge, shape (m,) [-].
    """

    edge: Integers
    share: Array


def divided(points: Array, size: Callable[[Array], Array]) -> Division:
    """Divide a line into pieces of a size, its ends included, with at least as many as its curvature needs.

    Args:
        points: Places along the line, shape (k, 3) [m]; of a closed one the last is the first.
        size: Wanted size at places, shape (m, 3) to (m,) [m].
    """
    sides = np.diff(points, axis=0)
    length = np.linalg.norm(sides, axis=1)
    closed = np.array_equal(points[0], points[-1])
    before, after = sides[:-1], sides[1:]
    if closed:
        before, after = sides, np.roll(sides, -1, axis=0)
    sine, cosine = np.linalg.norm(np.cross(before, after), axis=1), np.sum(before * after, axis=1)
    turns = int(np.ceil(np.arctan2(sine, cosine).sum() / CORNER_ANGLE - 1e-6))
    count = np.append(0.0, np.cumsum(length / size((points[:-1] + points[1:]) / 2)))
    pieces = max(1, 3 * closed, int(np.ceil(count[-1] - 1e-6)), min(turns, len(sides)))
    at = np.linspace(0, count[-1], pieces + 1)
    edge = np.searchsorted(count, at[1:-1], side="right") - 1
    share = (at[1:-1] - count[edge]) / np.diff(count)[edge]
    return Division(np.concatenate([[0], edge, [len(sides) - 1]]), np.concatenate([[0.0], share, [1.0]]))
