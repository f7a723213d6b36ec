"""Numbers and directions of cutting patterns in case files."""

from __future__ import annotations

from typing import Any

from ...checks import validation
from ..patterns.paper import paper_of
from .faults import Faults
from .table import BROKEN, is_whole, sound

POSITIVE = ("size", "transition", "roll_width", "mark_spacing", "copy_tolerance")
TRAIL = ("patterns",)


def check_values(faults: Faults, table: Any) -> None:
    """Check lengths, stress error, directions, paper and scale."""
    for key in POSITIVE:
        value = getattr(table, key)
        if value is not None and value is not BROKEN:
            with faults.at(*TRAIL, key):
                validation.positive(key, value)
    if table.stress_error not in (None, BROKEN):
        with faults.at(*TRAIL, "stress_error"):
            validation.fraction("stress_error", table.stress_error)
    if table.copy_tolerance not in (None, BROKEN) and table.copies is False:
        with faults.at(*TRAIL, "copy_tolerance"):
            raise ValueError("no copies are asked for; give copies = true as well, or leave it out")
    _check_directions(faults, table)
    if table.paper not in (None, BROKEN):
        with faults.at(*TRAIL, "paper"):
            paper_of(table.paper)
    if table.scale not in (None, BROKEN):
        with faults.at(*TRAIL, "scale"):
            validation.positive_integer("scale", table.scale)


def _check_directions(faults: Faults, table: Any) -> None:
    """Refuse normals and warps that are zero."""
    for row, plane in sound(table.planes):
        if is_whole(plane):
            with faults.at(*TRAIL, "planes", row, "normal"):
                validation.direction("normal", plane.normal)
    for name, along in {} if table.warp is BROKEN else table.warp.items():
        if is_whole(along):
            with faults.at(*TRAIL, "warp", name):
                validation.direction("warp", along)
