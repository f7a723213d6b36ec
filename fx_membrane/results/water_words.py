"""Water of a state and its events in words: lines of reports, and plain data."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..checks import validation
from ..model.water_events import WaterEvent
from .forces_of_state import PondResult
from .states import StageResult

MAX_EVENTS = 12  # events that a report lists


def pond_lines(found: PondResult, length: str) -> list[str]:
    """Line on the water of a pond, and one on each wet basin of several."""
    name = f"Pond on {found.pond.part!r}"
    if not found.volume > 0:
        return [f"{name}: no water stands" + f", {found.lost:.6g} {length}3 run off" * (found.lost > 0)]
    deep = f"{found.depth[found.deepest]:.6g} {length} deep at node {found.deepest}"
    wet = [basin for basin in found.basins or () if basin.volume > 0]
    pieces = f", in {found.separate} pieces" * (found.separate > 1)
    lost = f", {found.lost:.6g} {length}3 have run off" * (found.lost > 0)
    amounts = f"volume {found.volume:.6g} {length}3, area {found.area:.6g} {length}2"
    if len(wet) < 2:
        return [f"{name}: level {found.level:.6g} {length}, {amounts}, {deep}{pieces}{lost}"]
    lines = [f"{name}: {len(wet)} wet basins, {amounts}, {deep}{lost}"]
    return lines + [
        f"  basin at node {basin.node}: level {basin.level:.6g} {length}, volume {basin.volume:.6g} {length}3, area "
        f"{basin.area:.6g} {length}2{', full' * basin.is_full}"
        for basin in wet
    ]


def event_lines(result: StageResult, length: str) -> list[str]:
    """Lines on the events of the water in a stage, the first ones of many."""
    events = result.water_events
    lines = [f"load factor {event.load_factor:.4g}: {event_words(event, length)}" for event in events[:MAX_EVENTS]]
    return lines + [f"and {len(events) - MAX_EVENTS} more events of water"] * (len(events) > MAX_EVENTS)


def with_unit(number: str, length: str, power: int = 1) -> str:
    """Show a number with a power of the unit of length; alone if the unit has no name."""
    return f"{number} {length}{power if power > 1 else ''}" if length else number


def event_words(event: WaterEvent, length: str) -> str:
    """Sentence on an event, without a full stop."""
    place = f"node {event.node} at {validation.format_point(np.array(event.place))}"
    volume = with_unit(f"{event.volume:.4g}", length, 3)
    if event.kind == "merger":
        return f"basins at nodes {event.basin} and {event.other} merge over {place}; the second brings {volume}"
    if event.kind == "parting":
        return f"the basin at node {event.basin} parts; {volume} remain in one at node {event.other}"
    into = "over the edge or into a drain" if event.other < 0 else f"into that at node {event.other}"
    return f"the basin at node {event.basin} spills {volume} over {place} {into}"


def pond_summary(found: PondResult) -> dict[str, Any]:
    """Water of a pond as plain data; the level is None without water."""
    told = {
        "part": found.pond.part,
        "level": found.level if found.volume > 0 else None,
        "volume": found.volume,
        "area": found.area,
        "run off": found.lost,
        "pieces": found.separate,
        "greatest depth": float(found.depth.max()),
    }
    basins = [
        {
            "node": basin.node,
            "level": basin.level if basin.volume > 0 else None,
            "volume": basin.volume,
            "area": basin.area,
            "spill": basin.spill if basin.spill >= 0 else None,
            "full": basin.is_full,
        }
        for basin in found.basins or ()
    ]
    return told | ({"basins": basins} if basins else {})


def event_summary(event: WaterEvent) -> dict[str, Any]:
    """Event as plain data; the other basin is None for water over the edge or into a drain."""
    return event._asdict() | {"other": event.other if event.other >= 0 else None, "place": list(event.place)}
