"""Mesh files of gmsh as drawings: cells and nodes by physical name."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from . import gmsh_file
from .drawing import Drawing

CORNERS = {"Point": 1, "Line 2": 2, "Triangle 3": 3, "Quadrilateral 4": 4}  # by gmsh's names of element types


def read(file: Path) -> Drawing:
    """Read the lines, triangles and quadrilaterals of first order, and the nodes, of each physical group.

    Raises:
        ValueError: It is no mesh; two groups have one name; a group has other elements.
        ImportError: gmsh is not installed.
    """
    mesh = gmsh_file.read(file)
    drawing = Drawing(str(file), "physical group", mesh.points)
    for group in mesh.groups:
        if group.name in drawing.cells:
            raise ValueError(f"{file} has two physical groups {group.name!r}; give each its own name.")
        for kind, cells in group.cells.items():
            if kind not in CORNERS:
                raise ValueError(
                    f"{file}: physical group {group.name!r} has elements of type {kind}; give lines or triangles."
                )
            drawing.add(group.name, np.searchsorted(mesh.tags, cells).reshape(-1, CORNERS[kind]))
        if group.dimension == 0 and group.name not in drawing.cells:
            drawing.add(group.name, np.searchsorted(mesh.tags, group.nodes)[:, None])
    return drawing
