"""Schema of the structure in case files: units, geometry, materials, parts and supports."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from .fields import (
    AreaMass,
    Directions,
    Force,
    ForcePerLength,
    Forces,
    Length,
    LineMass,
    Number,
    Point,
    Range,
    Stress,
)


class Model(BaseModel):
    """A table of a case file: keys that it does not know are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class UnitNames(Model):
    """Units of plain numbers, and of all results."""

    force: str = "N"
    length: str = "m"


class Box(Model):
    """Range of places, from least to largest; a number alone is a plane."""

    x: Range = None
    y: Range = None
    z: Range = None


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
    split_quadrilaterals: bool | None = None


class PointGeometry(Model):
    """Points by hand; parts name their cells."""

    kind: Literal["points"]
    points: list[Point]


class FabricMaterial(Model):
    """Isotropic fabric, see `Fabric`."""

    kind: Literal["fabric"]
    Et: ForcePerLength
    nu: Number


class WovenMaterial(Model):
    """Woven fabric, see `OrthotropicFabric`."""

    kind: Literal["woven"]
    Et_warp: ForcePerLength
    Et_weft: ForcePerLength
    nu: Number
    Gt: ForcePerLength


class NeoHookeMaterial(Model):
    """Incompressible foil, see `NeoHooke`."""

    kind: Literal["neo-hooke"]
    Gt: ForcePerLength


class MooneyRivlinMaterial(Model):
    """Incompressible foil, see `MooneyRivlin`."""

    kind: Literal["mooney-rivlin"]
    C10t: ForcePerLength
    C01t: ForcePerLength


class PartModel(Model):
    """Cells of a part: a group of the geometry, by default that of its name; cells by hand; edges of a membrane."""

    group: str | None = None
    cells: list[list[int]] | None = None
    edges_of: str | None = None
    where: Box | None = None


class MembranePart(PartModel):
    """A membrane, see `Membrane`."""

    kind: Literal["membrane"]
    material: str
    prestress: Stress = None
    warp: Directions = None
    compression_stiffness: Number | None = None
    mass: AreaMass | None = None


class CablePart(PartModel):
    """Cables, see `Cable`."""

    kind: Literal["cable"]
    axial_stiffness: Force
    prestress: Forces = None
    compression_stiffness: Number | None = None
    mass: LineMass | None = None


class MastPart(PartModel):
    """Masts, see `Mast`."""

    kind: Literal["mast"]
    axial_stiffness: Force
    prestress: Forces = None
    mass: LineMass | None = None


class NodeChoice(Model):
    """Nodes by number, by group of the geometry, by place, or the rim of a membrane; one of these."""

    nodes: list[int] | None = None
    group: str | None = None
    where: Box | None = None
    rim_of: str | None = None


class SupportModel(NodeChoice):
    """A support, see `Support`."""

    components: str | None = None


Geometry = Annotated[GridGeometry | FileGeometry | PointGeometry, Field(discriminator="kind")]
Material = Annotated[
    FabricMaterial | WovenMaterial | NeoHookeMaterial | MooneyRivlinMaterial, Field(discriminator="kind")
]
Part = Annotated[MembranePart | CablePart | MastPart, Field(discriminator="kind")]
