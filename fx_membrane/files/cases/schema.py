"""Schema of case files: the file's mirror only. The package's own classes check the values."""

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from .fields import (
    AreaLoad,
    AreaMass,
    Direction,
    Directions,
    Displacement,
    Force,
    ForcePerLength,
    Forces,
    ForceVector,
    Length,
    LineLoad,
    LineMass,
    Number,
    Point,
    Pressure,
    Range,
    Stress,
)

FORMAT = 1


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


class DisplacementModel(NodeChoice):
    """Prescribed displacement, see `PrescribedDisplacement`."""

    displacement: Displacement
    components: str | None = None


Geometry = Annotated[GridGeometry | FileGeometry | PointGeometry, Field(discriminator="kind")]
Material = Annotated[
    FabricMaterial | WovenMaterial | NeoHookeMaterial | MooneyRivlinMaterial, Field(discriminator="kind")
]
Part = Annotated[MembranePart | CablePart | MastPart, Field(discriminator="kind")]
Load = Annotated[
    PointLoadModel | AreaLoadModel | LineLoadModel | PlanLoadModel | PressureModel, Field(discriminator="kind")
]


class FormModel(Model):
    """Form finding before the stages: its method, and loads that the form balances."""

    loads: list[Load] = []
    tolerance: Number | None = None
    max_iterations: int | None = None


class UpdatedReference(FormModel):
    """See `updated_reference`."""

    method: Literal["updated reference"]


class ProjectedStress(FormModel):
    """See `projected_stress`."""

    method: Literal["projected stress"]
    cables: Literal["horizontal force", "force", "force density"] | None = None
    direction: Direction | None = None


FormFinding = Annotated[UpdatedReference | ProjectedStress, Field(discriminator="method")]


class NewtonModel(Model):
    """See `Newton`."""

    method: Literal["newton"]
    rtol: Number | None = None
    max_iterations: int | None = None
    line_search: bool | None = None


class FirstOrderModel(Model):
    """See `ConjugateGradient` and `SteepestDescent`."""

    method: Literal["conjugate gradient", "steepest descent"]
    preconditioner: str | None = None
    rtol: Number | None = None
    max_iterations: int | None = None


SolverModel = Annotated[NewtonModel | FirstOrderModel, Field(discriminator="method")]


class StageModel(Model):
    """A stage, see `Stage`."""

    name: str
    after: str | None = None
    increments: int | None = None
    loads: list[Load] = []
    displacements: list[DisplacementModel] = []


class OutputModel(Model):
    """Files that a run writes, in a folder beside the case file."""

    folder: str | None = None
    tables: bool = True
    archive: bool = True
    paraview: bool = True
    mesh: list[Literal["msh", "obj", "dxf"]] = []


class CaseModel(Model):
    """A whole case file."""

    format: Literal[1]
    title: str = ""
    units: UnitNames | None = None
    geometry: Geometry
    materials: dict[str, Material] = {}
    parts: dict[str, Part]
    supports: list[SupportModel] = []
    separate: list[tuple[str, str]] = []
    form_finding: FormFinding | None = None
    solver: SolverModel | None = None
    stages: list[StageModel] = []
    output: OutputModel = OutputModel()


def keys() -> set[str]:
    """Keys that any table of a case file has."""
    models, found = [Model], set[str]()
    while models:
        model = models.pop()
        found |= set(model.model_fields)
        models += model.__subclasses__()
    return found


def json_schema() -> dict[str, Any]:
    """JSON schema of case files, for editors."""
    return CaseModel.model_json_schema()
