"""Pools of water in the hollows of a surface: they spill over from one into another, and merge."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .hollows import OUTSIDE, Hollows

Array = NDArray[np.float64]

Capacity = Callable[[tuple[int, ...], float], float]  # volume below a level of the cells of some hollows [m3]


class Pool(NamedTuple):
    """Water in one hollow, or in several that have merged.

    Attributes:
        hollows: Numbers of the hollows, ascending.
        volume: Volume of the water [m3].
        spill: Node over which it spills; -1 if nothing lets it out.
        into: A hollow into which it spills; -1 for the outside.
    """

    hollows: tuple[int, ...]
    volume: float
    spill: int
    into: int


class Flow(NamedTuple):
    """Water that has run over from one hollow into another.

    Attributes:
        source: A hollow of the pool from which it came.
        into: The hollow to which it ran; -1 for the outside.
        node: Node over which it ran.
        volume: Its volume [m3].
    """

    source: int
    into: int
    node: int
    volume: float


class Filling:
    """Hollows with water, which runs from one to another.

    Attributes:
        found: The hollows.
        flows: The flows until now.
        capacity: Volume below a level of the cells of some hollows [m3].

    Args:
        found: The hollows.
        volumes: Water in each, shape (hollows,) [m3].
        height: Heights of all nodes, shape (n,) [m].
        capacity: As the attribute.
        rounding: Volume that is rounding [m3].
        joined: Pairs of hollows whose water is one.

    Source:
        R. Barnes, K. Callaghan, A. Wickert, Computing water flow through complex landscapes, part 3: Fill-Spill-Merge,
        Earth Surface Dynamics 9 (2021) 105-121.
    """

    def __init__(
        self,
        found: Hollows,
        volumes: Array,
        height: Array,
        capacity: Capacity,
        rounding: float,
        joined: Iterable[tuple[int, int]] = (),
    ):
        self.found, self.flows = found, list[Flow]()
        self._height, self.capacity, self._rounding = height, capacity, rounding
        self._pool_of = list(range(len(volumes)))
        self._members: list[tuple[int, ...]] = [(number,) for number in self._pool_of]
        self._water = [float(volume) for volume in volumes]
        self._limits: dict[int, tuple[float, int, int]] = {}
        for a, b in joined:
            if self._pool_of[a] != self._pool_of[b]:
                self._merge(self._pool_of[a], self._pool_of[b])

    @property
    def pools(self) -> list[Pool]:
        """The pools."""
        return [
            Pool(members, self._water[pool], *self._limit(pool)[1:])
            for pool, members in enumerate(self._members)
            if members
        ]

    def run(self) -> None:
        """Let the water run until it rests."""
        waiting = [*range(len(self._members))]
        while waiting:
            into = self._spill(waiting.pop())
            if into is not None:
                waiting.append(into)

    def run_once(self) -> None:
        """Let each pool that is above its lowest way spill once; pools that receive water wait.

        On a surface that yields, a pool holds more after it has sunk under the water; so not all of it runs on.
        """
        full = [pool for pool, members in enumerate(self._members) if members and self._rest(pool) > self._rounding]
        waiting: set[int] = set()
        for pool in full:
            if pool not in waiting:
                into = self._spill(pool)
                waiting |= set() if into is None else {into}

    def _rest(self, pool: int) -> float:
        """Water above the lowest way of a pool [m3]."""
        return self._water[pool] - self._limit(pool)[0]

    def _spill(self, pool: int) -> int | None:
        """Give water above the lowest way of a pool to the one behind it; return that one, or None if nothing runs."""
        if not self._members[pool]:
            return None
        most, node, into = self._limit(pool)
        rest = self._water[pool] - most
        if rest <= self._rounding:
            return None
        self._water[pool] = most
        self.flows.append(Flow(self._members[pool][0], into, node, rest))
        if into == OUTSIDE:
            return None
        other = self._pool_of[into]
        full, _, back = self._limit(other)
        is_full = self._water[other] + rest >= full - self._rounding
        self._water[other] += rest
        if is_full and back != OUTSIDE and self._pool_of[back] == pool:
            self._merge(pool, other)
        return other

    def _merge(self, pool: int, other: int) -> None:
        """Join the water of a pool with that of another one, which remains."""
        for hollow in self._members[pool]:
            self._pool_of[hollow] = other
        self._members[other] = tuple(sorted(self._members[other] + self._members[pool]))
        self._water[other] += self._water[pool]
        self._members[pool], self._water[pool] = (), 0.0
        self._limits.clear()

    def _limit(self, pool: int) -> tuple[float, int, int]:
        """Capacity of a pool, the node over which it spills, and the hollow behind."""
        if pool not in self._limits:
            self._limits[pool] = np.inf, -1, OUTSIDE
            for a, b, node in self.found.ways.tolist():  # a is a hollow
                left, right = self._pool_of[a], OUTSIDE if b == OUTSIDE else self._pool_of[b]
                if left != right and pool in (left, right):
                    most = self.capacity(self._members[pool], float(self._height[node]))
                    self._limits[pool] = most, node, b if left == pool else a
                    break
        return self._limits[pool]
