"""Fields of a scene: their least and largest values with places, and their values as texts."""

import base64
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.extremes import first_largest
from ...model.structure import Structure
from ...plot.fields import STATES
from .views import View

NODES, MEMBRANES, BARS, STATE = "nodes", "membranes", "cables and masts", "state"
DISPLACEMENTS = ("displacement", "displacement x", "displacement y", "displacement z")


class Field(NamedTuple):
    """One quantity that a scene can show.

    Attributes:
        name: Its name.
        unit: Its unit.
        group: What has it: `NODES`, `MEMBRANES`, `BARS`, or `STATE` for the states of all cells.
    """

    name: str
    unit: str
    group: str


def encoded(values: Any, kind: str) -> str:
    """Little-endian numbers in base64, of the kind "f4", "i4" or "u1"."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode()


def fields(structure: Structure, views: Iterable[View], length: str) -> list[Field]:
    """Fields that any view has, those of the nodes first."""
    found: dict[Field, None] = {}
    for view in views:
        if view.displacement is not None:
            found |= {Field(name, length, NODES): None for name in DISPLACEMENTS}
        for part, columns in view.columns.items():
            for head in columns:
                name, _, unit = head.partition(" [")
                group = MEMBRANES if structure.parts[part].dimension == 2 else BARS
                found[Field(name, unit[:-1], STATE if name == "state" else group)] = None
    order = [NODES, STATE, MEMBRANES, BARS]
    return sorted(found, key=lambda field: order.index(field.group))


def described(
    field: Field, structure: Structure, view: View, kept: Mapping[str, NDArray[np.int64]]
) -> dict[str, Any] | None:
    """Field of a view as plain data: extremes of all cells, values of the drawn ones by part; None if it has none."""
    if field.group == NODES:
        return _of_nodes(field, structure, view)
    head = f"{field.name} [{field.unit}]" if field.unit else field.name
    values = {
        part: columns[head]
        for part, columns in view.columns.items()
        if head in columns and _has(field, structure, part)
    }
    if not values:
        return None
    if field.group == STATE:
        values = {part: (states[:, None] == STATES).argmax(axis=1) for part, states in values.items()}
    told = _extremes(structure, values)
    kind = "u1" if field.group == STATE else "f4"
    if field.group == STATE:
        told["counts"] = np.bincount(np.concatenate(list(values.values())), minlength=len(STATES)).tolist()
    return told | {"values": {part: encoded(found[kept[part]], kind) for part, found in values.items()}}


def _has(field: Field, structure: Structure, part: str) -> bool:
    return field.group == STATE or (structure.parts[part].dimension == 2) == (field.group == MEMBRANES)


def _of_nodes(field: Field, structure: Structure, view: View) -> dict[str, Any] | None:
    """Extremes of a displacement; the page has its values from the displacement itself."""
    if view.displacement is None:
        return None
    nodes = np.flatnonzero(structure.used)
    axis = DISPLACEMENTS.index(field.name) - 1
    moved = view.displacement[nodes]
    values = np.linalg.norm(moved, axis=1) if axis < 0 else moved[:, axis]
    ends = {"least": first_largest(-values), "largest": first_largest(values)}
    told: dict[str, Any] = {"least": float(values.min()), "largest": float(values.max())}
    for end, row in ends.items():
        told[f"{end}_at"] = f"node {nodes[row]} at {_place(structure, structure.points[nodes[row]])}"
    return told


def _extremes(structure: Structure, values: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Least and largest value of all parts and their cells; None for both where no value is a number."""
    told: dict[str, Any] = {"least": None, "largest": None, "least_at": "", "largest_at": ""}
    joined = np.concatenate([found.astype(np.float64) for found in values.values()])
    if not np.isfinite(joined).any():
        return told
    owners = np.repeat(np.arange(len(values)), [len(found) for found in values.values()])
    cells = np.concatenate([np.arange(len(found)) for found in values.values()])
    parts = list(values)
    for end, sign in (("least", -1), ("largest", 1)):
        signed = np.where(np.isfinite(joined), sign * joined, -np.inf)
        row = first_largest(signed)
        part = parts[owners[row]]
        place = structure.points[structure.parts[part].cells[cells[row]]].mean(axis=0)
        told[end] = float(sign * signed.max())
        told[f"{end}_at"] = f"cell {cells[row]} of {part} at {_place(structure, place)}"
    return told


def _place(structure: Structure, point: NDArray[np.float64]) -> str:
    """Coordinates to four digits of the size of the structure, wherever its origin is."""
    digits = 3 - int(np.floor(np.log10(structure.size)))
    return f"({', '.join(f'{round(coordinate, digits) + 0.0:.15g}' for coordinate in point.tolist())})"
