"""Drawing of a plan: nodes with a name or a place, and curves through them, divided into segments."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..checks.values import format_point
from .paths import Array, Path

RIM, WITHIN = 0, -1  # loops of curves; holes have 1 and more
SAME_PLACE = 1e-6  # distance over the size of the plan within which places are the same


@dataclass(eq=False)
class Curve:
    """Curve of a plan.

    Attributes:
        paths: Its paths, one after the other.
        ends: Nodes at their ends, one more than paths; those of a closed curve end with the first.
        loop: `RIM`, `WITHIN`, or 1 and more for holes.
        size: Wanted length of its segments [m].
        raised: True if heights between nodes are in proportion to length; False if they are free.
    """

    paths: list[Path]
    ends: list[int]
    loop: int
    size: float
    raised: bool

    def at(self, share: float) -> Array:
        """Point at a share of the length, shape (2,) [m]."""
        lengths = np.array([path.length for path in self.paths])
        before = np.concatenate([[0.0], np.cumsum(lengths)])
        number = min(int(np.searchsorted(before, share * before[-1], side="right")) - 1, len(self.paths) - 1)
        t = (share * before[-1] - before[number]) / lengths[number]
        return self.paths[number].at(np.array([t]))[0]


@dataclass(eq=False)
class Drawing:
    """Nodes and curves of a plan.

    Attributes:
        size: Size of the plan [m].
        points: Places of the nodes, each of shape (2,) [m].
        heights: Their heights, NaN where free [m].
        curves: Curves by name.
        lines: Nodes along each curve divided so far, by its name, shape (k,).
    """

    size: float
    points: list[Array] = field(default_factory=list)
    heights: list[float] = field(default_factory=list)
    curves: dict[str, Curve] = field(default_factory=dict)
    lines: dict[str, NDArray[np.int64]] = field(default_factory=dict)

    def node(self, what: str, place: Array, height: float = np.nan) -> int:
        """Find or add the node at a place, and give it a height unless it is NaN.

        Raises:
            ValueError: There is a node of another height.
        """
        near = np.flatnonzero(
            np.linalg.norm(np.reshape(self.points, (-1, 2)) - place, axis=1) <= SAME_PLACE * self.size
        )
        if not len(near):
            self.points.append(place)
            self.heights.append(height)
            return len(self.points) - 1
        node = int(near[0])
        if np.isnan(self.heights[node]):
            self.heights[node] = height
        elif abs(height - self.heights[node]) > SAME_PLACE * self.size:
            raise ValueError(
                f"{what} has the height {height:g} at {format_point(place)}, where the plan has {self.heights[node]:g} "
                "already; give one height to one place."
            )
        return node

    def divide(self) -> None:
        """Divide the curves into segments; those with heights first, so that others take theirs where they meet."""
        stations = len(self.points)
        for name, curve in sorted(self.curves.items(), key=lambda item: not item[1].raised):
            parts = [self._divided(curve, number, stations) for number in range(len(curve.paths))]
            self.lines[name] = np.concatenate([*(part[:-1] for part in parts), parts[-1][-1:]])

    def _divided(self, curve: Curve, number: int, stations: int) -> NDArray[np.int64]:
        """Nodes along a path, from its first to its last."""
        path, first, last = curve.paths[number], curve.ends[number], curve.ends[number + 1]
        t, distance = path.nearest(np.array(self.points[:stations]))
        on = np.flatnonzero((distance <= SAME_PLACE * self.size) & (t > 0) & (t < 1))
        on = on[(on != first) & (on != last)]
        on = on[np.argsort(t[on])]
        knots = np.array([first, *on, last])
        at = np.array([0.0, *t[on], 1.0])
        for node, place in zip(on, path.at(t[on]), strict=True):
            self.points[node] = place  # exactly on the path
        if curve.raised:
            self._raise(knots, at)
        found = [knots[:1]]
        for a, b, start, end in zip(knots[:-1], knots[1:], at[:-1], at[1:], strict=True):
            pieces = max(1, int(np.ceil((end - start) * path.length / curve.size - 1e-9)))
            share = np.arange(1, pieces) / pieces
            between = range(len(self.points), len(self.points) + pieces - 1)
            self.points.extend(path.at(start + share * (end - start)))
            rise = self.heights[b] - self.heights[a] if curve.raised else np.nan
            self.heights.extend((self.heights[a] + share * rise).tolist())
            found += [np.array(between, dtype=np.int64), np.array([b])]
        return np.concatenate(found).astype(np.int64)

    def _raise(self, knots: NDArray[np.int64], at: Array) -> None:
        """Give heights to the nodes on a path that have none."""
        heights = np.array([self.heights[knot] for knot in knots])
        known = ~np.isnan(heights)
        for knot, height in zip(knots, np.interp(at, at[known], heights[known]), strict=True):
            self.heights[knot] = float(height)
