"""Schema of the structure in case files: units, geometry, materials, parts and supports."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Discriminator, Field, Tag, model_validator

from .fields import (
    Area,
    AreaMass,
    Direction,
    Directions,
    Force,
    ForcePerLength,
    Forces,
    Length,
    LineMass,
    LinePoint,
    Node,
    Number,
    PlaceRows,
    Places,
    Point,
    Pressure,
    Range,
    Shares,
    Stress,
    Truth,
)
from .table import Kept, Model


class UnitNames(Model):
    """Units of plain numbers, and of all results."""

    force: str = "N"
    length: str = "m"


class Box(Model):
    """Range of places, from least to largest; a number alone is a plane."""

    x: Range = None
    y: Range = None
    z: Range = None

    @model_validator(mode="after")
    def _of_some_range(self) -> Self:
        if self.x is None and self.y is None and self.z is None:
            raise ValueError("give a range of x, y or z, as { x = [0, 3] }")
        return self


class GridGeometry(Model):
    """A flat rectangle of triangles about the origin, with the group "grid", see `rectangle`."""

    kind: Literal["grid"]
    width: Length
    height: Length
    columns: int
    rows: int
    diagonals: str | None = None


class FileGeometry(Model):
    """A mesh file, beside the case file or below it, see `structure_from_file`."""

    kind: Literal["file"]
    file: str
    weld: Length | None = None
    split_quadrilaterals: Truth | None = None


def shape_of(value: Any) -> str:
    """Tell a table, a list and another value apart."""
    return "table" if isinstance(value, dict) else "list" if isinstance(value, list) else "value"


class HoleModel(Model):
    """A circular hole, see `RoundHole`."""

    centre: Places
    radius: Length


Hole = Annotated[
    Annotated[HoleModel, Tag("table")] | Annotated[PlaceRows, Tag("list")] | Annotated[PlaceRows, Tag("value")],
    Discriminator(shape_of),
]
Names = Annotated[
    Annotated[str, Tag("value")] | Annotated[list[str], Tag("list")] | Annotated[str, Tag("table")],
    Discriminator(shape_of),
]


class SailGeometry(Model):
    """A sail drawn in plan, see `sail_mesh`: the group "sail", one for each edge, hole and line, each corner and point.

    Corners and holes with corners are tables or lists of places.
    """

    kind: Literal["sail"]
    corners: Places
    size: Length
    sag: Shares = None
    holes: dict[str, Hole] = {}
    lines: dict[str, list[LinePoint]] = {}
    points: Places = None
    sizes: Places = None


class PointGeometry(Model):
    """Points by hand; parts name their cells."""

    kind: Literal["points"]
    points: list[Point]


class FabricMaterial(Model):
    """Isotropic fabric, see `Fabric`; Et, or E and thickness."""

    kind: Literal["fabric"]
    Et: ForcePerLength | None = None
    nu: Number
    E: Pressure | None = None
    thickness: Length | None = None


class WovenMaterial(Model):
    """Woven fabric, see `OrthotropicFabric`."""

    kind: Literal["woven"]
    Et_warp: ForcePerLength
    Et_weft: ForcePerLength
    nu: Number
    Gt: ForcePerLength


class NeoHookeMaterial(Model):
    """Incompressible foil, see `NeoHooke`; Gt, or E and thickness."""

    kind: Literal["neo-hooke"]
    Gt: ForcePerLength | None = None
    E: Pressure | None = None
    thickness: Length | None = None


class MooneyRivlinMaterial(Model):
    """Incompressible foil, see `MooneyRivlin`; C10t and C01t, or C10, C01 and thickness."""

    kind: Literal["mooney-rivlin"]
    C10t: ForcePerLength | None = None
    C01t: ForcePerLength | None = None
    C10: Pressure | None = None
    C01: Pressure | None = None
    thickness: Length | None = None


class PartModel(Model):
    """Cells of a part: groups of the geometry, by default that of its name; cells or lines of nodes; membrane edges."""

    group: Names | None = None
    cells: list[list[Node]] | None = None
    lines: list[list[Node]] | None = None
    edges_of: str | None = None
    where: Box | None = None


class AxisModel(Model):
    """Axis of a radial warp, see `RadialDirection`."""

    origin: Point = (0.0, 0.0, 0.0)
    axis: Direction = (0.0, 0.0, 1.0)


Warp = Annotated[
    Annotated[AxisModel, Tag("table")] | Annotated[Directions, Tag("list")] | Annotated[Directions, Tag("value")],
    Discriminator(shape_of),
]


class MembranePart(PartModel):
    """A membrane, see `Membrane`; its warp is along a vector, one per cell, or away from an axis."""

    kind: Literal["membrane"]
    material: str
    prestress: Stress = None
    warp: Warp = None
    compression_stiffness: Number | None = None
    mass: AreaMass | None = None
    natural_stretch: Shares = None


class BarPart(PartModel):
    """Cables or masts; axial_stiffness, or E and area."""

    axial_stiffness: Force | None = None
    E: Pressure | None = None
    area: Area | None = None
    prestress: Forces = None
    mass: LineMass | None = None
    natural_stretch: Shares = None


class CablePart(BarPart):
    """Cables, see `Cable`; axial_stiffness, or E and area."""

    kind: Literal["cable"]
    compression_stiffness: Number | None = None


class MastPart(BarPart):
    """Masts, see `Mast`; axial_stiffness, or E and area."""

    kind: Literal["mast"]


class RopePart(BarPart):
    """A rope along one line of cells, see `Rope`; axial_stiffness, or E and area."""

    kind: Literal["rope"]
    unstressed_length: Length | None = None
    force: Force | None = None
    compression_stiffness: Number | None = None


class NodeChoice(Model):
    """Nodes by number or name, by group of the geometry, by place, or the rim of a membrane; one of these."""

    nodes: list[Node] | None = None
    group: str | None = None
    where: Box | None = None
    rim_of: str | None = None


class SupportModel(NodeChoice):
    """A support, see `Support`."""

    components: str | None = None


Geometry = Annotated[GridGeometry | FileGeometry | SailGeometry | PointGeometry, Field(discriminator="kind"), Kept]
Material = Annotated[
    FabricMaterial | WovenMaterial | NeoHookeMaterial | MooneyRivlinMaterial, Field(discriminator="kind"), Kept
]
Part = Annotated[MembranePart | CablePart | MastPart | RopePart, Field(discriminator="kind"), Kept]
