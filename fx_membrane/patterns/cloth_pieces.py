"""Pieces of cloth: strips with cut line, marks for assembly, warp arrow and names."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.length_units import METRES
from .allowances import Allowances
from .cut_lines import cut_line, load_shapely, sewing_line
from .flat_strips import CuttingPattern, FlatStrip, Side, check_pattern
from .seam_marks import beside, stations_of
from .strips import Edge, Strips

Array = NDArray[np.float64]

TEXT = 0.08  # height of the name over the radius of the largest circle in the strip
TEXT_RATIO = 0.5  # height of other texts over that of the name
LETTER = 0.9  # width of a letter over the height of capitals, and the room beside it
MARKS = 0.5  # usual distance between marks [m]
ARROW = 0.6  # length of the warp arrow over that of the strip along it


@dataclass(frozen=True, eq=False)
class Mark:
    """Mark for assembly: equal numbers of one edge are sewn on each other.

    Args:
        edge: Name of the edge.
        number: Number along the edge, from 1.
        line: Line from the sewing line to the cut line, shape (2, 2) [m].
    """

    edge: str
    number: int
    line: Array


@dataclass(frozen=True, eq=False)
class PieceSide:
    """Side of a piece.

    Args:
        edge: Name of the edge.
        beside: Name of the strip beyond the edge, or of the part along it; empty for neither.
        points: Points along the sewing line, counter-clockwise around the piece, shape (n, 2) [m].
        allowance: Width of cloth beyond the sewing line [m].
    """

    edge: str
    beside: str
    points: Array
    allowance: float

    @property
    def length(self) -> float:
        """Length of the sewing line [m]."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())


@dataclass(frozen=True, eq=False)
class Label:
    """Text on a piece.

    Args:
        words: The text.
        place: Middle of the text, shape (2,) [m].
        angle: Direction of the text from the warp, between -90 and 90 [degrees].
        height: Height of capital letters [m].
        outside: Point of the cut line beside the text, and the direction out of the piece there, shape (2, 2). Small
            drawings have the text there; None for the name.
    """

    words: str
    place: Array
    angle: float
    height: float
    outside: Array | None = None


@dataclass(frozen=True, eq=False)
class Piece:
    """Piece of cloth to cut, with the warp along the first axis.

    Args:
        name: Name of the strip.
        copies: Names of all strips that are cut like it, its own first.
        mirrored: Names of the copies for which the piece is turned over.
        sewing: Closed sewing line, counter-clockwise, shape (n, 2) [m].
        cut: Closed cut line, counter-clockwise, shape (m, 2) [m].
        sides: Sides in order around it.
        marks: Marks for assembly at the seams.
        warp: Warp arrow from its tail to its head, shape (2, 2) [m].
        labels: Its name, names along its edges, and numbers of marks.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> pattern = cutting_pattern(cut_strips(roof, ["valley"]))
        >>> piece = cut_pieces(pattern, Allowances(seam=0.02, border=0.05))["strip 1"]
        >>> round(piece.sewn_area, 3), round(piece.cut_area, 3)
        (1.989, 2.235)
    """

    name: str
    copies: tuple[str, ...]
    mirrored: frozenset[str]
    sewing: Array
    cut: Array
    sides: tuple[PieceSide, ...]
    marks: tuple[Mark, ...]
    warp: Array
    labels: tuple[Label, ...]

    @property
    def sewn_area(self) -> float:
        """Area within the sewing line [m2]."""
        return _area(self.sewing)

    @property
    def cut_area(self) -> float:
        """Area within the cut line [m2]."""
        return _area(self.cut)

    @property
    def length(self) -> float:
        """Extent of the cut line along the warp [m]."""
        return float(np.ptp(self.cut[:, 0]))

    @property
    def width(self) -> float:
        """Extent of the cut line across the warp [m]."""
        return float(np.ptp(self.cut[:, 1]))


def cut_pieces(
    pattern: CuttingPattern, allowances: Allowances | None = None, *, mark_spacing: float | None = None
) -> dict[str, Piece]:
    """Cut pieces of cloth: each strip with its allowances, marks and names; strips cut alike are one piece.

    Marks stand at corners of a seam, as of the rim of a cushion, and where a closed seam begins. Others stand at equal
    distances between them on the surface. All are at the same points of a seam on both strips.

    Args:
        pattern: The cutting pattern.
        allowances: Widths beyond the sewing lines; None for those of `Allowances()`.
        mark_spacing: Distance between marks along seams, nearly; None for 0.5 m, in the unit of the pattern [m].

    Raises:
        ValueError: Allowances name no edge, or are wider than half of the widest strip; a strip lies on itself, or its
            allowances meet each other.
        ImportError: shapely is not installed.
    """
    check_pattern("cut_pieces", pattern)
    unit = pattern.strips.length_unit
    if allowances is not None:
        validation.instance("cut_pieces allowances", allowances, Allowances)
    given = (allowances or Allowances()).in_unit(unit)
    usual = MARKS / METRES.get(unit, 1.0)
    spacing = usual if mark_spacing is None else validation.positive("mark_spacing", mark_spacing)
    given.check_names(pattern.strips.edges)
    given.check_widths(pattern.strips.edges, {name: flat.width for name, flat in pattern.cloth.items()})
    stations = stations_of(pattern, spacing)
    copies = pattern.strips.copies
    return {
        name: _piece(pattern.strips, flat, given, stations)
        for name, flat in pattern.cloth.items()
        if name not in copies
    }


