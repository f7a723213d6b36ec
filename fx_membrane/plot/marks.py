"""Lines on membranes: stress trajectories, warp, wrinkles, and hatching of slack cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..checks import validation
from ..model.parts import Membrane
from ..surfaces.shapes import surface_of
from ..surfaces.spread_lines import least_spacing
from ..surfaces.stress_lines import stress_trajectories, wrinkle_lines
from ..surfaces.surface_lines import SurfaceLine, warp_lines
from ..surfaces.tracing import shares_of
from ..surfaces.walking import Terrain
from .subjects import Shown

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

TRAJECTORIES = ("stress I", "stress II", "wrinkles", "slack")
KINDS = ("stress I", "stress II", "warp", "wrinkles", "slack")
NAMES = {
    "stress I": "principal stress I",
    "stress II": "principal stress II",
    "warp": "warp",
    "wrinkles": "wrinkles",
    "slack": "slack",
}
# Inks on the colour of fabric, and on the colours of a field: apart from each other for colour-blind eyes, too.
PLAIN = {"stress I": "#b3400a", "stress II": "#1d4f91", "warp": "#30343b", "wrinkles": "#c957a0", "slack": "#30343b"}
COLOURED = {"stress I": "#000000", "stress II": "#ffffff", "warp": "#ff8c1a", "wrinkles": "#ff3df2", "slack": "#000000"}
WIDTHS = {"stress I": 5.0, "stress II": 5.0, "warp": 5.5, "wrinkles": 6.0, "slack": 4.5}  # [pixels]
DASHED = ("warp",)
BLACK, WHITE = "#000000", "#ffffff"


def border(kind: str, plain: bool) -> str:
    """Colour beside a line, by which it is seen on any ground, also in grey; empty for none."""
    if plain:
        return WHITE if kind == "slack" else ""
    return WHITE if COLOURED[kind] == BLACK else BLACK


class Strokes(NamedTuple):
    """Lines of one kind, fixed to nodes, so that they follow any displacement.

    Attributes:
        kind: One of `KINDS`.
        nodes: Nodes of the cell of each point, shape (k, 3).
        shares: Shares of these nodes, shape (k, 3).
        counts: Number of points of each line, shape (lines,).
    """

    kind: str
    nodes: Integers
    shares: Array
    counts: Integers

    def at(self, points: Array) -> Array:
        """Places of the points of the lines, shape (k, 3) [m]."""
        return np.asarray(np.einsum("kc,kci->ki", self.shares, points[self.nodes]))


def checked_kinds(name: str, given: Any, shown: Shown) -> tuple[str, ...]:
    """Kinds of lines.

    Raises:
        ValueError: One is none of `KINDS`, there is no membrane for it, or no membrane with a warp.
    """
    kinds = validation.texts(name, given)
    for kind in kinds:
        validation.choice(f"{name}, an entry,", kind, KINDS, f"some of {list(KINDS)}")
    membranes = shown.structure.parts_of(Membrane)
    if kinds and not membranes:
        raise ValueError(f"{name} is {list(kinds)}, but the structure has no membrane for them; leave it out.")
    if "warp" in kinds and all(membrane.warp is None for membrane in membranes.values()):
        raise ValueError(
            f"{name} has 'warp', but no membrane has one; give it, Membrane(..., warp=...), or leave it out."
        )
    return kinds


def strokes(shown: Shown, kinds: Sequence[str], spacing: float | None) -> list[Strokes]:
    """Lines of some kinds, each spread evenly; slack cells are left to `hatching`."""
    found = []
    terrain = Terrain(surface_of("lines", shown.shape, None), cut=True) if kinds else None
    for kind in kinds:
        if kind != "slack":
            assert terrain is not None
            lines = _lines(shown, terrain, kind, spacing)
            if kind == "stress I" and "wrinkles" in kinds:
                lines = _outside(lines, shown.cells_that_are("wrinkled"))
            found.append(_fixed(kind, terrain, lines))
    return found


def hatching(points: Array, cells: Integers, across: Array, pitch: float) -> tuple[Array, Integers]:
    """Parallel lines over cells, at least one in each connected region of them.

    Args:
        points: Places of the nodes, shape (n, 3) [m].
        cells: Cells, shape (cells, 3).
        across: Unit vector across the lines, shape (3,).
        pitch: Distance between the lines along this vector [m].

    Returns:
        Ends of the lines in the cells, shape (k, 2, 3), and the cell of each, shape (k,).
    """
    levels = np.sort(points[cells] @ across / pitch, axis=1)
    order = np.argsort(points[cells] @ across, axis=1)
    first = np.ceil(levels[:, 0])
    count = (np.floor(levels[:, 2]) - first + 1).astype(np.int64).clip(0)
    bare = _bare(len(points), cells, count, levels)
    first[bare], count[bare] = levels[bare].mean(axis=1), 1
    owner = np.repeat(np.arange(len(cells)), count)
    level = first[owner] + np.arange(len(owner)) - (np.cumsum(count) - count)[owner]
    low, middle, high = levels[owner].T
    corners = points[np.take_along_axis(cells, order, axis=1)][owner]
    lower = level < middle
    near = np.where(lower[:, None], corners[:, 0], corners[:, 1])
    far = np.where(lower[:, None], corners[:, 1], corners[:, 2])
    start, end = np.where(lower, low, middle), np.where(lower, middle, high)
    tiny = np.finfo(float).tiny
    short = ((level - start) / np.maximum(end - start, tiny))[:, None] * (far - near) + near
    long = ((level - low) / np.maximum(high - low, tiny))[:, None] * (corners[:, 2] - corners[:, 0]) + corners[:, 0]
    return np.stack([short, long], axis=1), owner


def dashes(places: Array, counts: Integers, length: float) -> tuple[Array, Integers]:
    """Cut lines into dashes and gaps of one length.

    Args:
        places: Points of all lines, one line after the other, shape (k, 3) [m].
        counts: Number of points of each line, shape (lines,).
        length: Length of a dash [m].

    Returns:
        Points of the straight pieces of all dashes, two for each, shape (pieces * 2, 3), and their numbers, all two.
    """
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    first = np.cumsum(counts) - counts
    along = (along - np.repeat(along[first], counts)) / length
    piece = np.setdiff1d(np.arange(len(places) - 1), first[1:] - 1)  # from each point to the next of its line
    low, high = along[piece], along[piece + 1]
    start = np.floor(low / 2)
    count = np.where(high > low, np.floor(high / 2) - start + 1, 0).astype(np.int64)
    owner = np.repeat(np.arange(len(piece)), count)
    dash = 2 * (start[owner] + np.arange(len(owner)) - (np.cumsum(count) - count)[owner])
    ends = np.clip(np.stack([dash, dash + 1]), low[owner], high[owner])
    kept = ends[1] > ends[0]
    owner, ends = owner[kept], ends[:, kept]
    share = (ends - low[owner]) / (high - low)[owner]
    one, other = places[piece[owner]], places[piece[owner] + 1]
    found = one + share[..., None] * (other - one)
    return found.swapaxes(0, 1).reshape(-1, 3), np.full(len(owner), 2)


def _bare(count: int, cells: Integers, lines: Integers, levels: Array) -> Integers:
    """Widest cell of each connected region that no line crosses, shape (regions,)."""
    pairs = np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]]])
    graph = sparse.coo_array((np.ones(len(pairs)), tuple(pairs.T)), shape=(count, count))
    region = connected_components(graph, directed=False)[1][cells[:, 0]]
    widest = np.lexsort((levels[:, 0] - levels[:, 2], region))
    one = widest[np.unique(region[widest], return_index=True)[1]]
    return np.asarray(one[np.bincount(region, lines)[region[one]] == 0])


def _lines(shown: Shown, terrain: Terrain, kind: str, spacing: float | None) -> list[SurfaceLine]:
    """Lines of a kind, whose cells count through all membranes."""
    if kind.startswith("stress"):
        return stress_trajectories(shown.shape, spacing=spacing, second=kind == "stress II")
    if kind == "wrinkles":
        return wrinkle_lines(shown.shape, spacing=spacing and max(spacing / 2, least_spacing(terrain)))
    found, before = [], 0
    for name, membrane in shown.structure.parts_of(Membrane).items():
        if membrane.warp is not None:
            lines = warp_lines(shown.shape, part=name, spacing=spacing)
            found += [SurfaceLine(line.points, line.cells + before) for line in lines]
        before += len(membrane.cells)
    return found


def _outside(lines: list[SurfaceLine], cells: NDArray[np.bool_]) -> list[SurfaceLine]:
    """Pieces of lines outside some cells, which have lines of another kind."""
    found = []
    for line in lines:
        kept = np.concatenate([[False], ~cells[line.cells], [False]])
        ends = np.flatnonzero(kept[1:] != kept[:-1]).reshape(-1, 2)
        found += [SurfaceLine(line.points[a : b + 1], line.cells[a:b]) for a, b in ends]
    return found


def _fixed(kind: str, terrain: Terrain, lines: list[SurfaceLine]) -> Strokes:
    if not lines:
        return Strokes(kind, np.zeros((0, 3), dtype=np.int64), np.zeros((0, 3)), np.zeros(0, dtype=np.int64))
    cells = np.concatenate([np.append(line.cells, line.cells[-1]) for line in lines])
    places = np.concatenate([line.points for line in lines])
    counts = np.array([len(line.points) for line in lines])
    return Strokes(kind, terrain.triangles[cells], shares_of(terrain, cells, places), counts)
