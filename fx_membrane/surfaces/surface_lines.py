"""Lines on surfaces: geodesics, and lines along the warp."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..form_finding.form import Form
from ..geometry.sizes import lengths, measures
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.states import StageResult
from .geodesics import shortest
from .nearest_points import on_surface
from .shapes import Shape, Surface, surface_of
from .spread_lines import checked_spacing, even_lines
from .tracing import field_of
from .transfer import between, main_direction
from .walking import Direction, Terrain, Way, walk

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceLine:
    """Line on a surface, straight in each cell.

    Attributes:
        points: Places along the line, where it crosses edges or nodes, and its ends, shape (k, 3) [m].
        cells: Cell between each two of them, shape (k - 1,): numbers of the part, or of all membranes one after the
            other.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> roof = Membrane(triangles, Fabric(4e5, 0.3), warp=(1, 0, 0))
        >>> sheet = Structure(points, {"roof": roof}, [Support(np.unique(boundary_edges(triangles)))])
        >>> line = warp_lines(sheet, [(0.3, 0.5, 0.0)])[0]
        >>> round(line.length, 6), line.directions[0].round(6).tolist()
        (2.0, [1.0, 0.0, 0.0])
    """

    points: Array
    cells: NDArray[np.int64]

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(lengths(np.diff(self.points, axis=0)).sum())

    @property
    def directions(self) -> Array:
        """Unit vectors along the line in its cells, shape (k - 1, 3) [-]; zero for a piece without length."""
        side = np.diff(self.points, axis=0)
        return np.asarray(side / np.maximum(lengths(side), np.finfo(float).tiny)[:, None])

    def __repr__(self) -> str:
        ends = " to ".join(validation.format_point(self.points[end]) for end in (0, -1))
        return f"SurfaceLine({ends}, length {self.length:.6g})"


def geodesic(
    shape: Shape,
    start: int | ArrayLike,
    end: int | ArrayLike | None = None,
    *,
    direction: ArrayLike | None = None,
    length: float | None = None,
    part: str | None = None,
) -> SurfaceLine:
    """Geodesic between two points, or from a point in a direction.

    It is exact on the flat cells: straight across edges. Between two points it bends at nodes only where it cannot be
    shortened; it is the shortest of all lines near it, found from the shortest line along edges. In a direction it
    leaves a node with equal angles on both sides. It ends at the rim or its length. On a mesh of a curved surface,
    lengths between points are of second order in the mesh size. Places of lines in a direction are of first order.

    Args:
        shape: A `Structure`, a `Form` or a `StageResult`, taken as deformed; or points, shape (n, 3), and triangles,
            shape (cells, 3), as a pair.
        start: First point: a node number, or a position on the surface, shape (3,) [m].
        end: Last point, as the first.
        direction: Instead of an end: a vector whose projection on the surface is the direction, shape (3,), any length.
        length: With a direction, the length of the line, which ends at the rim if it is reached before [m].
        part: Name of the membrane; None for all, joined where they share nodes.

    Raises:
        ValueError: A point is not on the surface; the direction leads off it, or is normal to it; both or neither of
            end and direction are given; start and end are the same, or on pieces apart; the surface branches; the line
            reaches no rim, and no length is given.
        ImportError: potpourri3d, which finds lines between two points, is not installed.

    Example:
        >>> points, triangles = rectangle(4.0, 4.0, 8, 8)
        >>> points[:, 2] = np.abs(points[:, 0])  # a ridge roof upside down
        >>> line = geodesic((points, triangles), (-1, -1, 1), (1, 1, 1))
        >>> round(line.length, 9) == round(float(np.hypot(2 * np.sqrt(2), 2)), 9)
        True
        >>> line = geodesic((points, triangles), (-1, -1, 1), direction=(1, 0, 0))
        >>> np.round(line.points[-1], 9).tolist()
        [2.0, -1.0, 2.0]
    """
    surface = surface_of("geodesic", shape, part)
    if (end is None) == (direction is None):
        raise ValueError("geodesic has both an end and a direction, or neither; give one of them.")
    if length is not None and end is not None:
        raise ValueError("length is given with an end; give it with a direction.")
    if direction is None:
        Terrain(surface)
        return SurfaceLine(*shortest(surface, start, end))
    terrain = Terrain(surface)
    cell, shares = on_surface("start", surface, start)
    vector = validation.direction("direction", direction)
    first = terrain.cell_towards(cell, shares, vector)
    if first is None:
        raise ValueError(
            f"direction {validation.short_repr(direction)} leads off the surface, or is normal to it, at "
            f"{validation.format_point(terrain.place(cell, shares))}; turn it."
        )
    reach = np.inf if length is None else validation.positive("length", length)
    return SurfaceLine(*_ending(walk(terrain, *first, reach), terrain.place(cell, shares)))


def warp_lines(
    shape: Structure | Form | StageResult,
    starts: Sequence[int | ArrayLike] | None = None,
    part: str | None = None,
    *,
    spacing: float | None = None,
) -> list[SurfaceLine]:
    """Lines along the warp of a membrane: through points, from rim to rim in the sense of the warp; or spread evenly.

    The direction between centres of cells is interpolated: the lines are of second order in the mesh size.

    Args:
        shape: A `Structure`, a `Form`, or a `StageResult`, taken as deformed, its warp with it.
        starts: Points that the lines go through: node numbers, or positions on the surface, shape (3,) [m]; None for
            lines spread evenly over the membrane, in either sense.
        part: Name of the membrane, if there are several.
        spacing: Without starts, distance between neighbouring lines; by default a twentieth of the extent of the
            membrane [m].

    Raises:
        ValueError: The shape is none of these, or has several membranes and no part is named; a point is not on the
            surface; a line reaches no rim; spacing is given with starts, is not positive, or is larger than any line is
            long; it is so small that the lines would have more than 2e5 segments.

    Example:
        >>> points, triangles = rectangle(4.0, 4.0, 8, 8)
        >>> roof = Membrane(triangles, Fabric(4e5, 0.3), prestress=(2e3, 1e3), warp=(1, 0.5, 0))
        >>> line, = warp_lines(Structure(points, {"roof": roof}), [(0, 0, 0)])
        >>> np.round(line.points[[0, -1]], 9).tolist()
        [[-2.0, -1.0, 0.0], [2.0, 1.0, 0.0]]
    """
    surface, warp = _warp(shape, part)
    if starts is None:
        return _evenly(Terrain(surface, cut=True), warp, spacing)
    if spacing is not None:
        raise ValueError("spacing is given with starts; give one of them.")
    terrain = Terrain(surface)
    field = _field(terrain, warp)
    return [_through(terrain, field, warp, *on_surface("A start", surface, start)) for start in listed_points(starts)]


def _evenly(terrain: Terrain, warp: Array, spacing: float | None) -> list[SurfaceLine]:
    distance = checked_spacing("spacing", terrain, spacing)
    along = field_of(terrain, warp[:, :, None] * warp[:, None, :], terrain.sound)
    tracks = even_lines(terrain, along, terrain.sound, distance, distance, np.zeros(len(warp), dtype=np.int64))
    if not tracks:
        raise ValueError(f"spacing is {distance:g}, and no line along the warp is as long; give a smaller one.")
    return [SurfaceLine(track.points, track.cells) for track in tracks]


def listed_points(starts: Any) -> Sequence[Any]:
    """Points through which lines go, as a list."""
    if isinstance(starts, str) or not isinstance(starts, Sequence | np.ndarray) or not len(starts):
        raise ValueError(f"starts is {validation.short_repr(starts)}; give a list of nodes or of positions.")
    return list(starts)


def _warp(shape: Any, part: str | None) -> tuple[Surface, Array]:
    """Surface of one membrane and its warp there, carried along with its cells, shape (cells, 3)."""
    if not isinstance(shape, Structure | Form | StageResult):
        raise ValueError(
            f"warp_lines shape is {validation.short_repr(shape)}; give a Structure, Form or StageResult, with a warp."
        )
    structure = shape if isinstance(shape, Structure) else shape.structure
    names = list(structure.parts_of(Membrane))
    if part is None and len(names) != 1:
        raise ValueError(f"The structure has the membranes {names}; name the one of the lines, part=...")
    name = names[0] if part is None else part
    surface = surface_of("warp_lines", shape, name)
    before = Terrain(Surface(structure.points, surface.triangles), cut=True)
    rates = np.einsum("cki,ci->ck", before.gradients, structure.warp(name))
    warp = np.einsum("ck,cki->ci", rates, surface.points[surface.triangles])
    return surface, warp / np.maximum(lengths(warp), np.finfo(float).tiny)[:, None]


def _field(terrain: Terrain, warp: Array) -> Direction:
    """Warp in any place of a cell, from its means at the nodes, in the sense that a line goes."""
    count, corners = len(terrain.points), terrain.triangles.ravel()
    area = measures(terrain.points, terrain.triangles)
    outer = (area[:, None, None] * warp[:, :, None] * warp[:, None, :]).reshape(-1, 9)
    weight = np.bincount(corners, np.repeat(area, 3), count)[:, None]
    sums = np.stack([np.bincount(corners, np.repeat(entry, 3), count) for entry in outer.T], axis=1)
    means: Array = np.zeros((count, 9))
    np.divide(sums, weight, where=weight > 0, out=means)
    at_nodes: Array = means.reshape(-1, 3, 3)

    def direction(cell: int, shares: Array, before: Array) -> Array:
        thread = main_direction(between(at_nodes, terrain.triangles[cell][None], shares[None]))[0]
        normal = terrain.normals[cell]
        flat = thread - (thread @ normal) * normal
        flat = flat / np.linalg.norm(flat)
        return np.asarray(-flat if flat @ before < 0 else flat)

    return direction


def _through(terrain: Terrain, field: Direction, warp: Array, cell: int, shares: Array) -> SurfaceLine:
    """Line through a point, from rim to rim."""
    place = terrain.place(cell, shares)
    halves = []
    for sense in (-1.0, 1.0):
        thread = field(cell, shares, sense * warp[cell])
        first = terrain.cell_towards(cell, shares, thread)
        halves.append(None if first is None else _ending(walk(terrain, *first, np.inf, field), place))
    back, ahead = halves
    if back is None and ahead is None:
        raise ValueError(
            f"The warp leads off the surface on both sides of {validation.format_point(place)}; move the start."
        )
    empty = Way(place[None], np.zeros(0, dtype=np.int64))
    back, ahead = back or empty, ahead or empty
    points = np.concatenate([back.points[::-1], ahead.points[1:]])
    return SurfaceLine(points, np.concatenate([back.cells[::-1], ahead.cells]))


def _ending(way: Way | None, place: Array) -> Way:
    if way is None:
        raise ValueError(
            f"The line from {validation.format_point(place)} reaches no rim, but runs round the surface; give a "
            "geodesic its length, or another start."
        )
    return way
