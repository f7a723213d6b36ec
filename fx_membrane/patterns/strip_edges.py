"""Seams and borders of strips: lines of mesh edges between their ends and corners."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.line_order import lines_between
from ..model.structure import Structure
from ..surfaces.feature_lines import CORNER_ANGLE
from .split_mesh import Pair, pair
from .strips import Edge

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CORNER = 1.1 * CORNER_ANGLE  # angle between segments of a border from which on there is a corner [rad]


class _Kind(NamedTuple):
    """Kind of a mesh edge: strips beside, line part along, held or not; edges of strips are of one kind."""

    strips: tuple[int, ...]
    line: str | None
    held: bool


def edges_of_strips(
    structure: Structure, names: list[str], strip: Integers, cells: Integers, seams: set[Pair]
) -> tuple[Edge, ...]:
    """Edges of all strips, seams first, in the order of the strips.

    Args:
        structure: The structure in strips.
        names: Names of the strips.
        strip: Number of the strip of each cell, shape (cells,).
        cells: Cells of all strips, shape (cells, 3).
        seams: Edges on seams, by their nodes, ascending.
    """
    kinds, left = _kinds(structure, strip, cells, seams)
    chains = _chains(structure.points, kinds)
    found = []
    for chain in chains:
        kind = kinds[pair(chain[0], chain[1])]
        nodes = chain if left.get((chain[0], chain[1])) == kind.strips[0] else chain[::-1]
        found.append((len(kind.strips) < 2, kind.strips, nodes, kind))
    found.sort(key=lambda entry: entry[:2])
    count = {False: 0, True: 0}
    edges = []
    for border, strips, nodes, kind in found:
        count[border] += 1
        name = f"{'border' if border else 'seam'} {count[border]}"
        edges.append(Edge(name, np.array(nodes), tuple(names[number] for number in strips), kind.line, kind.held))
    return tuple(edges)


def _kinds(
    structure: Structure, strip: Integers, cells: Integers, seams: set[Pair]
) -> tuple[dict[Pair, _Kind], dict[Pair, int]]:
    """Kinds of the mesh edges at the rims of strips, and strips to the left of them, by their nodes."""
    ends = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]])
    owner = np.tile(strip, 3)
    low, high = ends.min(axis=1), ends.max(axis=1)
    code = low * len(structure.points) + high
    order = np.lexsort((owner, code))
    new = np.append(True, np.diff(code[order]) != 0)
    of_strip = np.cumsum(new | np.append(True, np.diff(owner[order]) != 0)) - 1
    inner = np.bincount(of_strip)[of_strip] == 2  # in a cushion, edges between nodes of its rim are so in both films
    pairs = np.column_stack([low, high])[order[new]].tolist()
    on_seam = np.array([(a, b) in seams for a, b in pairs])
    chosen = order[~inner | on_seam[np.cumsum(new) - 1]]
    held = structure.supported.all(axis=1)
    lines = {pair(a, b): name for name, part in reversed(structure.bars.items()) for a, b in part.cells.tolist()}
    kinds: dict[Pair, _Kind] = {}
    left: dict[Pair, int] = {}
    sides: dict[Pair, list[int]] = defaultdict(list)
    for row in chosen.tolist():
        a, b = ends[row].tolist()
        sides[pair(a, b)].append(int(owner[row]))
        left.setdefault((a, b), int(owner[row]))
    for (a, b), strips in sides.items():
        kinds[a, b] = _Kind(tuple(sorted(strips)), lines.get((a, b)), bool(held[a] and held[b]))
    return kinds, left


def _chains(points: Array, kinds: dict[Pair, _Kind]) -> list[list[int]]:
    """Lines of mesh edges of one kind between ends and corners; closed ones end where they begin."""
    meeting: dict[int, list[int]] = defaultdict(list)
    for a, b in kinds:
        meeting[a].append(b)
        meeting[b].append(a)
    return lines_between(kinds, {node for node in meeting if _is_end(points, kinds, node, meeting[node])})


def _is_end(points: Array, kinds: dict[Pair, _Kind], node: int, others: list[int]) -> bool:
    if len(others) != 2:
        return True
    first, second = (kinds[pair(node, other)] for other in others)
    if first != second:
        return True
    if len(first.strips) > 1:
        return False
    before, after = points[node] - points[others[0]], points[others[1]] - points[node]
    return bool(np.arctan2(np.linalg.norm(np.cross(before, after)), before @ after) > CORNER)
