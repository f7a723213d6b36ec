"""Conversion of mesh files from one format to another, group by group."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from ..checks import validation
from ..geometry.length_units import METRES
from ..model.fabrics import Fabric
from ..model.parts import Cable, Membrane
from ..model.structure import Structure
from ..runtime.messages import say
from .drawing import Drawing, triangles_of
from .mesh_files import drawing_of
from .mesh_writer import Group, write_groups


def convert(source: Path, target: Path, unit: str | None = None) -> None:
    """Convert a mesh file: each group becomes one; quadrilaterals are split. Messages tell of all that is left out.

    Args:
        source: The file to read.
        target: The file to write.
        unit: Unit of length of the target, for a source that names its own; its numbers stay if not given.

    Raises:
        ValueError: A format is not known, or a file cannot be read or written; they are the same file; a group has
            lines and faces; there is nothing to convert.
        ImportError: A package that a format needs is not installed.
    """
    if unit is not None:
        validation.choice("unit", unit, list(METRES), f"one of {list(METRES)}")
    if target.exists() and source.exists() and target.samefile(source):
        raise ValueError(f"{target} is the file to convert, and would be lost; give another name.")
    drawing = drawing_of(source, None, unit)
    if unit is not None and not drawing.unit:
        raise ValueError(
            f"{source} names no unit of length, so nothing can be converted to {unit!r}; leave --unit out, or "
            "export it as DXF with its unit."
        )
    groups = [_group(drawing, name) for name in drawing.names if name not in drawing.refused or drawing.cells[name]]
    for words in drawing.refused.values():
        say(f"{words} It is left out here.")
    if drawing.left_out:
        told = ", ".join(f"{count} {kind}" for kind, count in sorted(drawing.left_out.items()))
        say(f"{source}: {told} left out, which are no faces, lines or points.")
    if not groups:
        raise ValueError(f"{source} has nothing that can be converted, and {target} is not written.")
    write_groups(target, drawing.points, groups, unit or drawing.unit)
    if drawing.unit and target.suffix.lower() != ".dxf":
        say(f"{target} names no unit of length; its numbers are in {unit or drawing.unit}.")


def _group(drawing: Drawing, name: str) -> Group:
    """Cells of a group; its points, if it has no others."""
    if drawing.cells[name].keys() == {1}:
        return Group(name, drawing.cells[name][1])
    rest = replace(drawing, refused={})
    cells = triangles_of(rest, name, split=True)
    part = Membrane(cells, Fabric(1.0, 0.0)) if cells.shape[1] == 3 else Cable(cells, 1.0)
    Structure(drawing.points, {name: part})  # refuses cells without area or length
    return Group(name, cells)
