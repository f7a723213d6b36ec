"""Events of the water in basins: it runs over from one into another, and basins merge and part."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.hollows import OUTSIDE, Hollows
from ..geometry.pools import Flow, Pool
from .basins import Basin

Array = NDArray[np.float64]

STILL_OVER_TINY = 10.0  # volume that moves, over that of rounding, below which water counts as at rest

Change = tuple[str, int, int, int, float]  # kind, basin, other, node, volume of an event


class WaterEvent(NamedTuple):
    """Event of the water on a membrane, at the end of a load increment.

    Attributes:
        part: Name of the membrane.
        kind: "spill", "merger" or "parting".
        load_factor: Load factor of the stage at the end of the increment.
        basin: Lowest node of the basin that spills, that another one joins, or from which another one parts.
        other: Lowest node of the other basin; -1 for water over the edge or into a drain.
        node: Node over which the water runs.
        place: Position of that node, shape (3,) [m].
        volume: Volume that has run over in the increment, or that of the other basin [m3].

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 8, 8)
        >>> points[:, 2] = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1])) - 1  # a pyramid, upside down
        >>> tub = Structure(points, {"tub": Membrane(triangles, Fabric(1e9, 0.0), 1e6)}, [Support(range(len(points)))])
        >>> rained = Analysis(tub).run([Stage("rain", [Pond("tub", rain=0.6)])])["rain"]
        >>> [(event.kind, event.basin) for event in rained.water_events]
        [('spill', 40)]
    """

    part: str
    kind: str
    load_factor: float
    basin: int
    other: int
    node: int
    place: tuple[float, float, float]
    volume: float


class BasinResult(NamedTuple):
    """Water in a basin of a pond.

    Attributes:
        part: Name of the membrane.
        pond: Number of the pond, as in the ponds of the state.
        node: Lowest node of the basin.
        level: Height of the water [m]; minus infinity without water.
        volume: Its volume [m3].
        area: Wet area in plan [m2].
        spill: Node over which it spills; -1 if walls close it.
        is_full: True if the water stands at the height of that node.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 8, 8)
        >>> points[:, 2] = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1])) - 1  # a pyramid, upside down
        >>> tub = Structure(points, {"tub": Membrane(triangles, Fabric(1e9, 0.0), 1e6)}, [Support(range(len(points)))])
        >>> basin = Analysis(tub).run([Stage("rain", [Pond("tub", rain=0.01)])])["rain"].ponds[0].basins[0]
        >>> basin.node, round(basin.volume, 6), basin.is_full
        (40, 0.04, False)
    """

    part: str
    pond: int
    node: int
    level: float
    volume: float
    area: float
    spill: int
    is_full: bool


class Comparison:
    """Basins of a shape beside those of the shape before.

    Attributes:
        found: The hollows.
        pools: The water in them at rest.
        flows: The flows between hollows on the way to rest.
        old: The basins before.
        came: Water of each old basin in each hollow before it has run over, shape (basins, hollows) [m3].
        tiny: Volume that is rounding [m3].
        height: Heights of all nodes, shape (n,) [m].
    """

    def __init__(
        self,
        found: Hollows,
        pools: Sequence[Pool],
        flows: Sequence[Flow],
        old: Sequence[Basin],
        came: Array,
        tiny: float,
        height: Array,
    ):
        self.found, self.pools, self.flows, self.old, self.came, self.tiny = found, pools, flows, old, came, tiny
        self.height = height
        self.pool_of = np.full(len(found.pits) + 1, OUTSIDE)  # the last entry is the outside
        for number, pool in enumerate(pools):
            self.pool_of[list(pool.hollows)] = number
        pits = {int(pit): number for number, pit in enumerate(found.pits)}
        # Pools in which an old basin had water, or in which its lowest node is one of several hollows.
        self.pools_of_old = []
        for basin, volumes in zip(old, came, strict=True):
            here = {int(number) for number in self.pool_of[:-1][volumes > tiny]}
            home = self.pool_of[pits[basin.node]] if basin.node in pits else OUTSIDE
            if not here and home != OUTSIDE and len(pools[home].hollows) > 1:
                here = {int(home)}
            self.pools_of_old.append(here)

    def mergers(self) -> list[Change]:
        """Mergers: the deepest of some old basins, the others that have joined it, and the node between them."""
        events = []
        for number, pool in enumerate(self.pools):
            joined = [k for k, pools in enumerate(self.pools_of_old) if number in pools]
            joined.sort(key=lambda k: self.height[self.old[k].node])
            for k in joined[1:]:
                node = self._between(pool, k)
                volume = float(self.came[k, list(pool.hollows)].sum())
                events.append(("merger", self.old[joined[0]].node, self.old[k].node, node, volume))
        return events

    def partings(self) -> list[Change]:
        """Partings: an old basin, and the lowest nodes of the smaller basins that have parted from it."""
        events = []
        for basin, pools, volumes in zip(self.old, self.pools_of_old, self.came, strict=True):
            sizes = {number: float(volumes[list(self.pools[number].hollows)].sum()) for number in pools}
            for number in sorted(sizes, key=lambda n: -sizes[n])[1:]:
                pool = self.pools[number]
                pit = self._lowest(pool)
                events.append(("parting", basin.node, pit, pool.spill, sizes[number]))
        return events

    def spills(self, gone: Array) -> list[Change]:
        """Water that has run over from basin to basin, over the edge, or into a drain."""
        sums: dict[tuple[int, int, int], float] = {}
        for flow in self.flows:
            source, into = int(self.pool_of[flow.source]), int(self.pool_of[flow.into])
            if source != into:
                sums[source, into, flow.node] = sums.get((source, into, flow.node), 0.0) + flow.volume
        pits = [self._lowest(pool) for pool in self.pools]
        names = [basin.node for basin in self.old]
        events = [
            ("spill", pits[source], OUTSIDE if into == OUTSIDE else pits[into], node, volume)
            for (source, into, node), volume in sums.items()
            if volume > self.tiny
        ]
        events += [
            ("spill", names[k], OUTSIDE, int(basin.outlets[0]) if len(basin.outlets) else basin.node, float(gone[k]))
            for k, basin in enumerate(self.old)
            if gone[k] > self.tiny
        ]
        return events

    def moved(self, standing: Array) -> bool:
        """Return True if a pool has another volume than its hollows had."""
        change = [abs(pool.volume - standing[list(pool.hollows)].sum()) for pool in self.pools]
        return bool(max(change, default=0.0) > STILL_OVER_TINY * self.tiny)

    def spread(
        self, levels: Sequence[float], standing: Array, capacity: Callable[[tuple[int, ...], float], float]
    ) -> bool:
        """Return True if cells that no old basin had are below the level of a pool: its water runs there.

        Args:
            levels: Levels of the old basins [m].
            standing: Water in each hollow [m3].
            capacity: Volume of hollows below a level [m3].
        """
        for pool, found in zip(self.pools, self._levels(levels), strict=True):
            below = capacity(pool.hollows, max(found)) if found else 0.0
            if below > standing[list(pool.hollows)].sum() + STILL_OVER_TINY * self.tiny:
                return True
        return False

    def uneven(self, levels: Sequence[float], rounding: float) -> bool:
        """Return True if basins of different levels have merged."""
        return any(max(found) - min(found) > rounding for found in self._levels(levels) if found)

    def _levels(self, levels: Sequence[float]) -> list[list[float]]:
        """Levels of the old basins with water in each pool."""
        return [
            [levels[k] for k, pools in enumerate(self.pools_of_old) if number in pools and np.isfinite(levels[k])]
            for number in range(len(self.pools))
        ]

    def _lowest(self, pool: Pool) -> int:
        """Lowest node of a pool."""
        pits = self.found.pits[list(pool.hollows)]
        return int(pits[self.height[pits].argmin()])

    def _between(self, pool: Pool, k: int) -> int:
        """Node over which an old basin has merged with the rest of a pool; its own lowest node if it has none."""
        mine = set(np.flatnonzero(self.came[k] > self.tiny).tolist())
        mine |= set(np.flatnonzero(self.found.pits == self.old[k].node).tolist())
        for a, b, node in self.found.ways.tolist():
            if {a, b} <= set(pool.hollows) and (a in mine) != (b in mine):
                return int(node)
        return self.old[k].node
