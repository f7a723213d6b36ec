"""Structures from files of drawing and modelling programs, by the names of their layers and groups."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from ..checks import paths, validation
from ..model.structure import Structure
from ..runtime.messages import say
from . import compas, dxf, msh, obj, surface
from .drawing import Drawing, joined, nodes_of, triangles_of
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
METRES = {"mm": 1e-3, "cm": 1e-2, "dm": 0.1, "m": 1.0, "km": 1e3, "in": 0.0254, "ft": 0.3048, "yd": 0.9144}


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
    - .obj: a group is a group or an object, of faces or lines.
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
        unit: Unit of length of the structure: "m", "mm", "ft", ... A file that names its own is converted; without a
            unit here its numbers are taken as they are, and its unit is said on stderr.

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
        return structure_from_gmsh(file, parts, supports, separate)
    drawing = drawing_of(file, weld, unit)
    groups = Groups(
        points=drawing.points,
        cells={name: triangles_of(drawing, name, split) for name in parts},
        nodes={name: nodes_of(drawing, name) for name in supports or {}},
        kind=drawing.group,
        label=lambda row: f"node {row}",
    )
    return structure(groups, parts, supports or {}, separate)


def drawing_of(file: Path, weld: float | None, unit: str | None, remedy: str = "unit='m' converts it") -> Drawing:
    """Content of a mesh file, its corners joined and its unit converted, see `structure_from_file`.

    Args:
        file: The file.
        weld: Distance within which nodes are joined.
        unit: Unit of length of the content; that of the file if not given.
        remedy: Clause on the way to name a unit, for the message on a file that names its own.

    Raises:
        ValueError: The ending is not known; the file cannot be read, or is not of that format; a cell collapses.
        ImportError: The package that reads the format is not installed.
    """
    ending = file.suffix.lower()
    if ending not in READERS:
        raise ValueError(f"source is {str(file)!r}; give a file that ends in {', '.join(READERS)}.")
    if not file.is_file():
        raise ValueError(f"There is no file {str(file)!r}; correct the name.")
    try:
        drawing = READERS[ending](file)
    except OSError as error:
        raise ValueError(f"{file} cannot be read ({error.strerror}).") from None
    _convert(drawing, unit, remedy)
    return joined(drawing, weld)


def _convert(drawing: Drawing, unit: str | None, remedy: str) -> None:
    if drawing.unit and unit is None:
        say(f"{drawing.source} is in {drawing.unit}, and is taken as it is; {remedy}.")
    if drawing.unit and unit:
        drawing.points = drawing.points * (METRES[drawing.unit] / METRES[unit])
