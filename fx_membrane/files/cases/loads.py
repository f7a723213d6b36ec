"""Loads, prescribed displacements and constraints of a case."""

from typing import Any

from ... import CableDensity, CableForce, CableLength, CableSag, EdgeAngle, RigidBody, Ring, Slide
from ...model.loads import DistributedLoad, OwnLoad, PlanLoad, PointLoad, Pressure
from ...model.stages import PrescribedDisplacement
from .choices import CHOICES, Choices, Outline, given
from .load_schema import DisplacementModel, LineLoadModel, PlanLoadModel, PointLoadModel, PressureModel

OF_CABLES: dict[str, Any] = {
    "cable force": CableForce,
    "cable density": CableDensity,
    "cable length": CableLength,
    "cable sag": CableSag,
    "edge angle": EdgeAngle,
}
OF_NODES: dict[str, Any] = {"slide": Slide, "ring": Ring, "rigid body": RigidBody}


def load_of(choices: Choices, outline: Outline, table: Any) -> OwnLoad:
    """Make a load.

    Raises:
        ValueError: Its place does not exist, or is of another kind; its numbers are out of range.
        Unknown: Its place has a fault.
    """
    if isinstance(table, PointLoadModel):
        return PointLoad(choices.nodes(outline, table), table.force)
    cells = choices.cells(outline, table)
    if isinstance(table, PressureModel):
        return Pressure(table.pressure, table.part, cells)
    wanted = 1 if isinstance(table, LineLoadModel) else 2
    if outline.structure.parts[table.part].dimension != wanted:
        raise ValueError(f"a load of kind {table.kind!r} does not act on part {table.part!r}; give another kind")
    kind = PlanLoad if isinstance(table, PlanLoadModel) else DistributedLoad
    return kind(table.load, table.part, cells)


def displacement_of(choices: Choices, outline: Outline, table: DisplacementModel) -> PrescribedDisplacement:
    """Make a prescribed displacement.

    Raises:
        ValueError: Its nodes do not exist, or its numbers do not fit them.
        Unknown: Its place has a fault.
    """
    return PrescribedDisplacement(choices.nodes(outline, table), **given(table, *CHOICES))


def constraint_of(choices: Choices, outline: Outline, table: Any) -> Any:
    """Make a constraint of form finding.

    Raises:
        ValueError: Its place does not exist, or its numbers are out of range.
        Unknown: Its place has a fault.
    """
    if table.kind in OF_NODES:
        return OF_NODES[table.kind](choices.nodes(outline, table), **given(table, *CHOICES, "kind"))
    cells = choices.cells(outline, table)
    if outline.structure.parts[table.part].dimension != 1:
        raise ValueError(f"part {table.part!r} is no cable; name one")
    return OF_CABLES[table.kind](cells=cells, **given(table, "kind", "cells", "where"))
