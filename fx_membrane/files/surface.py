"""STL and PLY by pyvista: one surface without names."""

import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from . import surface_reader
from .drawing import Drawing

STL_HEAD, STL_FACET = 84, 50  # bytes of a binary file


def read(file: Path) -> Drawing:
    """Read the faces of a surface, as one group with the name of the file without its ending.

    Raises:
        ValueError: It is no surface, or a face has more than four corners.
        ImportError: pyvista is not installed.
    """
    damaged = f"{file} is no {file.suffix[1:].upper()} file, or is damaged; export the surface again."
    if not _begins_well(file):
        raise ValueError(damaged)
    if importlib.util.find_spec("pyvista") is None:
        raise ImportError("STL and PLY files need the package pyvista: pip install 'fx-membrane[plot]'.")
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder:
        target = Path(folder, "arrays.npz")
        command = [sys.executable, "-P", surface_reader.__file__, str(file.absolute()), str(target)]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
        ended = subprocess.run(command, env=environment, capture_output=True, check=False)
        if ended.returncode or not target.exists():
            raise ValueError(damaged)
        with np.load(target) as arrays:
            points, begin, nodes = arrays["points"], arrays["begin"], arrays["nodes"]
    drawing = Drawing(str(file), "surface", points, loose=file.suffix.lower() == ".stl")
    sizes = np.diff(begin)
    for corners in np.unique(sizes):
        if corners not in (3, 4):
            raise ValueError(f"{file} has a face with {corners} corners; give triangles or quadrilaterals.")
        rows = begin[:-1][sizes == corners]
        drawing.add(file.stem, nodes[rows[:, None] + np.arange(corners)].astype(np.int64))
    if not drawing.cells or not (np.isfinite(points).all() and 0 <= nodes.min() <= nodes.max() < len(points)):
        raise ValueError(damaged)
    return drawing


def _begins_well(file: Path) -> bool:
    """Return False for content that is no surface, which VTK would print much about."""
    content = file.read_bytes()
    if file.suffix.lower() == ".ply":
        return content[:3] == b"ply"
    text = content.lstrip()[:5] == b"solid" and b"facet" in content[:4096]
    facets = int.from_bytes(content[80:STL_HEAD], "little")
    return text or (facets > 0 and len(content) == STL_HEAD + STL_FACET * facets)
