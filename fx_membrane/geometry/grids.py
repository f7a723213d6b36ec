"""Grids of triangles, and lines of segments."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation

Diagonals = Literal["right", "left", "to centre"]
MOST_CELLS = 20_000_000  # of a grid: one with more takes gigabytes before anything is computed


def rectangle(
    width: float, height: float, columns: int, rows: int, diagonals: Diagonals = "to centre"
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Grid of triangles over a rectangle in the plane z = 0, centred on the origin.

    Nodes are numbered row by row from the corner (-width/2, -height/2), x running first: node `(columns + 1) * row +
    column`. All normals point along +z.

    Args:
        width: Size along x [m].
        height: Size along y [m].
        columns: Number of grid cells along x.
        rows: Number of grid cells along y.
        diagonals: Split of a grid cell: "right", from its lower left to its upper right corner; "left", along the other
            diagonal; "to centre", along the diagonal that points to the centre of the rectangle. The last is the
            pattern of Gil's Fig. 6, symmetric about both axes for even columns and rows; its centre node has eight
            triangles and so a larger share of a uniform load.

    Returns:
        Points, shape ((columns + 1) (rows + 1), 3) [m], and triangles, shape (2 columns rows, 3).

    Raises:
        ValueError: A size or a number is not positive, the cells are too many, or diagonals is none of the three.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 2, 1)
        >>> points.tolist()
        [[-2.0, -1.0, 0.0], [0.0, -1.0, 0.0], [2.0, -1.0, 0.0], [-2.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 0.0]]
        >>> triangles.tolist()
        [[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 5, 4]]
    """
    width, height = validation.positive("width", width), validation.positive("height", height)
    columns, rows = validation.positive_integer("columns", columns), validation.positive_integer("rows", rows)
    if columns * rows > MOST_CELLS:
        raise ValueError(f"columns is {columns} and rows is {rows}: too many cells; give smaller ones.")
    choices = ("right", "left", "to centre")
    diagonals = validation.choice("diagonals", diagonals, choices, '"right", "left" or "to centre"')
    x = np.linspace(-width / 2, width / 2, columns + 1)
    y = np.linspace(-height / 2, height / 2, rows + 1)
    points = np.stack([*np.meshgrid(x, y), np.zeros((rows + 1, columns + 1))], axis=-1).reshape(-1, 3)

    row, column = (index.ravel() for index in np.mgrid[:rows, :columns])
    a = (columns + 1) * row + column  # lower left, then counter-clockwise
    b, c, d = a + 1, a + columns + 2, a + columns + 1
    same_sign = (2 * row + 1 > rows) == (2 * column + 1 > columns)
    right = {"right": np.ones_like(same_sign), "left": np.zeros_like(same_sign), "to centre": same_sign}[diagonals]
    first = np.where(right, [a, b, c], [a, b, d])
    second = np.where(right, [a, c, d], [b, c, d])
    return points, np.stack([first, second], axis=-1).transpose(1, 2, 0).reshape(-1, 3)


def polyline(nodes: ArrayLike) -> NDArray[np.int64]:
    """Segments between consecutive nodes, shape (n - 1, 2): cells for a cable along them.

    Args:
        nodes: Node numbers in order, shape (n,); to close the line, repeat the first at the end.

    Raises:
        ValueError: They are not at least two whole numbers.

    Example:
        >>> polyline([4, 7, 2]).tolist()
        [[4, 7], [7, 2]]
    """
    line = validation.indices("nodes", nodes)
    if len(line) < 2:
        raise ValueError(f"nodes is {validation.short_repr(nodes)}; give at least two.")
    return np.column_stack([line[:-1], line[1:]])
