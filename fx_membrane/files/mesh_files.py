"""Structures from files of drawing and modelling programs, by the names of their layers and groups."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..checks import paths, validation
from ..geometry.length_units import METRES
from ..model.structure import Structure
from ..runtime.messages import say
from . import compas, dxf, msh, obj, surface
from .drawing import Drawing, check, joined, nodes_of, triangles_of
from .gmsh import structure_from_gmsh
from .groups import Groups, Makers, check_arguments, structure

READERS: dict[str, Callable[[Path], Drawing]] = {
    ".dxf": dxf.read,
    ".obj": obj.read,
    ".stl": surface.read,
    ".ply": surface.read,
    ".json": compas.read,
    ".msh": msh.read,
}
OWN = "m"  # unit of length of a structure that names none, as in `write_mesh`


def structure_from_file(
    source: str | Path,
    parts: Makers,
    supports: Mapping[str, str] | None = None,
    separate: Sequence[tuple[str, str]] = (),
    *,
    weld: float | None = None,
    split_quadrilaterals: bool = False,
    unit: str | None = None,
) -> Structure:
    """Structure of a mesh file of another program: DXF, OBJ, STL, PLY, COMPAS JSON or gmsh's msh, by its ending.

    - .dxf: a group is a layer. Faces are 3DFACE, MESH and polyface meshes, lines are LINE and polylines, points are
      POINT; blocks are taken, too.
    - .obj: a group is a group or an object, of faces, lines or points; faces may be in several groups.
    - .stl, .ply: the group of all faces has the name of the file without its ending.
    - .json: the groups "edges", "faces" and "supports" are those of a network, graph or mesh, by `is_support`.
    - .msh: a group is a physical group, see `structure_from_gmsh`.

    Corners of DXF and STL at the same place are one node; the other formats number their nodes. No file runs code.

    Args:
        source: The file.
        parts: For each group, a function that makes a part of its cells, or of its cells and the points:
            `{"roof": lambda cells: Membrane(cells, fabric, 2e3)}`, `{"roof": lambda cells, points: Membrane(cells,
            fabric, 2e3, warp=points[cells].mean(axis=1))}`. Cells are rows of the points, shape (n, 3) or (n, 2).
        supports: For each group, the constrained components of its nodes: those of its points if it has any, or else of
            its lines and faces.
        separate: Pairs of names of parts that lie on each other without being joined, see `Structure`.
        weld: Distance within which nodes are joined, in the unit of the structure; what it joins is said on stderr.
        split_quadrilaterals: Split quadrilaterals into triangles along the shorter diagonal, concave ones along the
            inner one; they are refused otherwise.
        unit: Unit of length of the structure: "m", "mm", "ft", ... A DXF file that names its own is converted; the
            numbers of other files are taken in this unit. Without a unit here, numbers are taken as they are. Both are
            said on stderr, but for a DXF file in metres, or in the unit given.

    Raises:
        ValueError: An argument is of another kind; the ending is not known; the file cannot be read, or is not of that
            format; a group does not exist, or has lines and faces; its cells do not fit its part; a support is on no
            part.
        ImportError: The package that reads the format is not installed.
    """
    file = paths.path("source", source, spare=0)
    check_arguments(parts, supports)
    weld = None if weld is None else validation.positive("weld", weld)
    split = validation.truth("split_quadrilaterals", split_quadrilaterals)
    if unit is not None:
        validation.choice("unit", unit, list(METRES), f"one of {list(METRES)}")
    if file.suffix.lower() == ".msh" and weld is None:
        tell_lack_of_unit(str(file), "", unit)
        return structure_from_gmsh(file, parts, supports, separate)
    drawing = drawing_of(file, weld, unit)
    tell_lack_of_unit(drawing.source, drawing.unit, unit)
    tell_unit_taken(file, drawing, unit, "give unit=... to convert them")
    groups = Groups(
        points=drawing.points,
        cells={name: triangles_of(drawing, name, split) for name in parts},
        nodes={name: nodes_of(drawing, name) for name in supports or {}},
        kind=drawing.group,
        label=lambda row: f"node {row}",
    )
    return structure(groups, parts, supports or {}, separate)


def drawing_of(file: Path, weld: float | None, unit: str | None) -> Drawing:
    """Content of a mesh file, its corners joined and its unit converted, see `structure_from_file`.

    Args:
        file: The file.
        weld: Distance within which nodes are joined.
        unit: Unit of length of the content; that of the file if not given.

    Raises:
        ValueError: The ending is not known; the file cannot be read, or is not of that format; a cell collapses.
        ImportError: The package that reads the format is not installed.
    """
    ending = file.suffix.lower()
    if ending not in READERS:
        raise ValueError(f"{str(file)!r} has no ending of a mesh file; give a file that ends in {', '.join(READERS)}.")
    if not file.is_file():
        raise ValueError(f"There is no file {str(file)!r}; correct the name.")
    try:
        drawing = READERS[ending](file)
    except OSError as error:
        raise ValueError(f"{file} cannot be read ({error.strerror}).") from None
    if not (drawing.cells or drawing.refused):
        there = ", ".join(f"{count} {kind}" for kind, count in drawing.left_out.items())
        raise ValueError(
            f"{file} has no faces, lines or points{f', only {there}' if there else ''}; export the mesh again."
        )
    check(drawing)
    if drawing.unit and unit:
        drawing.points = drawing.points * (METRES[drawing.unit] / METRES[unit])
    return joined(drawing, weld)


def tell_lack_of_unit(source: str, own: str, wanted: str | None) -> None:
    """Say that the numbers of a file without a unit are taken in that of the structure."""
    if wanted and not own:
        say(f"{source} names no unit of length; its numbers are taken in {wanted}.")


def tell_unit_taken(file: Path, drawing: Drawing, wanted: str | None, remedy: str) -> None:
    """Say that numbers in another unit than metres are taken as they are, where none is wanted."""
    if drawing.unit not in ("", OWN) and wanted is None:
        say(f"{file} is in {drawing.unit}, and its numbers are taken as they are; {remedy}.")
