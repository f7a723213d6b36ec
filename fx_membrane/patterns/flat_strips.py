"""Strips laid flat: the cloth before and after compensation, with its outline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..checks.values import counted
from .stress_fit import StressFit
from .strips import Strips

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Side:
    """Side of a flat strip.

    Args:
        edge: Name of the edge.
        rows: Rows of the flat points along it, counter-clockwise around the strip; `nodes[rows]` are the nodes of the
            edge, or these in reverse order, shape (n,).

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> strip = flatten(cut_strips(roof, ["valley"]))["strip 1"]
        >>> {side.edge: round(float(strip.side_lengths(side).sum()), 6) for side in strip.sides}
        {'border 1': 2.0, 'border 3': 1.0, 'seam 1': 2.0, 'border 2': 1.0}
    """

    edge: str
    rows: NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class FlatStrip:
    """Strip in the plane of the cloth.

    Args:
        name: Name of the strip.
        nodes: Node of the structure at each flat point, shape (n,).
        points: Flat points, warp along the first axis, seen from the positive side of the surface, shape (n, 2) [m].
        triangles: Cells in the order of the strip's cells, as rows of `points`, shape (k, 3).
        sides: Sides counter-clockwise around the strip; a tube that is cut once has one edge on two sides.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> strip = flatten(cut_strips(roof, ["valley"]))["strip 1"]
        >>> round(strip.length, 6), round(strip.width, 6), round(strip.area, 6)
        (2.0, 1.0, 2.0)
    """

    name: str
    nodes: NDArray[np.int64]
    points: Array
    triangles: NDArray[np.int64]
    sides: tuple[Side, ...]

    @property
    def outline(self) -> NDArray[np.int64]:
        """Rows of the points around the strip, counter-clockwise, each once, shape (m,)."""
        return np.concatenate([side.rows[:-1] for side in self.sides])

    @property
    def length(self) -> float:
        """Extent along the warp [m]."""
        return float(np.ptp(self.points[:, 0]))

    @property
    def width(self) -> float:
        """Extent along the weft, without allowances [m]."""
        return float(np.ptp(self.points[:, 1]))

    @property
    def area(self) -> float:
        """Area within the outline [m2]."""
        return float(self.areas.sum())

    @property
    def areas(self) -> Array:
        """Areas of the triangles, negative if they are turned over, shape (k,) [m2]."""
        a, b, c = np.moveaxis(self.points[self.triangles], 1, 0)
        u, v = b - a, c - a
        return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2

    def side_lengths(self, side: Side) -> Array:
        """Lengths of the segments of a side in the order of its rows, shape (n - 1,) [m]."""
        return np.asarray(np.linalg.norm(np.diff(self.points[side.rows], axis=0), axis=1))


@dataclass(frozen=True, eq=False)
class CuttingPattern:
    """Strips, their flat shapes, and the cloth that is cut.

    Args:
        strips: Strips on the surface.
        flat: Flat strips before compensation.
        cloth: Flat strips after compensation, to the sewing lines, without allowances.
        compensation: Ratios of cloth to flat lengths along warp and weft, by the name of the strip, shape (2,) [-];
            the means where they differ from cell to cell.
        energy: Strain energy of flattening, of all strips [J].
        decompensated: Names of edges whose cloth is as long as the surface, and nodes around which it is not
            compensated.
        fit: Errors of the stress before and after `nearest_stress_pattern`; None without it.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> cutting_pattern(cut_strips(roof, ["valley"]), compensation=0.99)
        CuttingPattern(2 strips, area of cloth 3.92)
    """

    strips: Strips
    flat: Mapping[str, FlatStrip]
    cloth: Mapping[str, FlatStrip]
    compensation: Mapping[str, Array]
    energy: float = 0.0
    decompensated: tuple[str | int, ...] = ()
    fit: StressFit | None = None

    def __repr__(self) -> str:
        area = sum(cloth.area for cloth in self.cloth.values())
        return f"CuttingPattern({counted(len(self.cloth), 'strip')}, area of cloth {area:.4g})"


def check_pattern(caller: str, given: Any) -> None:
    """Refuse what is no cutting pattern.

    Raises:
        ValueError: It is of another class.
    """
    if not isinstance(given, CuttingPattern):
        raise ValueError(
            f"{caller} needs a CuttingPattern, but pattern is {validation.short_repr(given)}; give that of "
            "cutting_pattern(strips)."
        )
    validation.plain(f"{caller} pattern", given, CuttingPattern)
