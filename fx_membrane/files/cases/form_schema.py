"""Schema of form finding in case files: steps, each by a method, and constraints."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from .fields import Densities, Direction, Directions, Force, ForcePerLength, Length, Node, Number, Point, Stress, Truth
from .load_schema import CellChoice, Load
from .structure_schema import CablePart, MastPart, Names, NodeChoice, SupportModel, shape_of
from .table import Kept, Model


class CableForceModel(CellChoice):
    """Force of a cable, see `CableForce`."""

    kind: Literal["cable force"]
    force: Force
    horizontal: Truth | None = None


class CableDensityModel(CellChoice):
    """Force density of a cable, see `CableDensity`."""

    kind: Literal["cable density"]
    density: ForcePerLength


class CableLengthModel(CellChoice):
    """Length of a cable, see `CableLength`."""

    kind: Literal["cable length"]
    length: Length


class CableSagModel(CellChoice):
    """Sag of a cable, see `CableSag`."""

    kind: Literal["cable sag"]
    sag: Length
    along: Direction | None = None


class EdgeAngleModel(CellChoice):
    """Largest angle of an edge cable at its ends, in degrees, see `EdgeAngle`."""

    kind: Literal["edge angle"]
    angle: Number


class SlideModel(NodeChoice):
    """Nodes that slide on a line or on a plane, see `Slide`."""

    kind: Literal["slide"]
    direction: Directions = None
    normal: Directions = None


class RingModel(NodeChoice):
    """Nodes on a circle that stay round, see `Ring`."""

    kind: Literal["ring"]
    radius: Length | None = None


class RigidBodyModel(NodeChoice):
    """Nodes that move together, see `RigidBody`."""

    kind: Literal["rigid body"]


CableConstraint = CableForceModel | CableDensityModel | CableLengthModel | CableSagModel | EdgeAngleModel
Constraint = Annotated[CableConstraint | SlideModel | RingModel | RigidBodyModel, Field(discriminator="kind"), Kept]


class StressTerm(Model):
    """Stress as a power of the distance from an axis: the values, times (distance / at) ^ power."""

    values: Stress
    at: Length
    power: Number


class StressModel(Model):
    """Stress of a membrane as a function of place: a sum of powers of the distance from an axis."""

    origin: Point = (0.0, 0.0, 0.0)
    axis: Direction = (0.0, 0.0, 1.0)
    terms: list[StressTerm]


class MethodModel(Model):
    """A method on the whole structure: its loads, which the form balances, and its constraints, if it takes some."""

    loads: list[Load] = []
    constraints: list[Constraint] = []


class UpdatedReference(MethodModel):
    """See `updated_reference`."""

    method: Literal["updated reference"]
    tolerance: Number | None = None
    max_iterations: int | None = None


class ProjectedStress(MethodModel):
    """See `projected_stress`."""

    method: Literal["projected stress"]
    stress: dict[str, Annotated[StressModel, Kept]] = {}
    cables: Literal["horizontal force", "balanced force", "force", "force density"] | None = None
    direction: Direction | None = None
    tolerance: Number | None = None
    max_iterations: int | None = None


class NaturalForceDensity(MethodModel):
    """See `natural_force_density`."""

    method: Literal["natural force density"]
    iterations: int | None = None
    tolerance: Number | None = None


class PrescribedStress(MethodModel):
    """See `prescribed_stress`; a warp about an axis is taken anew where cells are, and `GeodesicDirection` by pairs."""

    method: Literal["prescribed stress"]
    stress: dict[str, Annotated[StressModel, Kept]] = {}
    geodesics: dict[str, Annotated[list[list[Node]], Kept]] = {}
    tolerance: Number | None = None
    max_iterations: int | None = None


class NetModel(Model):
    """Branches of one force density, or one for each: cables of a part, or lines of the geometry that make no part."""

    density: Densities
    part: str | None = None
    group: Names | None = None
    cells: list[list[Node]] | None = None
    lines: list[list[Node]] | None = None


class ForceDensity(MethodModel):
    """See `force_density`: nodes of the net move, and its parts get its forces; supports are those of the structure."""

    method: Literal["force density"]
    net: list[Annotated[NetModel, Kept]]
    supports: list[Annotated[SupportModel, Kept]] | None = None


class MastsAndStays(Model):
    """See `masts_and_stays`; points, a list or a table by name, get the numbers after the last node."""

    method: Literal["masts and stays"]
    bars: dict[str, Annotated[CablePart | MastPart, Field(discriminator="kind"), Kept]]
    points: Annotated[
        Annotated[list[Point], Tag("list")]
        | Annotated[dict[str, Point], Tag("table")]
        | Annotated[list[Point], Tag("value")],
        Discriminator(shape_of),
    ] = []
    heads: NodeChoice | None = None
    components: str | None = None


class NewMesh(Model):
    """See `remeshed`."""

    method: Literal["new mesh"]
    size: Length
    keep: NodeChoice | None = None


def _steps(value: Any) -> Any:
    return [value] if isinstance(value, dict) else value


Step = Annotated[
    UpdatedReference
    | ProjectedStress
    | NaturalForceDensity
    | PrescribedStress
    | ForceDensity
    | MastsAndStays
    | NewMesh,
    Field(discriminator="method"),
    Kept,
]
Steps = Annotated[list[Step], BeforeValidator(_steps)]
