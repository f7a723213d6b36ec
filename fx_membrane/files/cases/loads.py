"""Loads, prescribed displacements and constraints of a case."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import CableDensity, CableForce, CableLength, CableSag, EdgeAngle, RigidBody, Ring, Slide
from ...model.loads import DistributedLoad, OwnLoad, PlanLoad, PointLoad, Pressure, check_load
from ...model.ponds import HOW, Pond
from ...model.stages import PrescribedDisplacement
from ...model.supports import Support
from .choices import CHOICES, Choices, Outline
from .faults import Faults
from .load_schema import DisplacementModel, PointLoadModel
from .making import make
from .structure_schema import SupportModel
from .table import BROKEN, given, one_of, sound

OF_CABLES: dict[str, tuple[Any, str]] = {
    "cable force": (CableForce, "force"),
    "cable density": (CableDensity, "density"),
    "cable length": (CableLength, "length"),
    "cable sag": (CableSag, "sag"),
    "edge angle": (EdgeAngle, "angle"),
}
LOADS: dict[str, tuple[int, Any, dict[str, Any]]] = {  # dimension of the part, class, sound values
    "area": (2, DistributedLoad, {"load": (0.0, 0.0, 0.0)}),
    "line": (1, DistributedLoad, {"load": (0.0, 0.0, 0.0)}),
    "plan": (2, PlanLoad, {"load": (0.0, 0.0, 0.0)}),
    "pressure": (2, Pressure, {"pressure": 0.0}),
    "pond": (2, Pond, {"weight": 1.0}),
}
Trail = tuple[str | int, ...]
OF_NODES: dict[str, Any] = {"slide": Slide, "ring": Ring, "rigid body": RigidBody}


def load_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: Any) -> OwnLoad:
    """Make a load.

    Raises:
        ValueError: Its numbers do not fit together.
        Unknown: It has a fault, or its place has one.
    """
    if isinstance(table, PointLoadModel):
        return _on_nodes(faults, trail, choices, outline, table, PointLoad, {"force": (0.0, 0.0, 0.0)})
    wanted, kind, sound = LOADS[table.kind]
    cells: Any = BROKEN
    with faults.at(*trail):
        cells = choices.cells(outline, table, wanted)
    values = given(table, "kind", "where") | {"cells": cells}
    if table.kind == "pond":
        sound = sound | {next((key for key in HOW if key in values), "volume"): 1.0}
    for key in {"drains", "walls"} & values.keys():
        values[key] = BROKEN
        with faults.at(*trail, key):
            values[key] = choices.nodes(outline, getattr(table, key))
    return make(faults, trail, kind, values, {"part": "part", "cells": None, **sound}, _names(table))


def loads_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, tables: Any) -> list[Any]:
    """Make the loads of a stage or of a step, those without a fault."""
    loads = []
    for number, table in sound(tables):
        with faults.at(*trail, "loads", number):
            load = load_of(faults, (*trail, "loads", number), choices, outline, table)
            check_load(outline.structure, "The stage", load)
            loads.append(load)
    return loads


def supports_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, tables: Any) -> list[Support]:
    """Make the supports of a list, those without a fault."""
    supports = []
    for number, table in sound(tables):
        with faults.at(*trail, number):
            made = support_of(faults, (*trail, number), choices, outline, table)
            outline.structure.check_nodes("It", np.asarray(made.nodes))
            supports.append(made)
    return supports


def displacement_of(
    faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: DisplacementModel
) -> PrescribedDisplacement:
    """Make a prescribed displacement.

    Raises:
        ValueError: Its numbers do not fit its nodes.
        Unknown: It has a fault, or its place has one.
    """
    sound = {"displacement": (0.0, 0.0, 0.0)}
    return _on_nodes(faults, trail, choices, outline, table, PrescribedDisplacement, sound)


def support_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: SupportModel) -> Support:
    """Make a support.

    Raises:
        ValueError: It is of no node.
        Unknown: It has a fault, or its place has one.
    """
    return _on_nodes(faults, trail, choices, outline, table, Support, {})


def constraint_of(faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: Any) -> Any:
    """Make a constraint of form finding.

    Raises:
        ValueError: Its numbers do not fit together.
        Unknown: It has a fault, or its place has one.
    """
    if table.kind in OF_NODES:
        if table.kind == "slide":
            with faults.at(*trail):
                one_of(table, "direction", "normal", needed=True)
            if None not in (table.direction, table.normal) or table.direction is table.normal is None:
                table = table.model_copy(update={"direction": BROKEN})
        key = "normal" if getattr(table, "normal", None) is not None else "direction"
        sound = {key: (0.0, 0.0, 1.0)} if table.kind == "slide" else {}
        return _on_nodes(faults, trail, choices, outline, table, OF_NODES[table.kind], sound)
    cells: Any = BROKEN
    with faults.at(*trail):
        cells = choices.cells(outline, table, 1)
    kind, key = OF_CABLES[table.kind]
    values = given(table, "kind", "where") | {"cells": cells}
    return make(faults, trail, kind, values, {"part": "part", key: 1.0}, _names(table))


def _on_nodes(
    faults: Faults, trail: Trail, choices: Choices, outline: Outline, table: Any, kind: Any, sound: dict[str, Any]
) -> Any:
    nodes: Any = BROKEN
    with faults.at(*trail):
        nodes = choices.nodes(outline, table)
    values = given(table, *CHOICES, "kind") | {"nodes": nodes}
    if nodes is BROKEN:  # what may be one for each node is not known to fit
        values = {key: BROKEN if _nested(value) else value for key, value in values.items()}
    known = nodes if nodes is not BROKEN and any(map(_nested, values.values())) else [0, 1, 2]
    return make(faults, trail, kind, values, {"nodes": known, **sound}, _names(table))


def _nested(value: Any) -> bool:
    return isinstance(value, list | tuple) and any(isinstance(entry, list | tuple) for entry in value)


def _names(table: Any) -> dict[str, str]:
    """Keys by which a table chooses nodes or cells."""
    keys = [key for key in (*CHOICES, "cells") if getattr(table, key, None) is not None]
    return dict.fromkeys(("nodes", "cells"), keys[0]) if keys else {"cells": "part"}