def _piece(strips: Strips, flat: FlatStrip, allowances: Allowances, stations: Mapping[str, Array]) -> Piece:
    edges = {edge.name: edge for edge in strips.edges}
    sides = tuple(_side(flat, side, edges[side.edge], allowances) for side in flat.sides)
    lines = [side.points for side in sides]
    mitred = allowances.corners == "mitre"
    cut = cut_line(flat.name, lines, [side.allowance for side in sides], mitred, allowances.mitre_limit)
    sewing = sewing_line(lines)
    warp, radius = _arrow(sewing)
    height = TEXT * radius
    marks, numbers = [], []
    for side, outline in zip(flat.sides, sides, strict=True):
        if edges[side.edge].is_seam:
            for number, station in enumerate(_on_side(flat, side, edges[side.edge], stations[side.edge]), 1):
                place, out = beside(outline.points, station, closed=len(sides) == 1)
                marks.append(Mark(side.edge, number, np.array([place, place + (outline.allowance or height) * out])))
                beyond = np.array([place + outline.allowance * out, out])
                numbers.append(Label(str(number), place - TEXT_RATIO * height * out, 0.0, TEXT_RATIO * height, beyond))
    copies = (flat.name, *(copy for copy, original in strips.copies.items() if original == flat.name))
    named = f"{flat.name} ({len(copies)} times)" if len(copies) > 1 else flat.name
    name = Label(named, warp.mean(axis=0) + np.array([0.0, height]), 0.0, height)
    words = tuple(_words_along(side, TEXT_RATIO * height) for side in sides)
    return Piece(
        flat.name,
        copies,
        strips.mirrored.intersection(copies),
        sewing,
        cut,
        sides,
        tuple(marks),
        warp,
        (name, *words, *numbers),
    )


def _side(flat: FlatStrip, side: Side, edge: Edge, allowances: Allowances) -> PieceSide:
    others = [name for name in edge.strips if name != flat.name]
    beside = (others[0] if others else flat.name) if edge.is_seam else edge.line or ""
    return PieceSide(side.edge, beside, flat.points[side.rows], allowances.of(edge))


def _on_side(flat: FlatStrip, side: Side, edge: Edge, stations: Array) -> Array:
    """Stations as fractional rows of a side, whose order may be that of the edge or the reverse."""
    if np.array_equal(flat.nodes[side.rows], edge.nodes):
        return stations
    return len(edge.nodes) - 1 - stations


def _words_along(side: PieceSide, height: float) -> Label:
    """Name of an edge and of its neighbour, inside along the middle of the side; into the piece if it is short."""
    steps = np.linalg.norm(np.diff(side.points, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    middle = float(np.interp(0.5 * along[-1], along, np.arange(len(along))))
    place, out = beside(side.points, middle)
    angle = float(np.degrees(np.arctan2(out[0], -out[1])))
    upright = (angle + 90) % 180 - 90
    words = f"{side.edge} / {side.beside}" if side.beside else side.edge
    beyond, depth, room = np.array([place + side.allowance * out, out]), 2.5 * height, LETTER * height * len(words)
    if room > along[-1]:
        upright, depth = (upright + 180) % 180 - 90, 0.5 * room + height
    return Label(words, place - depth * out, upright, height, beyond)


def _arrow(sewing: Array) -> tuple[Array, float]:
    """Warp arrow through the middle of the largest circle in an outline, and the radius of the circle."""
    shapely = load_shapely()
    outline = shapely.Polygon(sewing)
    circle = shapely.maximum_inscribed_circle(outline, tolerance=0.01 * float(np.ptp(sewing, axis=0).min()))
    (x, y), radius = np.asarray(circle.coords)[0], float(circle.length)
    low, high = sewing[:, 0].min() - 1.0, sewing[:, 0].max() + 1.0
    inside = shapely.intersection(outline, shapely.LineString([(low, y), (high, y)]))
    pieces = [np.asarray(piece.coords)[:, 0] for piece in shapely.get_parts(inside) if piece.geom_type == "LineString"]
    left, right = next((ends.min(), ends.max()) for ends in pieces if ends.min() <= x <= ends.max())
    middle, half = 0.5 * (left + right), 0.5 * ARROW * (right - left)
    return np.array([(middle - half, y), (middle + half, y)]), radius


def _area(outline: Array) -> float:
    x, y = outline.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
