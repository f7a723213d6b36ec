"""Water on a surface in numbers and words: depressions that hold it, slopes that it runs along."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..results.water_words import with_unit
from ..runtime.notebook_pictures import table

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

LEVEL = 1e-9  # slope that is rounding


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

    Example:
        >>> points, triangles = rectangle(8.0, 8.0, 8, 8)
        >>> points[:, 2] = 0.05 * (points[:, 0] ** 2 + points[:, 1] ** 2)  # a bowl, lowest on the rim at 0.8
        >>> pond = drainage((points, triangles)).depressions[0]
        >>> pond.place.tolist(), round(pond.depth, 6), round(pond.level, 6)
        ([0.0, 0.0, 0.0], 0.8, 0.8)
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
        valleys: Edges that water of the cells at them runs into, and then along, shape (k, 2); those of walls, too.
        valley_slope: Slope of each, shape (k,) [-].
        length_unit: Name of the length unit, in words and tables.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 4, 2)
        >>> points[:, 2] = 0.1 * points[:, 0]
        >>> found = drainage((points, triangles))
        >>> found.drains, round(found.least_slope, 6)
        (True, 0.1)
    """

    depressions: Sequence[Depression]
    depth: Array
    slope: Array
    cell: int
    place: Array
    valleys: Integers
    valley_slope: Array
    length_unit: str = "m"

    @property
    def drains(self) -> bool:
        """True if water runs off everywhere."""
        return not self.depressions

    @property
    def least_slope(self) -> float:
        """Least slope of the cells, rise over run [-]."""
        return float(self.slope[self.cell])

    @property
    def least_valley_slope(self) -> float:
        """Least slope along the valleys, rise over run [-]; infinite without valleys."""
        return float(self.valley_slope.min(initial=np.inf))

    def __repr__(self) -> str:
        return f"Drainage({self})"

    def __str__(self) -> str:
        where = validation.format_point(self.place)
        words = [f"least slope {100 * self.least_slope:.3g} % in cell {self.cell} at {where}"]
        if len(self.valleys):
            a, b = self.valleys[self.valley_slope.argmin()]
            words.append(f"{100 * self.least_valley_slope:.3g} % along a valley between nodes {a} and {b}")
        words += [
            f"a depression at node {pond.node}, {validation.format_point(pond.place)}, "
            f"{with_unit(f'{pond.depth:.3g}', self.length_unit)} deep, with an area of "
            f"{with_unit(f'{pond.area:.4g}', self.length_unit, 2)}"
            for pond in self.depressions
        ]
        if not self.depressions:
            words.insert(0, self._verdict())
        return "; ".join(words)

    def _repr_html_(self) -> str:
        """Show the depressions in notebooks, the deepest first."""
        rows = [
            [str(pond.node), validation.format_point(pond.place), str(pond.spill)]
            + [f"{value:.4g}" for value in (pond.depth, pond.area, pond.volume)]
            for pond in self.depressions
        ]
        unit = self.length_unit
        named = [f" [{unit}{power}]" if unit else "" for power in ("", 2, 3)]
        sizes = [f"{size}{of}" for size, of in zip(("depth", "area", "volume"), named, strict=True)]
        heads = ["lowest node", "place", "spills over node", *sizes]
        title = str(self).partition("; a depression")[0]
        return f"<b>Drainage: {escape(title)}</b>" + (table(heads, rows) if rows else "")

    def _verdict(self) -> str:
        if self.least_slope <= LEVEL:
            return "no depression, but level cells"
        return "no depression, but a level valley" if self.least_valley_slope <= LEVEL else "water runs off everywhere"
