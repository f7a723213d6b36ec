"""Meshes of structures, deformed states and found shapes, for other programs: msh, OBJ and DXF."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import paths, validation
from ..form_finding.form import Form
from ..model.structure import Structure
from ..results.states import StageResult
from ..runtime.processes import by_the_first
from . import dxf
from .whole_file import writing

ELEMENTS = {1: 15, 2: 1, 3: 2}  # of gmsh, by number of corners
FORBIDDEN = {".dxf": '<>/\\":;?*|=`,', ".msh": '"', ".obj": "\\"}  # letters that names of groups cannot have


class Group(NamedTuple):
    """Cells under one name.

    Attributes:
        name: The name.
        cells: Rows of their nodes, shape (cells, corners): 1 for points, 2 for lines, 3 for triangles.
    """

    name: str
    cells: NDArray[np.int64]


@by_the_first
def write_mesh(shape: Structure | StageResult | Form, path: str | Path, *, length_unit: str | None = None) -> None:
    """Write the mesh of a structure, a deformed state or a found shape, in the format of the ending.

    - `.msh`: gmsh's format 2.2, a physical group for each part, and one for each support, "support 0 xyz";
      `structure_from_gmsh` reads it back, to the last bit.
    - `.obj`: an object for each part, faces and lines; no supports.
    - `.dxf`: a layer for each part, 3DFACE and LINE; the unit of length; layers of points, "supports" for nodes held in
      all directions, "supports z" and the like for others.

    Numbers are not converted: the name of the unit goes into a DXF file, and the other formats have none. An existing
    file is replaced by a complete one. Under MPI call it on all processes; the first one writes.

    Args:
        shape: A structure, in its reference shape; a state, in its deformed shape; or a form.
        path: The file; its folder is made.
        length_unit: Name of the length unit of the shape: "m", "mm", "ft", ...; None for that of the form, or "m". A
            DXF file is without a unit for "", and for a name that the format does not know.

    Raises:
        ValueError: The shape is of another kind; the ending is not known; the unit is not a text; the name of a part
            has letters that the format does not allow; the file cannot be written.
        ImportError: ezdxf is not installed.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> roof = Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3))}, [Support([0, 2])])
        >>> write_mesh(roof, "output/roof.msh")
        >>> fabric = {"roof": lambda cells: Membrane(cells, Fabric(4e5, 0.3))}
        >>> structure_from_gmsh("output/roof.msh", fabric, {"support 0 xyz": "xyz"})
        Structure(9 points, {'roof': 8 x Membrane}, 1 support)
    """
    validation.instance("write_mesh shape", shape, Structure | StageResult | Form)
    structure = shape if isinstance(shape, Structure) else shape.structure
    points = shape.position if isinstance(shape, StageResult) else shape.points
    own = shape.length_unit if isinstance(shape, Form) else "m"
    unit = validation.text("length_unit", own if length_unit is None else length_unit)
    file = paths.path("path", path)
    ending = file.suffix.lower()
    groups = [Group(name, part.cells) for name, part in structure.parts.items()]
    write_groups(file, points, [*groups, *SUPPORTS.get(ending, _none)(structure)], unit)


def write_groups(file: Path, points: NDArray[np.float64], groups: Sequence[Group], unit: str) -> None:
    """Write groups of cells in the format of the ending.

    Args:
        file: The file.
        points: Positions of the nodes, shape (n, 3).
        groups: The groups.
        unit: Name of the unit of length, for DXF; empty for none.

    Raises:
        ValueError: The ending is not known; a name has letters that the format does not allow; the file cannot be
            written.
        ImportError: ezdxf is not installed.
    """
    ending = file.suffix.lower()
    if ending not in WRITERS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in {', '.join(WRITERS)}.")
    paths.check_writable("path", file)
    for name, _ in groups:
        bad = [letter for letter in name if letter in FORBIDDEN[ending] or not letter.isprintable()]
        if bad or (ending == ".obj" and name != " ".join(name.split())):
            letter = repr(bad[0]) if bad else "more than one space, or one at an end,"
            raise ValueError(
                f"Part {name!r} has {letter} in its name, which {ending[1:]} files cannot have; name it otherwise."
            )
    with writing(file, encoding="utf-8") as stream:
        WRITERS[ending](stream, points, groups, unit)


def _none(structure: Structure) -> list[Group]:
    return []


def _by_support(structure: Structure) -> list[Group]:
    return [
        Group(f"support {number} {support.components}", np.asarray(support.nodes)[:, None])
        for number, support in enumerate(structure.supports)
    ]


def _by_components(structure: Structure) -> list[Group]:
    """Nodes that are held in the same components, those in all of them first."""
    kinds = sorted(map(tuple, np.unique(structure.supported, axis=0).tolist()), reverse=True)
    return [
        Group(
            "supports" if all(kind) else f"supports {''.join(np.array(list('xyz'))[list(kind)])}",
            np.flatnonzero((structure.supported == kind).all(axis=1))[:, None],
        )
        for kind in kinds
        if any(kind)
    ]


SUPPORTS: dict[str, Callable[[Structure], list[Group]]] = {".msh": _by_support, ".dxf": _by_components}


def _write_msh(stream: IO[str], points: NDArray[np.float64], groups: Sequence[Group], unit: str) -> None:
    stream.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
    for tag, (name, cells) in enumerate(groups, 1):
        stream.write(f'{cells.shape[1] - 1} {tag} "{name}"\n')
    stream.write(f"$EndPhysicalNames\n$Nodes\n{len(points)}\n")
    stream.writelines(f"{row} {x!r} {y!r} {z!r}\n" for row, (x, y, z) in enumerate(points.tolist(), 1))
    stream.write(f"$EndNodes\n$Elements\n{sum(len(cells) for _, cells in groups)}\n")
    number = 0
    for tag, (_, cells) in enumerate(groups, 1):
        for row in (cells + 1).tolist():
            number += 1
            stream.write(f"{number} {ELEMENTS[len(row)]} 2 {tag} {tag} {' '.join(map(str, row))}\n")
    stream.write("$EndElements\n")


def _write_obj(stream: IO[str], points: NDArray[np.float64], groups: Sequence[Group], unit: str) -> None:
    """Name objects, `o`: the name of a group, `g`, ends at a space."""
    stream.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
    for name, cells in groups:
        stream.write(f"o {name}\n")
        kind = "plf"[cells.shape[1] - 1]
        stream.writelines(f"{kind} {' '.join(map(str, row))}\n" for row in (cells + 1).tolist())


def _write_dxf(stream: IO[str], points: NDArray[np.float64], groups: Sequence[Group], unit: str) -> None:
    try:
        import ezdxf  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError("DXF files need the package ezdxf; install it by pip install 'fx-membrane[dxf]'.") from None
    codes = {name: code for code, name in dxf.UNITS.items()}
    document = ezdxf.new("R2010", units=codes.get(unit, 0))  # $INSUNITS
    document.header["$MEASUREMENT"] = int(unit not in dxf.IMPERIAL)
    space = document.modelspace()
    for name, cells in groups:
        layer = {"layer": name}
        if not document.layers.has_entry(name):
            document.layers.add(name)
        for corners in points[cells].tolist():
            if len(corners) == 3:
                space.add_3dface(corners, dxfattribs=layer)
            elif len(corners) == 2:
                space.add_line(*corners, dxfattribs=layer)
            else:
                space.add_point(corners[0], dxfattribs=layer)
    document.write(stream)


WRITERS: dict[str, Callable[[IO[str], NDArray[np.float64], Sequence[Group], str], None]] = {
    ".msh": _write_msh,
    ".obj": _write_obj,
    ".dxf": _write_dxf,
}
