"""Cells by name as drawings have them: corners that may coincide, triangles, quadrilaterals and lines in one group."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..checks import validation
from ..checks.values import counted
from ..runtime.messages import say

Array = NDArray[np.float64]
Cells = NDArray[np.int64]
SAME_NODE = 1e-9  # of the size of the drawing: corners nearer than that are one node in any file
KINDS = {1: "points", 2: "lines", 3: "triangles", 4: "quadrilaterals"}


@dataclass
class Drawing:
    """Content of a drawing.

    Attributes:
        source: Name of the file, for messages.
        group: Name of a group in messages, as "layer".
        points: Positions of all corners, shape (n, 3).
        cells: By name of the group and number of corners (1 for points), rows of corners, shape (cells, corners).
        unit: Name of the unit of length that the file tells; empty if it tells none.
        refused: By name of the group, the sentence that refuses it: it has a curve or a face that is no cell.
        left_out: By kind of entity, the number of those that are no cells, as texts.
        hidden: Names of groups that are other names of cells listed elsewhere; they can be asked for.
        loose: True if each cell has corners of its own: those at the same place are one node.
    """

    source: str
    group: str
    points: Array
    cells: dict[str, dict[int, Cells]] = field(default_factory=dict)
    unit: str = ""
    loose: bool = False
    refused: dict[str, str] = field(default_factory=dict)
    left_out: dict[str, int] = field(default_factory=dict)
    hidden: set[str] = field(default_factory=set)

    @property
    def names(self) -> list[str]:
        """Names of the groups."""
        return [name for name in self.cells if name not in self.hidden]

    def add(self, name: str, cells: Cells) -> None:
        """Add cells of one kind to a group."""
        groups = self.cells.setdefault(name, {})
        corners = cells.shape[1]
        groups[corners] = np.vstack([groups[corners], cells]) if corners in groups else cells


def check(drawing: Drawing) -> None:
    """Refuse points that are no numbers, and cells of corners that do not exist or of too many.

    Raises:
        ValueError: The drawing has one; the message names file, group, cell and corner.
    """
    bad = np.flatnonzero(~np.isfinite(drawing.points).all(axis=1))
    if len(bad):
        raise ValueError(f"{drawing.source}: point {bad[0]} is {drawing.points[bad[0]].tolist()}; give finite numbers.")
    last = len(drawing.points) - 1
    for name, groups in drawing.cells.items():
        for corners, cells in groups.items():
            what = f"{drawing.source}: {drawing.group} {name!r}"
            if corners not in KINDS:
                raise ValueError(f"{what} has cells with {corners} corners; give triangles or quadrilaterals.")
            wrong = np.argwhere((cells < 0) | (cells > last))
            if len(wrong):
                cell, corner = wrong[0]
                raise ValueError(
                    f"{what}, cell {cell} of its {KINDS[corners]}, has the corner {cells[cell, corner]}, which does "
                    f"not exist; there are {len(drawing.points)} points, from 0. Mend the number or add the point."
                )


def joined(drawing: Drawing, weld: float | None) -> Drawing:
    """Drawing with one node for loose corners at the same place; with a tolerance, for all within it of each other.

    Says on stderr how many were joined by the tolerance, and the largest distance.

    Raises:
        ValueError: A cell loses its size: two of its corners are joined.
    """
    points = drawing.points
    if not len(points) or not (drawing.loose or weld is not None):
        return drawing
    exact = SAME_NODE * max(np.ptp(points, axis=0).max(), np.finfo(float).tiny)
    label, count = _clusters(points, exact)
    if weld is not None:
        label, merged = _clusters(points, max(weld, exact))
        if merged < count:
            first = np.full(merged, len(points))
            np.minimum.at(first, label, np.arange(len(points)))
            moved = np.linalg.norm(points - points[first[label]], axis=1)
            say(
                f"{drawing.source}: {count} nodes joined to {merged} within {weld:g}; "
                f"the farthest moved by {moved.max():.3g}."
            )
    rows = np.unique(label, return_index=True)[1]  # of each cluster, the first corner
    order = np.argsort(rows)
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.arange(len(rows))
    cells = {
        name: {corners: number[label[rows_]] for corners, rows_ in groups.items()}
        for name, groups in drawing.cells.items()
    }
    found = replace(drawing, points=points[rows[order]], cells=cells, loose=False)
    for name, groups in cells.items():
        for corners, rows_ in groups.items():
            _refuse_collapsed(found, name, drawing.points[drawing.cells[name][corners]], rows_)
    return found


def triangles_of(drawing: Drawing, name: str, split: bool) -> Cells:
    """Cells of a group: its lines, shape (n, 2), or its triangles, shape (n, 3), quadrilaterals split on request.

    A quadrilateral is split along its shorter diagonal; a concave one along the diagonal within it.

    Raises:
        ValueError: There is no group of that name; it has no lines or faces, or both; it has quadrilaterals that are
            not to be split.
    """
    groups = {corners: cells for corners, cells in _group(drawing, name).items() if corners > 1 and len(cells)}
    if not groups:
        raise ValueError(f"{drawing.source}: {drawing.group} {name!r} has no lines or faces to make a part of.")
    if 2 in groups and len(groups) > 1:
        raise ValueError(
            f"{drawing.source}: {drawing.group} {name!r} has lines and faces; a part is of one kind, put them on two."
        )
    if 4 not in groups:
        return next(iter(groups.values()))
    if not split:
        raise ValueError(
            f"{drawing.source}: {drawing.group} {name!r} has {counted(len(groups[4]), 'quadrilateral')}; split by "
            "split_quadrilaterals, True in a script and true in a case file."
        )
    corners = groups[4]
    turned = np.where(_along_first(drawing.points[corners])[:, None], corners, np.roll(corners, -1, axis=1))
    halves = np.stack([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]], axis=1).reshape(-1, 3)
    return np.vstack([groups[3], halves]) if 3 in groups else halves


def _along_first(places: Array) -> NDArray[np.bool_]:
    """Tell quadrilaterals to split from their first corner, shape (n,), by the places of all, shape (n, 4, 3)."""
    first, second = places[:, 2] - places[:, 0], places[:, 3] - places[:, 1]
    normal = np.cross(first, second)  # twice the vector area, whatever the bend

    def within(diagonal: Array, start: Array, one: Array, other: Array) -> NDArray[np.bool_]:
        """Return True where the other two corners lie on different sides of a diagonal."""
        sides = [np.einsum("ni,ni->n", np.cross(diagonal, end - start), normal) for end in (one, other)]
        return np.asarray(sides[0] * sides[1] < 0)

    inner = within(first, places[:, 0], places[:, 1], places[:, 3])
    shorter = np.linalg.norm(first, axis=1) <= np.linalg.norm(second, axis=1)
    both = inner == within(second, places[:, 1], places[:, 2], places[:, 0])
    return np.where(both, shorter, inner)


def nodes_of(drawing: Drawing, name: str) -> Cells:
    """Nodes of a group: those of its points, or else of its lines and faces, shape (n,).

    Raises:
        ValueError: There is no group of that name.
    """
    groups = _group(drawing, name)
    chosen = [groups[1]] if 1 in groups else list(groups.values())
    return np.unique(np.concatenate([cells.ravel() for cells in chosen]))


def _group(drawing: Drawing, name: str) -> dict[int, Cells]:
    if name in drawing.refused:
        raise ValueError(drawing.refused[name])
    if name not in drawing.cells:
        raise ValueError(f"{drawing.source} has no {drawing.group} {name!r}; it has {sorted(drawing.names)}.")
    return drawing.cells[name]


def _clusters(points: Array, distance: float) -> tuple[NDArray[np.int64], int]:
    """Cluster of each point, those within a distance of each other in one, and the number of clusters."""
    from scipy.sparse import coo_matrix  # noqa: PLC0415
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

    pairs = cKDTree(points).query_pairs(distance, output_type="ndarray")
    shape = (len(points), len(points))
    graph = coo_matrix((np.ones(len(pairs), dtype=bool), (pairs[:, 0], pairs[:, 1])), shape=shape)
    count, label = connected_components(graph, directed=False)
    return label.astype(np.int64), int(count)


def _refuse_collapsed(drawing: Drawing, name: str, corners: Array, cells: Cells) -> None:
    ordered = np.sort(cells, axis=1)
    bad = np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))
    if len(bad):
        where = validation.format_point(corners[bad[0]].mean(axis=0))
        raise ValueError(
            f"{drawing.source}: {drawing.group} {name!r} has {len(bad)} of {len(cells)} "
            f"{KINDS[cells.shape[1]]} with two corners in one node, the first at {where}; "
            "weld within less, or remove it from the drawing."
        )
