"""Water that stands on a membrane, as plain data checked when created."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.sizes import normals
from ..geometry.topology import boundary_edges
from ..geometry.water_on_triangles import plan_areas
from .base_classes import AnyLoad

if TYPE_CHECKING:
    from .structure import Structure

Array = NDArray[np.float64]

MIN_UPWARD = 1e-3  # least upward component of a normal on which water stands
HOW = ("level", "volume", "rain")


@dataclass(frozen=True, eq=False)
class Pond(AnyLoad):
    """Water on a membrane in the current shape; its weight acts as pressure on the wet area.

    Water of a given level or volume has one level, and stands wherever the membrane is below it. A volume fills up to
    the lowest node of the rim, at its height at the start of the stage; the rest is lost. A later stage with
    the pond gives all of the volume again.

    Rain collects in the basins of the current shape: hollows, each with a level of its own. A basin receives the rain
    on the cells that drain into it; rain elsewhere runs off. A basin that is full spills over its rim, at its present
    height, into the next one or over the edge. Two basins merge where their water meets. Mergers are found at the ends
    of load increments; then the same load factor is solved again. Water that ran over before that is lost, so that a
    basin may end some micrometres below its rim. `StageResult.water_events` has all of these events.
    Hollows less deep than a thousandth of the deepest one belong to their neighbour. A membrane without hollows, as a
    level sheet, is one basin up to the lowest node of its rim.

    Drains cap the level at their present height; what is above it is lost. Gravity is along -z. Amounts of several
    stages on the same cells add up; a volume beside rain falls as more rain. Drains of all of them act, and for rain
    the walls of all, too. Paths (`equilibrium_path`) keep the basins of their start, up to their rims; they do not
    begin with the first water, nor with a new drain of rain.

    The load factor multiplies the weight of a given level, and the amount of a given volume or rain.

    Args:
        part: Name of the membrane.
        level: Height of the water [m], kept by inflow. One of level, volume and rain.
        volume: Volume of the water [m3].
        rain: Depth of rain on the area in plan, in the reference shape, of the membrane or of its `cells` [m].
        weight: Specific weight [N/m3]; 9.81 with kN and m.
        cells: Catchment of the pond, cells of the membrane, each once, shape (k,); all of them if not given.
        drains: Nodes into which water runs, shape (k,). They cap the level at the height that they have in the shape.
        walls: Nodes of the rim that hold water back, shape (k,), as at the symmetry of a model.

    Raises:
        ValueError: Not one of level, volume and rain is given; a number is not positive; part is not a text; cells or
            nodes are not whole numbers.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 8, 8)
        >>> points[:, 2] = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1])) - 1  # a pyramid, upside down
        >>> parts = {"roof": Membrane(triangles, Fabric(1e9, 0.0), prestress=1e6)}
        >>> roof = Structure(points, parts, [Support(range(len(points)))])
        >>> pond = Analysis(roof).run([Stage("rain", [Pond("roof", volume=1 / 6)])])["rain"].ponds[0]
        >>> round(pond.level, 6), round(pond.area, 6)
        (-0.5, 1.0)
    """

    part: str
    level: float | None = None
    volume: float | None = None
    rain: float | None = None
    weight: float = 9810.0
    cells: ArrayLike | None = None
    drains: ArrayLike = ()
    walls: ArrayLike = ()

    def __post_init__(self) -> None:
        validation.store(self, validation.text, "part")
        given = [name for name in HOW if getattr(self, name) is not None]
        if len(given) != 1:
            shown = " and ".join(given) if given else "no level, volume or rain"
            raise ValueError(f"Pond has {shown}; give one of level, volume and rain.")
        validation.store(self, validation.number if given == ["level"] else validation.positive, given[0])
        validation.store(self, validation.positive, "weight")
        if self.cells is not None:
            validation.keep(self, cells=validation.unique_indices("Pond cells", self.cells, "cell"))
        for name in ("drains", "walls"):
            validation.keep(self, **{name: validation.indices(f"Pond {name}", getattr(self, name), empty=True)})


def triangles_of(structure: Structure, pond: Pond) -> NDArray[np.int64]:
    """Triangles of the catchment of a pond, upwards, shape (k, 3)."""
    cells = structure.parts[pond.part].cells
    chosen = cells if pond.cells is None else cells[np.asarray(pond.cells)]
    return chosen if plan_areas(structure.points[chosen]).sum() >= 0 else chosen[:, [0, 2, 1]]


def together(ponds: Sequence[Pond]) -> Pond:
    """First of ponds on the same cells, with the drains and walls of all."""
    first = ponds[0]
    nodes = {
        name: np.unique(np.concatenate([np.asarray(getattr(pond, name)) for pond in ponds]))
        for name in ("drains", "walls")
    }
    if all(np.isin(value, np.asarray(getattr(first, name))).all() for name, value in nodes.items()):
        return first
    return replace(first, drains=nodes["drains"], walls=nodes["walls"])


def amount(structure: Structure, pond: Pond) -> float:
    """Volume of the water that is given or falls as rain [m3]."""
    if pond.rain is None:
        return float(pond.volume or 0.0)
    return pond.rain * float(plan_areas(structure.points[triangles_of(structure, pond)]).sum())


def outlets(structure: Structure, pond: Pond) -> NDArray[np.int64]:
    """Nodes over which water runs off, shape (k,): the rim without its walls, and the drains."""
    rim = np.unique(boundary_edges(triangles_of(structure, pond)))
    return np.union1d(np.setdiff1d(rim, np.asarray(pond.walls)), np.asarray(pond.drains)).astype(np.int64)


def rim_height(structure: Structure, pond: Pond, shape: Array | None = None) -> float:
    """Lowest height of the rim without its walls, in a displaced shape (n, 3) [m]; infinite if walls close it."""
    nodes = np.setdiff1d(boundary_edges(triangles_of(structure, pond)), np.asarray(pond.walls))
    heights = structure.points[nodes, 2] + (0.0 if shape is None else shape[nodes, 2])
    return float(heights.min(initial=np.inf))


def check_pond(structure: Structure, stage: str, pond: Pond) -> None:
    """Refuse a pond that does not fit a structure.

    Raises:
        ValueError: The membrane, a cell or a node does not exist; the surface is vertical, or folded over itself in
            plan; the level is above the lowest node of the rim.
    """
    if pond.part not in structure.parts:
        raise ValueError(
            f"{stage} has a Pond on part {pond.part!r}, which does not exist; the parts are {list(structure.parts)}."
        )
    part = structure.parts[pond.part]
    if pond.part not in structure.membranes:
        raise ValueError(f"{stage} has a Pond on {pond.part!r}, a {type(part).__name__}; water stands on membranes.")
    structure.check_sides(pond.part)
    if pond.cells is not None:
        validation.in_range(f"{stage}: a Pond on {pond.part!r}", np.asarray(pond.cells), len(part.cells), "cell")
    triangles = triangles_of(structure, pond)
    upright = normals(structure.points, triangles)[:, 2]
    bad = int(upright.argmin())
    if upright[bad] < MIN_UPWARD:
        fault = "is vertical" if upright[bad] > -MIN_UPWARD else "is folded under the others"
        cell = bad if pond.cells is None else int(np.asarray(pond.cells)[bad])
        place = validation.format_point(structure.points[triangles[bad]].mean(axis=0))
        raise ValueError(
            f"{stage} has a Pond on {pond.part!r}, whose cell {cell} {fault}, at {place}; give the cells on which "
            "water can stand, cells=..."
        )
    rim = np.unique(boundary_edges(triangles))
    for name, allowed, where in (("drains", np.unique(triangles), "surface"), ("walls", rim, "rim")):
        stray = np.setdiff1d(np.asarray(getattr(pond, name)), allowed)
        if len(stray):
            raise ValueError(
                f"{stage} has a Pond on {pond.part!r} with {name} at node {stray[0]}, which is not on its {where}; "
                f"give nodes of the {where}."
            )
    nodes = outlets(structure, pond)
    limit = float(structure.points[nodes, 2].min(initial=np.inf))
    if pond.level is not None and pond.level > limit:
        node = int(nodes[structure.points[nodes, 2].argmin()])
        raise ValueError(
            f"{stage} has a Pond on {pond.part!r} of level {pond.level:g}, above its lowest rim or drain, node {node} "
            f"at height {limit:g}, where it runs off; lower the level, or name walls."
        )


def check_together(stage: str, structure: Structure, pond: Pond, other: Pond) -> None:
    """Refuse a pond on cells of another one that cannot share their level.

    Raises:
        ValueError: They share some cells, and not all; one has a given level; they differ in weight.
    """
    if pond is other or pond.part != other.part:
        return
    count = len(structure.parts[pond.part].cells)
    mine, theirs = (np.arange(count) if entry.cells is None else np.asarray(entry.cells) for entry in (pond, other))
    if not np.isin(mine, theirs).any():
        return
    fault = ""
    if not np.array_equal(mine, theirs):
        fault = "on some cells of one that stands there already; give both the same cells, or none in common"
    elif pond.level is not None or other.level is not None:
        fault = "where one stands already, and one of them has a given level; give volumes or rain, which add up"
    elif pond.weight != other.weight:
        fault = f"of weight {pond.weight:g} where one of weight {other.weight:g} stands already; give both the same"
    if fault:
        raise ValueError(f"{stage} adds a Pond on {pond.part!r} {fault}.")
