"""Edges and corners of cutting patterns without compensation, as case files name them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...patterns.strips import Strips
from ..drawing import nodes_of
from .choices import Choices, Outline
from .faults import Unknown, Wrong
from .table import BROKEN


def decompensated_of(choices: Choices, outline: Outline, table: Any) -> dict[str, Any]:
    """Argument `decompensate` of `cutting_pattern`: names of edges and lines, and nodes of the geometry by number.

    Raises:
        ValueError: A node is not there, or has another number after a new mesh.
        Unknown: It depends on a table that has a fault.
    """
    if "decompensate" not in table.model_fields_set:
        return {}
    if table.decompensate is BROKEN:
        raise Unknown
    found: list[str | int] = []
    for row, entry in enumerate(table.decompensate):
        if isinstance(entry, str) and not _is_corner(choices, outline, entry):
            found.append(entry)
            continue
        if outline.renumbered:
            raise Wrong("after a new mesh there are other numbers of nodes; give names of edges", row)
        if not (choices.whole and outline.structure is not None):
            raise Unknown
        number, count = choices.node(entry, choices.rows), len(outline.structure.points)
        if not 0 <= number < count:
            raise Wrong(f"{number} is not there; the numbers go from 0 to {count - 1}", row)
        found.append(number)
    return {"decompensate": found}


def _is_corner(choices: Choices, outline: Outline, name: str) -> bool:
    """Return True if a name is that of a node of the geometry, and of no part."""
    is_part = outline.structure is not None and name in outline.structure.parts
    return name in choices.drawing.cells and not is_part and len(nodes_of(choices.drawing, name)) == 1


def on_strips(strips: Strips, cloth: Mapping[str, Any]) -> dict[str, Any]:
    """Give nodes of the geometry the numbers that they have after the cut.

    Raises:
        ValueError: A node is gone.
    """
    if "decompensate" not in cloth:
        return dict(cloth)
    found = [one if isinstance(one, str) else int(strips.nodes[one]) for one in cloth["decompensate"]]
    gone = [one for one, number in zip(cloth["decompensate"], found, strict=True) if number == -1]
    if gone:
        raise ValueError(f"decompensate: node {gone[0]} is gone in the new mesh; give a corner, or names of edges.")
    return {**cloth, "decompensate": found}
