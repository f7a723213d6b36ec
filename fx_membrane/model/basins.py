"""Basins of a membrane, in which rain stands: hollows of a shape, or several whose water has merged.

A basin has one level, and a volume that the solver keeps. It receives the rain on the area in plan of its cells; rain
on cells without a basin runs off.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry import water_on_triangles
from ..geometry.hollows import OUTSIDE, Hollows, hollows_of
from ..geometry.pools import Filling, Pool
from .ponds import Pond, amount, outlets, triangles_of
from .structure import Structure

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

VOLUME_ROUNDING = 1e-10  # volume over that of all rain that is rounding


class Basin(NamedTuple):
    """Water of one level, in a hollow or in several.

    Attributes:
        node: Its lowest node.
        cells: Its cells, rows of the triangles of the pond, shape (k,).
        volume: Volume of its water when the basins were found [m3].
        share: Share of further rain that it receives [-].
        outlets: Nodes over which it spills, shape (k,).
        into: Number of the basin into which it spills; -1 for the outside, None where an earlier version saved it.
    """

    node: int
    cells: Integers
    volume: float
    share: float
    outlets: Integers
    into: int | None


class StandingWater(NamedTuple):
    """Water in the basins of a pond.

    Attributes:
        basins: The basins, by their lowest nodes.
        fallen: Volume of all rain that had fallen when they were found [m3].
    """

    basins: tuple[Basin, ...]
    fallen: float

    def volumes(self, fallen: float) -> Array:
        """Volumes after more rain, shape (basins,) [m3].

        Args:
            fallen: Volume of all rain that has fallen [m3].
        """
        more = fallen - self.fallen
        return np.array([max(basin.volume + basin.share * more, 0.0) for basin in self.basins])

    @property
    def ways(self) -> list[int]:
        """Number of the basin into which each spills; -1 for the outside."""
        return [OUTSIDE if basin.into is None else basin.into for basin in self.basins]


def has_basins(ponds: Sequence[Pond]) -> bool:
    """Return True if rain falls on the cells that ponds share; then each basin has a level of its own."""
    return any(pond.rain is not None for pond in ponds)


def fallen(structure: Structure, ponds: Sequence[tuple[Pond, float]]) -> float:
    """Volume of the water of ponds on the same cells, by their factors [m3]."""
    return sum(factor * amount(structure, pond) for pond, factor in ponds)


def dry(structure: Structure, pond: Pond, shape: Array | None) -> StandingWater:
    """Basins of a shape without water.

    Args:
        structure: The structure.
        pond: The pond.
        shape: Displacement, shape (n, 3) [m]; None for the reference shape.
    """
    position = structure.points + (0.0 if shape is None else shape)
    triangles = triangles_of(structure, pond)
    found = hollows_of(position, triangles, outlets(structure, pond))
    pools = filling(found, np.zeros(len(found.pits)), position, triangles, 0.0).pools
    return StandingWater(basins_of(structure, pond, found, pools, position), 0.0)


def restored(
    structure: Structure, pond: Pond, volumes: Mapping[int, float], position: Array, total: float
) -> StandingWater:
    """Water in the basins of a shape, from the volumes of its basins by their lowest nodes.

    Args:
        structure: The structure.
        pond: The pond.
        volumes: Volumes by lowest node [m3].
        position: Positions of all nodes, shape (n, 3) [m].
        total: Volume of all rain that has fallen [m3].
    """
    triangles = triangles_of(structure, pond)
    found = hollows_of(position, triangles, outlets(structure, pond))
    standing = np.zeros(len(found.pits))
    for node, volume in volumes.items():
        home = hollow_at(found, triangles, node)
        if home != OUTSIDE:
            standing[home] += volume
    state = filling(found, standing, position, triangles, VOLUME_ROUNDING * total)
    state.run()
    return StandingWater(basins_of(structure, pond, found, state.pools, position), total)


def hollow_at(found: Hollows, triangles: Integers, node: int) -> int:
    """Hollow of which a node is the lowest, or else that of a cell at it."""
    known = np.flatnonzero(found.pits == node)
    at = np.flatnonzero((triangles == node).any(axis=1))
    return int(known[0]) if len(known) else int(found.of_cell[at].max())


def filling(
    found: Hollows,
    volumes: Array,
    position: Array,
    triangles: Integers,
    tiny: float,
    joined: Iterable[tuple[int, int]] = (),
) -> Filling:
    """Hollows of a shape with their water, see `Filling`."""

    def capacity(hollows: tuple[int, ...], level: float) -> float:
        cells = triangles[np.isin(found.of_cell, hollows)]
        return max(float(water_on_triangles.volumes(position[cells], level)[0].sum()), 0.0)

    return Filling(found, volumes, position[:, 2], capacity, tiny, joined)


def basins_of(
    structure: Structure, pond: Pond, found: Hollows, pools: Sequence[Pool], position: Array
) -> tuple[Basin, ...]:
    """Basins of pools, by their lowest nodes."""
    areas = water_on_triangles.plan_areas(structure.points[triangles_of(structure, pond)])
    lowest = {_lowest(found, pool.hollows, position): pool for pool in pools}
    ordered = dict(sorted(lowest.items()))
    number = {hollow: place for place, pool in enumerate(ordered.values()) for hollow in pool.hollows}
    basins = []
    for node, pool in ordered.items():
        cells = np.flatnonzero(np.isin(found.of_cell, pool.hollows))
        share = float(areas[cells].sum() / areas.sum())
        spill = np.array([pool.spill] if pool.spill != OUTSIDE else [], dtype=np.int64)
        basins.append(Basin(node, cells, pool.volume, share, spill, number.get(pool.into, OUTSIDE)))
    return tuple(basins)


def _lowest(found: Hollows, hollows: Sequence[int], position: Array) -> int:
    """Lowest node of some hollows."""
    pits = found.pits[list(hollows)]
    return int(pits[position[pits, 2].argmin()])
