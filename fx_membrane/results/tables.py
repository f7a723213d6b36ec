"""Tables of a state: columns of its nodes and of the cells of its parts, with units in their heads."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import measures
from .part_results import SHEAR, columns_of
from .states import StageResult

Columns = dict[str, NDArray[Any]]
WATER_DEPTH = "water depth"


def node_columns(
    result: StageResult, force_unit: str = "N", length_unit: str = "m", water: bool | None = None
) -> Columns:
    """Columns of the nodes: number, reference position, displacement, loads, reactions, depth of water; each (n,).

    The depth is left out where water is False, or None and no pond acts.
    """
    columns: Columns = {"node": np.arange(len(result.displacement))}
    columns |= _vector(("x", "y", "z"), length_unit, result.structure.points)
    columns |= _vector(("displacement x", "displacement y", "displacement z"), length_unit, result.displacement)
    columns |= _vector(("load x", "load y", "load z"), force_unit, result.loads)
    columns |= _vector(("reaction x", "reaction y", "reaction z"), force_unit, result.reactions)
    if water or (water is None and result.ponds):
        columns[f"{WATER_DEPTH} [{length_unit}]"] = result.water_depth
    return columns


def cell_columns(
    result: StageResult, part: str, force_unit: str = "N", length_unit: str = "m", water: bool | None = None
) -> Columns:
    """Columns of the cells of a part: number, reference centroid and size, state, strains, stresses or force.

    Membranes have the mean depth of the water on them, too; not where water is False, or None and no pond acts.

    Strains and the stress along warp and weft are in the warp/weft frame, see `MembraneResult`. The shear of a membrane
    without two sides has no sign, and is not a number here. Each column has shape (cells,).

    Raises:
        ValueError: There is no part of that name.
    """
    if not isinstance(part, str) or part not in result.parts:
        raise ValueError(f"part is {validation.short_repr(part)}; those of the structure are {list(result.parts)}.")
    cells, points = result.structure.parts[part].cells, result.structure.points
    columns: Columns = {"cell": np.arange(len(cells))}
    columns |= _vector(("x", "y", "z"), length_unit, points[cells].mean(axis=1))
    if part in result.bars:
        columns[f"length [{length_unit}]"] = measures(points, cells)
        return columns | columns_of(result.bars[part], force_unit)
    columns[f"area [{length_unit}2]"] = measures(points, cells)
    columns |= columns_of(result.membranes[part], f"{force_unit}/{length_unit}")
    if not result.structure.has_sides(part):
        columns[SHEAR] = np.full(len(cells), np.nan)
    if water or (water is None and result.ponds):
        columns[f"{WATER_DEPTH} [{length_unit}]"] = result.water_on(part)
    return columns


def _vector(names: tuple[str, str, str], unit: str, values: NDArray[np.float64]) -> Columns:
    return {f"{name} [{unit}]": values[:, component] for component, name in enumerate(names)}
