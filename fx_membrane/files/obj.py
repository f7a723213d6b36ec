"""Wavefront OBJ: faces and lines by group or object. Read here, as VTK drops names of groups and half of the digits."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from .drawing import Drawing

UNNAMED = "default"  # the group of cells before any name


def read(file: Path) -> Drawing:
    """Read the vertices, faces and lines of a file; texture, normals and materials are left out.

    Raises:
        ValueError: A line is damaged, a vertex does not exist, or a face has more than four corners.
    """
    points: list[list[float]] = []
    cells: dict[tuple[str, int], list[list[int]]] = {}
    name = UNNAMED
    for number, line in enumerate(_lines(file), 1):
        kind, *values = line.split("#", 1)[0].split() or [""]
        try:
            if kind == "v":
                points.append(_place(values))
            elif kind in ("g", "o"):
                name = " ".join(values) or UNNAMED
            elif kind == "f":
                corners = [_vertex(value, len(points)) for value in values]
                if len(corners) not in (3, 4):
                    raise ValueError(f"a face with {len(corners)} corners; give triangles or quadrilaterals")
                cells.setdefault((name, len(corners)), []).append(corners)
            elif kind == "l":
                nodes = [_vertex(value, len(points)) for value in values]
                cells.setdefault((name, 2), []).extend(map(list, pairwise(nodes)))
        except ValueError as error:
            raise ValueError(f"{file}:{number}: {line.strip()[:60]!r} has no sense in an OBJ file ({error}).") from None
    drawing = Drawing(str(file), "group", np.array(points, dtype=np.float64).reshape(-1, 3))
    for (group, count), rows in cells.items():
        if rows:
            drawing.add(group, np.array(rows, dtype=np.int64).reshape(-1, count))
    return drawing


def _lines(file: Path) -> list[str]:
    text = file.read_bytes()
    if b"\0" in text:
        raise ValueError(f"{file} is no OBJ file: it has zero bytes; export it again as text.")
    return text.decode("utf-8", errors="replace").replace("\\\n", " ").splitlines()


def _place(values: list[str]) -> list[float]:
    """Place of a vertex; what follows its three numbers is a weight or a colour."""
    try:
        place = [float(value) for value in values[:3]]
    except ValueError:
        place = []
    if len(place) != 3 or not np.isfinite(place).all():
        raise ValueError("a vertex needs three numbers")
    return place


def _vertex(value: str, count: int) -> int:
    """Row of a vertex from its number in the file: from 1, or backwards from -1."""
    try:
        number = int(value.split("/", maxsplit=1)[0])
    except ValueError:
        raise ValueError(f"{value[:20]!r} is no number of a vertex") from None
    row = number - 1 if number > 0 else count + number
    if number == 0 or not 0 <= row < count:
        raise ValueError(f"vertex {number}, of {count} so far; numbers begin with 1")
    return row
