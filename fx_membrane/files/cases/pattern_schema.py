"""Schema of cutting patterns in case files."""

from __future__ import annotations

from typing import Annotated, Literal

from .change_schema import Change
from .fields import Compensation, Direction, Length, Node, Number, Point, SurfacePoint, Truth
from .load_schema import Load
from .table import Kept, Model


class PlaneModel(Model):
    """Plane that cuts seams, see `planar_cut`."""

    point: Point
    normal: Direction


class FamilyModel(Model):
    """Seams between two borders, each a cable or nodes, by number of strips or `roll_width`; see `seams_between`."""

    first: str | list[Node]
    last: str | list[Node]
    strips: int | None = None


class AllowancesModel(Model):
    """Widths of cloth beyond the sewing lines, see `Allowances`."""

    seam: Length | None = None
    border: Length | None = None
    pocket: Length | None = None
    edges: dict[str, Length] = {}
    corners: Literal["mitre", "straight"] | None = None
    mitre_limit: Number | None = None


class PatternsModel(Model):
    """Cutting pattern of the found form, with seams along geodesics, planes, families of geodesics, and cables.

    The warp of strips is along their axes, or a direction by name of the strip, see `cut_strips`. Compensation is
    "prestress", factors or biaxial tests, `{ stress = [[1, 1], [3, 3]], elongation = [[0.002, 0.006],
    [0.006, 0.010]] }`, for all strips or each by name, see `cutting_pattern`. Without it, in `decompensate`, are edges
    by name, cables for the edges along them, and corners by name or number. With `nearest_stress` outlines then move
    until the stress after assembly is nearest to the prestress, see `nearest_stress_pattern`. With `copies` strips that
    are alike to the `copy_tolerance` are cut once, see `with_copies`. Loads and changes act in the proof, see
    `prove_pattern`; a `stress_error` that more than 5 % of the area exceed is a limit exceeded.
    """

    part: str | None = None
    geodesics: list[list[SurfacePoint]] = []
    planes: list[Annotated[PlaneModel, Kept]] = []
    between: list[Annotated[FamilyModel, Kept]] = []
    cables: list[str] = []
    size: Length | None = None
    names: list[str] | None = None
    warp: dict[str, Direction] = {}
    copies: Truth = False
    copy_tolerance: Length | None = None
    nearest_stress: Truth = False
    compensation: Compensation = "prestress"
    decompensate: list[Node] = []
    transition: Length | None = None
    allowances: Annotated[AllowancesModel, Kept] | None = None
    loads: list[Load] = []
    changes: list[Change] = []
    stress_error: Number | None = None
    roll_width: Length | None = None
    mark_spacing: Length | None = None
    material: str = ""
    date: str = ""
    paper: str | None = None
    scale: int | None = None
