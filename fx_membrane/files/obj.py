"""Wavefront OBJ: faces, lines and points by group or object.

Read here, as VTK drops names of groups and half of the digits.
"""

from __future__ import annotations

from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .drawing import Drawing

UNNAMED = "default"  # the group of cells before any name
Names = tuple[str, ...]


def read(file: Path) -> Drawing:
    """Read the vertices, faces, lines and points of a file; texture, normals and materials are left out.

    The name of an object, `o`, goes on to the end of its line. A line `g roof edge` puts its cells into two groups.

    Raises:
        ValueError: A line is damaged, a vertex does not exist, a face has no area or more than four corners.
    """
    points: list[list[float]] = []
    cells: dict[tuple[Names, int], list[list[int]]] = {}
    lines: dict[tuple[Names, int], list[int]] = {}
    names: Names = (UNNAMED,)
    content = _lines(file)
    for number, line in enumerate(content, 1):
        kind, *values = line.split("#", 1)[0].split() or [""]
        try:
            if kind == "v":
                points.append(_place(values))
            elif kind == "g":
                names = tuple(dict.fromkeys(values)) or (UNNAMED,)
            elif kind == "o":
                names = (line.split(maxsplit=1)[1].strip() if values else UNNAMED,)
            elif kind == "f":
                corners = [_vertex(value, len(points)) for value in values]
                if len(corners) not in (3, 4):
                    raise ValueError(f"a face with {len(corners)} corners; give triangles or quadrilaterals")
                if len(set(corners)) < len(corners):
                    raise ValueError("a face with the same corner twice; remove it")
                cells.setdefault((names, len(corners)), []).append(corners)
                lines.setdefault((names, len(corners)), []).append(number)
            elif kind == "l":
                nodes = [_vertex(value, len(points)) for value in values]
                cells.setdefault((names, 2), []).extend(map(list, pairwise(nodes)))
            elif kind == "p":
                cells.setdefault((names, 1), []).extend([_vertex(value, len(points))] for value in values)
        except ValueError as error:
            raise ValueError(f"{file}:{number}: {line.strip()[:60]!r} has no sense in an OBJ file ({error}).") from None
    drawing = Drawing(str(file), "group", np.array(points, dtype=np.float64).reshape(-1, 3))
    uses = Counter(word for group in {group for group, _ in cells} for word in group)
    for (group, count), rows in cells.items():
        found = np.array(rows, dtype=np.int64).reshape(-1, count)
        if count == 3 and len(flat := _without_area(drawing.points[found])):
            number = lines[group, count][flat[0]]
            raise ValueError(
                f"{file}:{number}: {content[number - 1].strip()[:60]!r} is a face without area; remove it."
            )
        _add(drawing, group, found, any(uses[word] > 1 for word in group))
    return drawing


def _add(drawing: Drawing, names: Names, cells: NDArray[np.int64], shared: bool) -> None:
    """Add cells to their groups, and to that of all words together: many programs write names with spaces.

    The words are the groups if other cells share one, or else all together are. Those that are not can be asked for.
    """
    if not len(cells):
        return
    whole = " ".join(names)
    for name in dict.fromkeys((whole, *names)):
        drawing.add(name, cells)
        if len(names) > 1 and shared == (name == whole):
            drawing.hidden.add(name)


def _without_area(corners: NDArray[np.float64]) -> NDArray[np.int64]:
    """Find the triangles whose corners are in one line to the last digits, by their places, shape (n, 3, 3)."""
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area, sides = (
        np.linalg.norm(np.cross(first, second), axis=1),
        np.abs(first).max(axis=1) * np.abs(second).max(axis=1),
    )
    return np.flatnonzero(area <= 4 * np.finfo(float).eps * sides)


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
