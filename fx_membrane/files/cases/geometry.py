"""Geometry of a case: a grid, a sail drawn in plan, a mesh file, or points by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from ...checks import validation
from ...geometry.grids import polyline, rectangle
from ...runtime.messages import say
from ...surfaces.sail import SailMesh
from ..drawing import Drawing
from ..mesh_files import drawing_of, tell_unit_taken
from .faults import Faults, Unknown, at_key
from .making import make
from .sail import sail_of
from .structure_schema import FileGeometry, GridGeometry, PointGeometry, SailGeometry, UnitNames
from .table import BROKEN, given, is_whole

MANY_TRIANGLES = 1_000_000  # triangles of a grid, of which a word is due


def drawing_from(faults: Faults, table: Any, folder: Path, units: UnitNames | None) -> Drawing:
    """Points and groups of the geometry.

    Args:
        faults: Faults found so far.
        table: The table of the geometry.
        folder: Folder from which names of files are taken.
        units: Units of the case; None if it names none.

    Raises:
        ValueError: The geometry has a fault.
        Unknown: Some of its keys have a fault.
        ImportError: A package that it needs is not installed.
    """
    if isinstance(table, FileGeometry):
        unit = units.length if units else None
        weld, count = table.weld, len(faults)
        with faults.at("geometry", "weld"):
            weld = None if weld in (None, BROKEN) else validation.positive("weld", weld)
        if table.file is BROKEN:
            raise Unknown
        with at_key("file"):
            found = drawing_of(folder / table.file, weld, unit)
            remedy = 'give units = { force = "kN", length = "m" } to convert them'
            tell_unit_taken(folder / table.file, found, unit, remedy)
        if len(faults) > count or not is_whole(table):
            raise Unknown
        if not (found.unit or unit):
            say(f"Neither {table.file} nor the case names a unit of length; all numbers are taken in the same units.")
        return found
    drawing = Drawing("the geometry", "group", np.zeros((0, 3)))
    if isinstance(table, GridGeometry):
        if is_whole((table.columns, table.rows)) and 2 * table.columns * table.rows > MANY_TRIANGLES:
            say(f"The grid has {2 * table.columns * table.rows} triangles; a run takes gigabytes and hours for it.")
        sound = {"width": 1.0, "height": 1.0, "columns": 1, "rows": 1}
        drawing.points, triangles = make(faults, ("geometry",), rectangle, given(table, "kind"), sound)
        drawing.add("grid", triangles)
    elif isinstance(table, SailGeometry):
        _add_sail(drawing, sail_of(faults, table))
    elif not is_whole(table):
        raise Unknown
    else:
        drawing.points = np.array(table.points, dtype=np.float64).reshape(-1, 3)
    return drawing


def groups_of(table: Any) -> set[str] | None:
    """Names of the groups of a geometry, although it may have a fault; None if they are not known."""
    if isinstance(table, GridGeometry):
        return {"grid"}
    if isinstance(table, PointGeometry):
        return set()
    tables = [getattr(table, key, None) for key in ("corners", "points", "holes", "lines")]
    if not isinstance(table, SailGeometry) or not all(entry is None or isinstance(entry, dict) for entry in tables):
        return None
    corners = list(table.corners)
    edges = {f"{a}-{b}" for a, b in zip(corners, [*corners[1:], *corners[:1]], strict=True)}
    return {"sail"}.union(edges, *(entry or {} for entry in tables))


def _add_sail(drawing: Drawing, mesh: SailMesh) -> None:
    drawing.points = mesh.points
    drawing.add("sail", mesh.triangles)
    for name, line in mesh.lines.items():
        drawing.add(name, polyline(line))
    for name, node in mesh.nodes.items():
        drawing.add(name, np.array([[node]]))
