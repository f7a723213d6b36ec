"""Water of rain on a new shape of a membrane: basins are found anew, and the water runs until it rests.

Water is lost over the rim and into drains only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry import water_on_triangles
from ..geometry.hollows import OUTSIDE, Hollows, hollows_of
from ..geometry.pools import Flow
from .basins import VOLUME_ROUNDING, StandingWater, basins_of, filling, hollow_at
from .ponds import Pond, outlets, triangles_of
from .structure import Structure
from .water_events import STILL_OVER_TINY, Change, Comparison

Array = NDArray[np.float64]


class Solved(NamedTuple):
    """Water in the basins of the shape before, as the solver has found it in the shape now.

    Attributes:
        levels: Levels, shape (basins,) [m]; minus infinity without water.
        amounts: Volumes, with what is above an outlet and waits there, shape (basins,) [m3].
        spilt: Volumes that have run from each into the basin behind its outlet, shape (basins,) [m3].
    """

    levels: Sequence[float]
    amounts: Sequence[float]
    spilt: Sequence[float]


class Renewal(NamedTuple):
    """Basins of a new shape.

    Attributes:
        water: The water in them.
        events: Events since the last ones: kind, basin, other, node and volume, as of `WaterEvent`.
        moved: True if water has moved, so that the shape is no longer at rest.
    """

    water: StandingWater
    events: tuple[Change, ...]
    moved: bool


def renewed(
    structure: Structure,
    pond: Pond,
    old: StandingWater,
    position: Array,
    solved: Solved,
    total: float,
) -> Renewal:
    """Find the basins of a new shape, and let the water run until it rests.

    Args:
        structure: The structure.
        pond: The pond.
        old: The water in the basins of the shape before.
        position: Positions of all nodes now, shape (n, 3) [m].
        solved: The water in these basins now.
        total: Volume of all rain that has fallen [m3].
    """
    triangles = triangles_of(structure, pond)
    found = hollows_of(position, triangles, outlets(structure, pond))
    standing, came = np.zeros(len(found.pits)), []
    above, gone = np.zeros(len(found.pits)), np.zeros(len(old.basins))
    for number, (basin, level, volume) in enumerate(zip(old.basins, solved.levels, solved.amounts, strict=True)):
        wet = water_on_triangles.volumes(position[triangles[basin.cells]], level)[0] if np.isfinite(level) else 0.0
        hollow = found.of_cell[basin.cells]
        here = np.bincount(hollow + 1, np.broadcast_to(wet, len(hollow)), len(found.pits) + 1)
        standing, gone[number] = standing + here[1:], here[0]
        came.append(here[1:])
        rest = max(volume - float(here.sum()), 0.0)  # above its outlet
        home = hollow_at(found, triangles, basin.node)
        if home == OUTSIDE:
            gone[number] += rest
        else:
            above[home] += rest
    tiny = VOLUME_ROUNDING * total
    joined = [
        (a, b)
        for a, b, node in found.ways.tolist()
        for level, here in zip(solved.levels, came, strict=True)
        if b != OUTSIDE and here[a] > 0 and here[b] > 0 and level > position[node, 2]
    ]
    state = filling(found, standing + above, position, triangles, tiny, joined)
    state.run_once()
    pools = state.pools
    water = StandingWater(basins_of(structure, pond, found, pools, position), total)
    flows = [*_flows(found, triangles, old, solved), *state.flows]
    compared = Comparison(found, pools, flows, old.basins, np.array(came), tiny, position[:, 2])
    events = (*compared.mergers(), *compared.partings(), *compared.spills(gone))
    moved = compared.moved(standing) or compared.uneven(solved.levels, 1e-10 * structure.size)
    moved |= compared.spread(solved.levels, standing, state.capacity)
    return Renewal(water, events, moved or bool((gone > STILL_OVER_TINY * tiny).any()))


def _flows(found: Hollows, triangles: NDArray[np.int64], old: StandingWater, solved: Solved) -> list[Flow]:
    """Flows over which the solver has found water in the basins behind."""
    flows = []
    for basin, into, volume in zip(old.basins, old.ways, solved.spilt, strict=True):
        source = hollow_at(found, triangles, basin.node)
        if volume > 0 and source != OUTSIDE:
            behind = hollow_at(found, triangles, old.basins[into].node)
            flows.append(Flow(source, behind, int(basin.outlets[0]), volume))
    return flows
