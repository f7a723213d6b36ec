"""Sail of a case, drawn in plan: each corner, hole, line or point with a fault is told apart."""

from __future__ import annotations

from collections.abc import Mapping, Set
from typing import Any

import numpy as np

from ...checks import validation
from ...surfaces.round_hole import RoundHole
from ...surfaces.sail import SailMesh, sail_mesh
from ...surfaces.sail_plan import checked_point, draw
from .faults import Faults, Unknown
from .making import make
from .structure_schema import HoleModel, SailGeometry
from .table import BROKEN, given, is_whole

KEYS = ("sag", "points", "holes", "lines", "sizes")  # lines name points, edges and holes; sizes name all
STAND_IN_SIZE = 100.0  # size of a stand-in for faulty corners over that of all places


def sail_of(faults: Faults, table: SailGeometry) -> SailMesh:
    """Mesh of a sail.

    Args:
        faults: Faults found so far, to which those of single entries are added.
        table: The table of the geometry.

    Raises:
        ValueError: Entries do not fit together, as lines that cross.
        Unknown: Some of them have a fault.
        ImportError: gmsh is not installed.
    """
    count = len(faults)
    plan: dict[str, Any] = {"corners": table.corners, "size": table.size, "sag": 0.0}
    plan |= {key: {} for key in KEYS if key != "sag"}
    sound = _corners(faults, table.corners)
    plan["size"] = _size(faults, table.size, plan, sound)
    if not sound:
        plan["corners"], reach = _stand_in(table)
        plan["size"] = reach / 10
    lost = set[str]()
    for key in KEYS:
        lost |= _check(faults, key, getattr(table, key), plan, lost, sound)
    if len(faults) > count or not is_whole(table):
        raise Unknown
    return sail_mesh(**given(table, "kind") | {"holes": plan["holes"]})


def _corners(faults: Faults, corners: Any) -> bool:
    """Check the corners; False if they have a fault."""
    if corners is BROKEN:
        return False
    count = len(faults)
    if isinstance(corners, Mapping):
        for name, place in corners.items():
            with faults.at("geometry", "corners", name):
                checked_point(f"The corner {name!r}", place)
    if len(faults) == count:
        with faults.at("geometry", "corners"):
            draw(corners, _extent(corners), 0.0, {}, {}, {}, {})
    return len(faults) == count


def _extent(value: Any) -> float:
    """Size of all places in a value, one at least where it has none."""
    if value is None or value is BROKEN:
        return 1.0
    if isinstance(value, Mapping):
        return max(map(_extent, value.values()), default=1.0)
    if isinstance(value, list | tuple):
        return max(map(_extent, value), default=1.0)
    return abs(value) or 1.0 if isinstance(value, int | float) else 1.0


def _size(faults: Faults, size: Any, plan: Mapping[str, Any], sound: bool) -> float:
    """Check the size; return it, or that of the plan if it has a fault."""
    if size is not BROKEN:
        with faults.at("geometry", "size"):
            validation.positive("size", size)
            if sound:
                draw(**{**plan, "sag": 0.0})
            return float(size)
    return 1.0


def _stand_in(table: SailGeometry) -> tuple[dict[str, Any], float]:
    """Corners of the same names far around all places, and their distance from the middle."""
    reach = STAND_IN_SIZE * max(_extent(table.corners), _extent(table.points), 1.0)
    names = list(table.corners) if isinstance(table.corners, Mapping) else list("0123")
    angles = 2 * np.pi * np.arange(max(len(names), 3)) / max(len(names), 3)
    names += [f"{number}, missing" for number in range(len(names), 3)]
    return {name: reach * np.array([np.cos(a), np.sin(a)]) for name, a in zip(names, angles, strict=True)}, reach


def _check(faults: Faults, key: str, value: Any, plan: dict[str, Any], lost: Set[str], sound: bool) -> set[str]:
    """Check the entries of a key one after the other, and add those without a fault to the plan.

    Args:
        faults: Faults found so far.
        key: The key.
        value: Its value.
        plan: Arguments of `draw` without a fault.
        lost: Names of entries with a fault, of which others know nothing.
        sound: False if stand-ins are in the place of the corners: lines are not where they belong then.

    Returns:
        Names of the entries with a fault, or that depend on one.
    """
    if value is None or value is BROKEN:
        return set()
    if not isinstance(value, Mapping):
        with faults.at("geometry", key):
            draw(**{**plan, key: value})
            plan[key] = value
        return set()
    for name, entry in value.items():
        named = {name} if key == "sizes" else _names(entry)
        if not lost & named and not (key == "lines" and not sound and named <= _known(plan)):
            with faults.at("geometry", key, name):
                made = {**(plan[key] or {}), name: _made(faults, ("geometry", key, name), entry)}
                draw(**{**plan, key: made})
                plan[key] = made
    return value.keys() - (plan[key] or {})


def _names(entry: Any) -> set[str]:
    """Texts in a list of any depth."""
    if isinstance(entry, list | tuple):
        return set().union(*map(_names, entry))
    return {entry} if isinstance(entry, str) else set()


def _known(plan: Mapping[str, Any]) -> set[str]:
    """Names that a line may name."""
    corners = list(plan["corners"])
    edges = {f"{a}-{b}" for a, b in zip(corners, [*corners[1:], corners[0]], strict=True)}
    return edges.union(corners, *(plan[key] for key in ("points", "holes", "lines")))


def _made(faults: Faults, trail: tuple[str, ...], entry: Any) -> Any:
    if not isinstance(entry, HoleModel):
        return entry
    return make(faults, trail, RoundHole, given(entry), {"centre": (0.0, 0.0), "radius": 1.0})
