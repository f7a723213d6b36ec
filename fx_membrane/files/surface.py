"""STL and PLY by pyvista: one surface without names."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

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
    if file.suffix.lower() == ".ply":
        _check_whole(file, len(points), begin, nodes)
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


def _check_whole(file: Path, points: int, begin: NDArray[np.int64], nodes: NDArray[np.int64]) -> None:
    """Refuse a PLY file that ends before its last face, which VTK fills up with what it has read before.

    Raises:
        ValueError: It does.
    """
    head, _, body = file.read_bytes().partition(b"end_header")
    found = {name: int(count) for name, count in re.findall(rb"element\s+(\w+)\s+(\d+)", head)}
    vertices, faces = found.get(b"vertex", 0), found.get(b"face", 0)
    whole = (points, len(begin) - 1) == (vertices, faces) and bool((np.diff(begin) > 0).all())
    if whole and b"ascii" in head:
        per_vertex = len(re.findall(rb"property\s+(?!list)", head.partition(b"element face")[0]))
        whole = len(body.split()) >= per_vertex * vertices + faces + len(nodes)
    if not whole:
        raise ValueError(
            f"{file} ends too early, or is damaged: its head tells of {vertices} vertices and {faces} faces; export "
            "the surface again."
        )


def _begins_well(file: Path) -> bool:
    """Return False for content that is no surface, which VTK would print much about."""
    content = file.read_bytes()
    if file.suffix.lower() == ".ply":
        return content[:3] == b"ply"
    text = content.lstrip()[:5] == b"solid" and b"facet" in content[:4096]
    facets = int.from_bytes(content[80:STL_HEAD], "little")
    return text or (facets > 0 and len(content) == STL_HEAD + STL_FACET * facets)
