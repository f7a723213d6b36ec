"""Schema of loads and prescribed displacements in case files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .fields import AreaLoad, ForceVector, Length, LineLoad, Places, Pressure, SpecificWeight, Volume
from .structure_schema import Box, NodeChoice
from .table import Kept, Model


class PointLoadModel(NodeChoice):
    """Equal force on each of some nodes, see `PointLoad`."""

    kind: Literal["point"]
    force: ForceVector


class CellChoice(Model):
    """Cells of a part by number, or by the place of their centroid; all without either."""

    part: str
    cells: list[int] | None = None
    where: Box | None = None


class AreaLoadModel(CellChoice):
    """Load of fixed direction per reference area of a membrane, see `DistributedLoad`."""

    kind: Literal["area"]
    load: AreaLoad


class LineLoadModel(CellChoice):
    """Load of fixed direction per reference length of cables or masts, see `DistributedLoad`."""

    kind: Literal["line"]
    load: LineLoad


class PlanLoadModel(CellChoice):
    """Load per plan area, as snow, see `PlanLoad`."""

    kind: Literal["plan"]
    load: AreaLoad


class PressureModel(CellChoice):
    """Pressure that follows the membrane, see `Pressure`."""

    kind: Literal["pressure"]
    pressure: Pressure


class PondModel(CellChoice):
    """Water of a specific weight on a membrane, by level, volume or depth of rain, see `Pond`."""

    kind: Literal["pond"]
    level: Length | None = None
    volume: Volume | None = None
    rain: Length | None = None
    weight: SpecificWeight
    drains: Annotated[NodeChoice, Kept] | None = None
    walls: Annotated[NodeChoice, Kept] | None = None


class DisplacementModel(NodeChoice):
    """Prescribed displacement, one for all nodes or one for each, see `PrescribedDisplacement`."""

    displacement: Places
    components: str | None = None


Load = Annotated[
    PointLoadModel | AreaLoadModel | LineLoadModel | PlanLoadModel | PressureModel | PondModel,
    Field(discriminator="kind"),
    Kept,
]
Displacement = Annotated[DisplacementModel, Kept]
