"""Schema of case files: the file's mirror only. The package's own classes check the values."""

from typing import Annotated, Any, Literal

from pydantic import Field

from .fields import (
    AreaLoad,
    Direction,
    Displacement,
    ForceVector,
    LineLoad,
    Number,
    Pressure,
)
from .structure_schema import Box, Geometry, Material, Model, NodeChoice, Part, SupportModel, UnitNames


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
    paraview: bool | None = None
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
