"""Checks of the drainage of membranes: water that would stand in a state, and water of ponds that runs off."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.spill import spill_nodes
from ..geometry.topology import boundary_edges
from ..geometry.water_on_triangles import plan_areas
from ..model.chamber_surfaces import surface
from ..model.parts import Membrane
from ..model.ponds import MIN_UPWARD, outlets
from ..model.water_events import WaterEvent
from .check import Check, Verdict
from .forces_of_state import PondResult
from .places import node_place
from .plain_numbers import plain
from .states import StageResult
from .water_words import MAX_EVENTS, event_words, with_unit

# Depth over the size of the structure from which on water counts: valleys across edges hold a little.
SHALLOW_DEPTH = 1e-3
HEIGHT_ROUNDING = 1e-9  # difference of heights over the size of the structure that is rounding

WORDS = {"spill": "basin spills on", "merger": "basins merge on", "parting": "basin parts on"}

Nodes = NDArray[np.int64]


def drain_checks(result: StageResult, length: str = "") -> Iterator[Check]:
    """Check for each membrane that lies in the rain: the depth of the water that would stand on it; overflow of ponds.

    Args:
        result: The state.
        length: Name of the unit of length; numbers have no unit without it.
    """
    for name, part in result.structure.parts_of(Membrane).items():
        if _lies(result, part.cells) and not _covered(result, name):
            yield _standing(result, name, part.cells, length)
    for pond in result.ponds:
        yield from _overflow(result, pond, length)
    yield from _events(result, length)


def _overflow(result: StageResult, pond: PondResult, length: str) -> Iterator[Check]:
    """Tell where water of a pond runs off; warn if the rim of water of one level has sunk below it."""
    name, ways = pond.pond.part, outlets(result.structure, pond.pond)
    if not len(ways):
        return
    height = result.position[ways, 2]
    lowest = int(ways[height.argmin()])
    if pond.lost > 0:
        spills = [event for event in result.water_events if event.other < 0 and event.part == name]
        if spills:
            node = max(spills, key=lambda event: event.volume).node
        else:
            full = [basin.spill for basin in pond.basins or () if basin.is_full]
            node = full[0] if full else lowest
        level = float(result.position[node, 2])
        at = with_unit(plain(level, 4), length)
        remedy = f"At the level {at} it runs over the rim or into drains: more rain makes no larger pond."
        place = node_place(result.structure, node)
        found = with_unit(plain(pond.lost, 3), length, 3)
        yield Check(f"water run off {name!r}", found, "", Verdict.PASS, remedy, place, design=True)
    over, limit = pond.level - height.min(), SHALLOW_DEPTH * result.structure.size
    if not pond.basins and over > limit:
        place = node_place(result.structure, lowest)
        words = "The level is given" if pond.pond.level is not None else "The rim holds the water at its first height"
        remedy = f"{words}, but this node has sunk below it: the water would run off. Give less of it, or rain."
        found, most = with_unit(plain(over, 2), length), with_unit(plain(limit, 2), length)
        yield Check(f"water over the rim of {name!r}", found, most, Verdict.WARN, remedy, place, design=True)


def _events(result: StageResult, length: str) -> Iterator[Check]:
    """Tell where water has run from basin to basin, and which basins have merged or parted, the first of many."""
    told: dict[tuple[str, str, int, int], WaterEvent] = {}
    for event in result.water_events:
        if event.kind == "spill" and event.other < 0:
            continue
        key = event.part, event.kind, event.basin, event.other
        first = told.get(key)
        told[key] = event if first is None else first._replace(volume=first.volume + event.volume)
    for event in [*told.values()][:MAX_EVENTS]:
        words = event_words(event, length)
        remedy = f"First at load factor {event.load_factor:.3g}: {words}."
        yield Check(
            f"{WORDS[event.kind]} {event.part!r}",
            with_unit(plain(event.volume, 3), length, 3),
            "",
            Verdict.PASS,
            remedy,
            node_place(result.structure, event.node),
            design=True,
        )


def _lies(result: StageResult, cells: Nodes) -> bool:
    """Return True if all cells of a membrane face up, or all down."""
    a, b, c = result.position[cells].transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    upward = normal[:, 2] / np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
    return bool((upward > MIN_UPWARD).all() or (upward < -MIN_UPWARD).all())


def _covered(result: StageResult, name: str) -> bool:
    """Return True if a membrane faces up into a chamber, without a pond: no rain falls on it."""
    if any(pond.pond.part == name for pond in result.ponds):
        return False
    cells = result.structure.parts[name].cells
    upward = cells if plan_areas(result.position[cells]).sum() > 0 else cells[:, ::-1]
    for chamber, given in result.structure.chambers.items():
        if name in given.parts:
            outward = surface(result.structure, chamber).triangles
            if not (_turned(outward)[:, None] == _turned(upward[:1])).all(axis=2).any():
                return True
    return False


def _turned(triangles: Nodes) -> Nodes:
    """Triangles with their first node the least, in the same sense."""
    first = triangles.argmin(axis=1)
    return np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)


def _standing(result: StageResult, name: str, cells: Nodes, length: str) -> Check:
    """Check of the greatest depth on a membrane when all hollows are full; drains and walls are those of its ponds."""
    ways = np.unique(boundary_edges(cells))
    for pond in result.ponds:
        if pond.pond.part == name:
            whole = pond.pond.cells is None
            ways = outlets(result.structure, pond.pond) if whole else np.union1d(ways, np.asarray(pond.pond.drains))
    nodes, places = np.unique(cells, return_inverse=True)
    height = result.position[nodes, 2]
    exits = np.searchsorted(nodes, ways)
    if not len(exits):
        return Check(f"water would stand on {name!r}", "it has no rim", "", Verdict.PASS, design=True)
    depth = height[spill_nodes(places.reshape(-1, 3), height, exits)] - height
    deepest, limit = int(depth.argmax()), SHALLOW_DEPTH * result.structure.size
    stands = bool(depth[deepest] > limit)
    found = with_unit(plain(max(depth[deepest], 0.0), 2), length)
    return Check(
        f"water would stand on {name!r}",
        f"{found} deep",
        with_unit(plain(limit, 2), length),
        Verdict.WARN if stands else Verdict.PASS,
        "Rain does not run off here: give the roof more slope or prestress, or drains." if stands else "",
        node_place(result.structure, int(nodes[deepest])) if stands else "",
        design=True,
    )
