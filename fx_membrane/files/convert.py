"""Conversion of mesh files from one format to another, group by group."""

from pathlib import Path

from ..checks import validation
from ..model.materials import Fabric
from ..model.parts import Cable, Membrane, Part
from ..model.structure import Structure
from ..runtime.messages import say
from .drawing import triangles_of
from .mesh_files import METRES, drawing_of
from .mesh_writer import write_mesh


def convert(source: Path, target: Path, unit: str | None = None) -> None:
    """Convert a mesh file: each group of lines or faces becomes one; quadrilaterals are split, curves left out.

    Args:
        source: The file to read.
        target: The file to write.
        unit: Unit of length of the target, for a source that names its own; its numbers stay if not given.

    Raises:
        ValueError: A format is not known, or a file cannot be read or written; a group has lines and faces.
        ImportError: A package that a format needs is not installed.
    """
    if unit is not None:
        validation.choice("unit", unit, list(METRES), f"one of {list(METRES)}")
    drawing = drawing_of(source, None, unit, "--unit m converts it")
    if unit is not None and not drawing.unit:
        raise ValueError(
            f"{source} names no unit of length, so nothing can be converted to {unit!r}; leave --unit out, or "
            "export it as DXF with its unit."
        )
    for words in drawing.refused.values():
        say(f"{words} It is left out here.")
    drawing.refused.clear()
    parts: dict[str, Part] = {}
    for name, groups in drawing.cells.items():
        if groups.keys() - {1}:
            cells = triangles_of(drawing, name, split=True)
            parts[name] = Membrane(cells, Fabric(1.0, 0.0)) if cells.shape[1] == 3 else Cable(cells, 1.0)
    write_mesh(Structure(drawing.points, parts), target, length_unit=unit or drawing.unit)
