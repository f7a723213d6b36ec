"""Fields of a scene: their least and largest values with places, and their values as texts."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.extremes import first_largest
from ...model.structure import Structure
from ...plot.fields import STATES
from .view_data import View

NODES, MEMBRANES, BARS, STATE = "nodes", "membranes", "cables and masts", "state"
DISPLACEMENTS = ("displacement", "displacement x", "displacement y", "displacement z")


class Field(NamedTuple):
    """Quantity that a scene can show.

    Attributes:
        head: Its name and unit, as in tables: "force [kN]".
        group: What has it: `NODES`, `MEMBRANES`, `BARS`, or `STATE` for the states of all cells.
    """

    head: str
    group: str

    @property
    def name(self) -> str:
        """Name, without the unit."""
        return self.head.partition(" [")[0]

    @property
    def unit(self) -> str:
        """Unit; empty for states."""
        return self.head.partition(" [")[2][:-1]


def encoded(values: Any, kind: str) -> str:
    """Little-endian numbers in base64, of the kind "f4", "i4" or "u1"."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.asarray(values).astype(f"<{kind}").tobytes()).decode()


def fields(structure: Structure, views: Iterable[View], length: str) -> list[Field]:
    """Fields that any view has, those of the nodes first."""
    found: dict[Field, None] = {}
    for view in views:
        if view.displacement is not None:
            found |= {Field(f"{name} [{length}]", NODES): None for name in DISPLACEMENTS}
        for part, columns in view.columns.items():
            for head in columns:
                group = MEMBRANES if part in structure.membranes else BARS
                found[Field(head, STATE if head == "state" else group)] = None
    order = [NODES, STATE, MEMBRANES, BARS]
    return sorted(found, key=lambda field: order.index(field.group))


def described(
    field: Field, structure: Structure, view: View, kept: Mapping[str, NDArray[np.int64]]
) -> dict[str, Any] | None:
    """Field of a view as plain data: extremes of all cells, values of the drawn ones by part; None if it has none."""
    if field.group == NODES:
        return _of_nodes(field, structure, view)
    values = {
        part: columns[field.head]
        for part, columns in view.columns.items()
        if field.head in columns and _has(field, structure, part)
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
    return field.group == STATE or (part in structure.membranes) == (field.group == MEMBRANES)


def _of_nodes(field: Field, structure: Structure, view: View) -> dict[str, Any] | None:
    """Extremes of a displacement; the page has its values from the displacement itself."""
    if view.displacement is None:
        return None
    nodes = np.flatnonzero(structure.used)
    axis = DISPLACEMENTS.index(field.name) - 1
    moved = view.displacement[nodes]
    points = structure.points

    def place(row: int) -> str:
        return f"node {nodes[row]} at {_place(structure, points[nodes[row]])}"

    return _ends(np.linalg.norm(moved, axis=1) if axis < 0 else moved[:, axis], place)


def _extremes(structure: Structure, values: Mapping[str, NDArray[Any]]) -> dict[str, Any]:
    """Least and largest value of the cells of all parts."""
    owners = np.repeat(np.arange(len(values)), [len(found) for found in values.values()])
    cells = np.concatenate([np.arange(len(found)) for found in values.values()])
    parts = list(values)

    def place(row: int) -> str:
        part = parts[owners[row]]
        centre = structure.points[structure.parts[part].cells[cells[row]]].mean(axis=0)
        return f"cell {cells[row]} of {part} at {_place(structure, centre)}"

    return _ends(np.concatenate([found.astype(np.float64) for found in values.values()]), place)


def _ends(values: NDArray[np.float64], place: Callable[[int], str]) -> dict[str, Any]:
    """Least and largest value with the places of their rows; None for both where no value is a number."""
    told: dict[str, Any] = {"least": None, "largest": None, "least_at": "", "largest_at": ""}
    if np.isfinite(values).any():
        for end, sign in (("least", -1), ("largest", 1)):
            signed = np.where(np.isfinite(values), sign * values, -np.inf)
            told[end] = float(sign * signed.max())
            told[f"{end}_at"] = place(first_largest(signed))
    return told


def _place(structure: Structure, point: NDArray[np.float64]) -> str:
    """Coordinates to four digits of the size of the structure, wherever its origin is."""
    digits = 3 - int(np.floor(np.log10(structure.size)))
    return f"({', '.join(f'{round(coordinate, digits) + 0.0:.15g}' for coordinate in point.tolist())})"
