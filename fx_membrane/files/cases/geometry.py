"""Geometry of a case: a grid, a sail drawn in plan, a mesh file, or points by hand."""

from pathlib import Path
from typing import Any

import numpy as np

from ...checks import validation
from ...geometry.grids import polyline, rectangle
from ...surfaces.round_hole import RoundHole
from ...surfaces.sail import sail_mesh
from ..drawing import Drawing
from ..mesh_files import drawing_of
from .choices import given
from .structure_schema import FileGeometry, GridGeometry, HoleModel, SailGeometry, UnitNames


def drawing_from(table: Any, folder: Path, units: UnitNames | None) -> Drawing:
    """Points and groups of the geometry.

    Args:
        table: The table of the geometry.
        folder: Folder from which names of files are taken.
        units: Units of the case; None if it names none.

    Raises:
        ValueError: The geometry has a fault.
        ImportError: A package that it needs is not installed.
    """
    if isinstance(table, FileGeometry):
        unit = units.length if units else None
        weld = None if table.weld is None else validation.positive("weld", table.weld)
        return drawing_of(folder / table.file, weld, unit, 'units = { length = "m" } converts it')
    drawing = Drawing("the geometry", "group", np.zeros((0, 3)))
    if isinstance(table, GridGeometry):
        drawing.points, triangles = rectangle(**given(table, "kind"))
        drawing.add("grid", triangles)
    elif isinstance(table, SailGeometry):
        _draw_sail(drawing, table)
    else:
        drawing.points = np.array(table.points, dtype=np.float64).reshape(-1, 3)
    return drawing


def _draw_sail(drawing: Drawing, table: SailGeometry) -> None:
    options = given(table, "kind")
    options["holes"] = {name: _hole(hole) for name, hole in table.holes.items()}
    mesh = sail_mesh(**options)
    drawing.points = mesh.points
    drawing.add("sail", mesh.triangles)
    for name, line in mesh.lines.items():
        drawing.add(name, polyline(line))
    for name, node in mesh.nodes.items():
        drawing.add(name, np.array([[node]]))


def _hole(hole: Any) -> Any:
    return RoundHole(hole.centre, hole.radius) if isinstance(hole, HoleModel) else hole
