"""Coincident nodes that no part shares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..checks import validation
from .parts import Part

COINCIDENT = 1e-9  # distance, relative to the size of the structure
LINE = np.sqrt([0.2, 0.3, 0.5])  # a direction of length one; the nodes of a regular grid are apart along it


class CoincidentNodesWarning(UserWarning):
    """Coincident nodes that no part shares: shared nodes join parts, equal positions do not."""


def checked_pairs(separate: Any, parts: Mapping[str, Part]) -> tuple[tuple[str, str], ...]:
    """Pairs of names of parts that may coincide.

    Args:
        separate: The pairs as given.
        parts: Parts by name.

    Raises:
        ValueError: They are no pairs of names, or a part is not there.
    """
    pairs: Sequence[Any] = separate if isinstance(separate, list | tuple) else [separate]
    for pair in pairs:
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            raise ValueError(f'separate has {validation.short_repr(pair)}; give pairs of names, [("top", "bottom")].')
        for name in pair:
            if not isinstance(name, str) or name not in parts:
                raise ValueError(
                    f"separate names part {validation.short_repr(name)}, which does not exist; those are {list(parts)}."
                )
    return tuple((validation.text("separate", a), validation.text("separate", b)) for a, b in pairs)


def coincident_nodes(
    points: NDArray[np.float64],
    parts: Mapping[str, Part],
    fixed: NDArray[np.bool_],
    separate: Sequence[tuple[str, str]],
) -> str:
    """Sentence on coincident nodes that are not all fixed; empty if there are none.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        parts: Parts by name.
        fixed: Nodes constrained in all components, shape (n,).
        separate: Pairs of names of parts whose nodes may coincide.
    """
    using = {name: np.zeros(len(points), dtype=bool) for name in parts}
    for name, part in parts.items():
        using[name][part.cells] = True
    used = np.flatnonzero(np.any(list(using.values()), axis=0))
    size = np.ptp(points[used], axis=0).max()
    used = _near_others(points, used, COINCIDENT * size)
    pairs = used[cKDTree(points[used]).query_pairs(COINCIDENT * size, output_type="ndarray")]
    pairs = np.sort(pairs[~fixed[pairs].all(axis=1)], axis=1)
    for first, second in separate:
        a, b = using[first][pairs], using[second][pairs]
        pairs = pairs[~((a[:, 0] & b[:, 1]) | (a[:, 1] & b[:, 0]))]
    if not len(pairs):
        return ""
    a, b = pairs[np.lexsort(pairs.T[::-1])[0]]
    count = f" ({len(pairs)} pairs in all)" if len(pairs) > 1 else ""
    (first, one), (second, other) = _first_cell(parts, a), _first_cell(parts, b)
    return (
        f"Nodes {a} and {b} are at the same place, {validation.format_point(points[a])}, but nothing joins "
        f"them{count}: cell {one} of {first!r} and cell {other} of {second!r} can part there. To join them, give all "
        f"cells that meet there the same node number; if they are meant to be apart, say so by "
        f"separate=[({first!r}, {second!r})]."
    )


def _near_others(points: NDArray[np.float64], nodes: NDArray[np.intp], distance: float) -> NDArray[np.intp]:
    """Nodes with another within a distance along a line, ascending: all that are as close in space, and few others."""
    along = (points[nodes] - points[nodes[0]]) @ LINE
    order = np.argsort(along)
    near = np.diff(along[order]) <= 2 * distance  # twice, for rounding
    return np.sort(nodes[order[np.append(near, False) | np.append(False, near)]])


def _first_cell(parts: Mapping[str, Part], node: int) -> tuple[str, int]:
    """Name of the first part at a node, and its first cell there."""
    for name, part in parts.items():
        cells = np.flatnonzero((part.cells == node).any(axis=1))
        if len(cells):
            return name, int(cells[0])
    raise AssertionError("no part uses the node")
