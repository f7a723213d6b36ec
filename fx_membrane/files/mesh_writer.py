"""Meshes of structures, deformed states and found shapes, for other programs: msh, OBJ and DXF."""

from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from ..checks import paths, validation
from ..form_finding.form import Form
from ..model.structure import Structure
from ..results.states import StageResult
from ..runtime.processes import by_the_first
from . import dxf
from .whole_file import writing

POINT, LINE, TRIANGLE = 15, 1, 2  # types of elements in gmsh
FORBIDDEN = {".dxf": '<>/\\":;?*|=`,', ".msh": '"', ".obj": ""}  # letters that names of groups cannot have


@by_the_first
def write_mesh(shape: Structure | StageResult | Form, path: str | Path, *, length_unit: str = "m") -> None:
    """Write the mesh of a structure, of a deformed state or of a found shape, in the format of the ending.

    - `.msh`: gmsh's format 2.2, a physical group for each part, and one for each support, "support 0 xyz";
      `structure_from_gmsh` reads it back, to the last bit.
    - `.obj`: a group for each part, faces and lines.
    - `.dxf`: a layer for each part, 3DFACE and LINE; a layer "supports" of points; the unit of length.

    Numbers are not converted: the name of the unit goes into a DXF file, and the other formats have none. An existing
    file is replaced by a complete one. Under MPI call it on all processes; the first one writes.

    Args:
        shape: A structure, in its reference shape; a state, in its deformed shape; or a form.
        path: The file; its folder is made.
        length_unit: Name of the length unit of the shape: "m", "mm", "ft", ...; a DXF file is without a unit for "",
            and for a name that the format does not know.

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
    unit = validation.text("length_unit", length_unit)
    file = paths.path("path", path)
    ending = file.suffix.lower()
    if ending not in WRITERS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in {', '.join(WRITERS)}.")
    paths.check_writable("path", file)
    for name in structure.parts:
        bad = [letter for letter in name if letter in FORBIDDEN[ending] or not letter.isprintable()]
        if bad:
            raise ValueError(
                f"Part {name!r} has {bad[0]!r} in its name, which {ending[1:]} files cannot have; name it otherwise."
            )
    with writing(file, encoding="utf-8") as stream:
        WRITERS[ending](stream, structure, points, unit)


def _write_msh(stream: IO[str], structure: Structure, points: NDArray[np.float64], unit: str) -> None:
    groups: list[tuple[str, int, int, Any]] = [
        (name, part.dimension, TRIANGLE if part.dimension == 2 else LINE, part.cells)
        for name, part in structure.parts.items()
    ]
    groups += [
        (f"support {number} {support.components}", 0, POINT, np.asarray(support.nodes)[:, None])
        for number, support in enumerate(structure.supports)
    ]
    stream.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{len(groups)}\n")
    for tag, (name, dimension, _, _) in enumerate(groups, 1):
        stream.write(f'{dimension} {tag} "{name}"\n')
    stream.write(f"$EndPhysicalNames\n$Nodes\n{len(points)}\n")
    stream.writelines(f"{row} {x!r} {y!r} {z!r}\n" for row, (x, y, z) in enumerate(points.tolist(), 1))
    stream.write(f"$EndNodes\n$Elements\n{sum(len(cells) for *_, cells in groups)}\n")
    number = 0
    for tag, (_, _, kind, cells) in enumerate(groups, 1):
        for row in (cells + 1).tolist():
            number += 1
            stream.write(f"{number} {kind} 2 {tag} {tag} {' '.join(map(str, row))}\n")
    stream.write("$EndElements\n")


def _write_obj(stream: IO[str], structure: Structure, points: NDArray[np.float64], unit: str) -> None:
    stream.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
    for name, part in structure.parts.items():
        stream.write(f"g {name}\n")
        kind = "f" if part.dimension == 2 else "l"
        stream.writelines(f"{kind} {' '.join(map(str, row))}\n" for row in (part.cells + 1).tolist())


def _write_dxf(stream: IO[str], structure: Structure, points: NDArray[np.float64], unit: str) -> None:
    try:
        import ezdxf  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError("DXF files need the package ezdxf; install it by pip install 'fx-membrane[dxf]'.") from None
    codes = {name: code for code, name in dxf.UNITS.items()}
    document = ezdxf.new("R2010", units=codes.get(unit, 0))  # $INSUNITS
    document.header["$MEASUREMENT"] = int(unit not in dxf.IMPERIAL)
    space = document.modelspace()
    for name, part in structure.parts.items():
        layer = {"layer": name}
        if not document.layers.has_entry(name):
            document.layers.add(name)
        for corners in points[part.cells].tolist():
            if part.dimension == 2:
                space.add_3dface(corners, dxfattribs=layer)
            else:
                space.add_line(*corners, dxfattribs=layer)
    for node in np.flatnonzero(structure.supported.any(axis=1)):
        space.add_point(points[node].tolist(), dxfattribs={"layer": "supports"})
    document.write(stream)


WRITERS: dict[str, Callable[[IO[str], Structure, NDArray[np.float64], str], None]] = {
    ".msh": _write_msh,
    ".obj": _write_obj,
    ".dxf": _write_dxf,
}
