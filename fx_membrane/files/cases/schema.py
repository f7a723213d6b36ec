"""Schema of case files: the file's mirror only. The package's own classes check the values."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field

from .change_schema import Change
from .fields import Force, ForcePerLength, Length, Number, Time, Truth
from .form_schema import Steps
from .gas_schema import ChamberModel
from .load_schema import Displacement, Load
from .pattern_schema import PatternsModel
from .structure_schema import Geometry, Material, Part, SupportModel, UnitNames
from .table import Kept, Model

PictureName = Literal[
    "displacement", "principal stress I", "principal stress II", "axial force", "state", "water depth"
]


class NewtonModel(Model):
    """See `Newton`."""

    method: Literal["newton"]
    rtol: Number | None = None
    max_iterations: int | None = None
    line_search: Truth | None = None


class SteepestDescentModel(Model):
    """See `SteepestDescent`."""

    method: Literal["steepest descent"]
    preconditioner: str | None = None
    rtol: Number | None = None
    max_iterations: int | None = None


class ConjugateGradientModel(Model):
    """See `ConjugateGradient`."""

    method: Literal["conjugate gradient"]
    beta: Literal["FR", "PR"] | None = None
    preconditioner: str | None = None
    rtol: Number | None = None
    max_iterations: int | None = None


SolverModel = Annotated[
    NewtonModel | SteepestDescentModel | ConjugateGradientModel, Field(discriminator="method"), Kept
]


class LimitsModel(Model):
    """Limits of the checks: largest displacement; by part, strength over safety, stress of membranes, force of bars."""

    displacement: Length | None = None
    stress: dict[str, Annotated[ForcePerLength, Kept]] = {}
    force: dict[str, Annotated[Force, Kept]] = {}


class WorkModel(Model):
    """Largest work of each stage, see `WorkLimit`."""

    iterations: int | None = None
    seconds: Time | None = None


class StageModel(Model):
    """A stage, see `Stage`."""

    name: str
    after: str | None = None
    increments: int | None = None
    loads: list[Load] = []
    displacements: list[Displacement] = []
    changes: list[Change] = []


class OutputModel(Model):
    """Files that a run writes, in a folder beside the case file."""

    folder: str | None = None
    tables: Truth = True
    archive: Truth = True
    paraview: Truth | None = None
    mesh: list[Literal["msh", "obj", "dxf"]] = []
    report: list[Literal["html", "pdf"]] = []
    pictures: list[PictureName] = []
    animation: Literal["gif", "mp4"] | None = None
    scene: Truth = False


class CaseModel(Model):
    """A whole case file. Laws, energy terms, solvers and functions of place of your own need a script."""

    format: Literal[1]
    title: str = ""
    units: UnitNames | None = None
    geometry: Geometry
    materials: dict[str, Material] = {}
    parts: dict[str, Part]
    supports: list[Annotated[SupportModel, Kept]] = []
    separate: list[tuple[str, str]] = []
    chambers: dict[str, Annotated[ChamberModel, Kept]] = {}
    form_finding: Steps = []
    solver: SolverModel | None = None
    work: Annotated[WorkModel, Kept] | None = None
    limits: Annotated[LimitsModel, Kept] | None = None
    stages: list[Annotated[StageModel, Kept]] = []
    patterns: Annotated[PatternsModel, Kept] | None = None
    output: Annotated[OutputModel, Kept] = OutputModel()


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
    found = CaseModel.model_json_schema()
    steps = found["properties"]["form_finding"]
    found["properties"]["form_finding"] = {"anyOf": [steps["items"], steps]}
    return found
