"""Layout of pieces on the roll: side by side, the warp along the roll."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from .cloth_pieces import Piece

Array = NDArray[np.float64]

PIECE_DISTANCE = 0.01  # usual distance between pieces [m]


@dataclass(frozen=True, eq=False)
class Placement:
    """Place of one piece on the roll.

    Args:
        piece: Name of the piece.
        strip: Name of the strip that is cut here, the piece's own or that of a copy.
        row: Number of its row across the roll, from 0.
        turned: Turned by 180 degrees.
        mirrored: Turned over, before the turn.
        shift: Vector added to the points, after the turn, shape (2,) [m].
    """

    piece: str
    strip: str
    row: int
    turned: bool
    mirrored: bool
    shift: Array

    def moved(self, points: Array) -> Array:
        """Points of the piece on the roll, the first axis along the roll, shape (n, 2) [m]."""
        return np.asarray(_turned(points, self.turned, self.mirrored) + self.shift)


def _turned(points: Array, turned: bool, mirrored: bool) -> Array:
    sense = -1.0 if turned else 1.0
    return points * (sense, -sense if mirrored else sense)


@dataclass(frozen=True, eq=False)
class RollLayout:
    """Pieces on the roll.

    Args:
        placements: Places of all pieces and their copies.
        rows: Start and length of each row along the roll, shape (n, 2) [m].
        width: Width of the roll [m].
        cut_area: Area of all pieces and their copies [m2].

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> pieces = cut_pieces(cutting_pattern(cut_strips(roof, ["valley"])))
        >>> layout = laid_on_roll(pieces, width=2.5)
        >>> round(layout.length, 2), layout.area > layout.cut_area
        (2.09, True)
    """

    placements: tuple[Placement, ...]
    rows: Array
    width: float
    cut_area: float

    @property
    def length(self) -> float:
        """Length that is used [m]."""
        return float(self.rows[-1].sum())

    @property
    def area(self) -> float:
        """Area of the length that is used [m2]."""
        return self.width * self.length

    @property
    def waste(self) -> float:
        """Part of this area that is in no piece [-]."""
        return 1.0 - self.cut_area / self.area


def laid_on_roll(pieces: Mapping[str, Piece], width: float, *, gap: float = PIECE_DISTANCE) -> RollLayout:
    """Lay pieces and their copies on a roll, side by side in rows across it, the longest first.

    A piece may be turned by 180 degrees, so that tapered strips lie head to tail; the warp stays along the roll. Copies
    that are mirrored are turned over.

    Args:
        pieces: The pieces, see `cut_pieces`.
        width: Width of the roll [m].
        gap: Least distance between pieces across the roll and between rows [m].

    Raises:
        ValueError: There are no pieces; one is wider than the roll.
    """
    roll, space = validation.positive("width", width), validation.not_negative("gap", gap)
    validation.instance("laid_on_roll pieces", pieces, Mapping)
    validation.instances("laid_on_roll pieces", list(pieces.values()), Piece)
    if not pieces:
        raise ValueError("laid_on_roll pieces is empty; give at least one.")
    wide = [piece for piece in pieces.values() if piece.width > roll]
    if wide:
        told = ", ".join(f"{piece.name!r} with {piece.width:.4g}" for piece in wide[:5])
        raise ValueError(
            f"The width of the roll is {roll:g}, and {len(wide)} of {len(pieces)} pieces are wider: {told}; cut "
            "narrower strips, or take a wider roll."
        )
    rows: list[_Row] = []
    for piece in sorted(pieces.values(), key=lambda piece: -piece.length):
        for strip in piece.copies:
            if not any(row.take(piece, strip, roll, space) for row in rows):
                rows.append(_Row(piece.length, space))
                rows[-1].take(piece, strip, roll, space)
    lengths = np.array([row.length for row in rows])
    starts = np.cumsum(lengths + space) - lengths - space
    placements = tuple(
        Placement(name, strip, number, turned, mirrored, shift + np.array([start, 0.0]))
        for number, (start, row) in enumerate(zip(starts, rows, strict=True))
        for name, strip, turned, mirrored, shift in row.taken
    )
    area = sum(len(piece.copies) * piece.cut_area for piece in pieces.values())
    return RollLayout(placements, np.stack([starts, lengths], axis=1), roll, area)


class _Row:
    """Pieces side by side across the roll.

    Args:
        length: Length of the row.
        gap: Least distance between pieces.

    Attributes:
        taken: Name of the piece, name of the strip, turned, mirrored, shift within the row.
    """

    def __init__(self, length: float, gap: float):
        self.length, self.gap = length, gap
        self.taken: list[tuple[str, str, bool, bool, Array]] = []
        self._lines = np.array([[(-gap, -gap), (length + gap, -gap)]])  # border of the roll

    def take(self, piece: Piece, strip: str, roll: float, gap: float) -> bool:
        """Put a piece beside the others; False if there is no room."""
        mirrored = strip in piece.mirrored
        tries = (self._beside(_turned(piece.cut, turned, mirrored), turned, gap) for turned in (False, True))
        found = min(tries, key=lambda entry: entry[0])
        top, turned, shift, outline = found
        if top > roll * (1 + 1e-12):
            return False
        self.taken.append((piece.name, strip, turned, mirrored, shift))
        self._lines = np.vstack([self._lines, _segments(outline)])
        return True

    def _beside(self, outline: Array, turned: bool, gap: float) -> tuple[float, bool, Array, Array]:
        shift = -outline.min(axis=0)
        shift[1] += max(_rise(self._lines, _segments(outline + shift), gap), 0.0)
        moved = outline + shift
        return float(moved[:, 1].max()), turned, shift, moved


def _segments(outline: Array) -> Array:
    return np.stack([outline, np.roll(outline, -1, axis=0)], axis=1)


def _rise(below: Array, above: Array, gap: float) -> float:
    """Least rise of lines over others, to a distance across the roll, and nearly that distance along it."""
    places = np.unique(np.concatenate([below[..., 0].ravel(), above[..., 0].ravel()]))
    spans = np.stack([places[:-1], places[1:]], axis=1)
    spans = spans[spans[:, 1] - spans[:, 0] > 0]
    top, bottom = _over(below, spans, np.maximum), _over(above, spans, np.minimum)
    with np.errstate(invalid="ignore"):
        needed = top - bottom
    finite = needed[np.isfinite(needed)]
    return float(finite.max()) + gap if finite.size else 0.0


def _over(lines: Array, spans: Array, extreme: np.ufunc) -> Array:
    """Highest or lowest line at both ends of spans that end at all points of lines, shape (spans, 2)."""
    found = np.full(spans.shape, -np.inf if extreme is np.maximum else np.inf)
    (x0, y0), (x1, y1) = lines[lines[:, 0, 0] != lines[:, 1, 0]].transpose(1, 2, 0)
    first = np.searchsorted(spans[:, 0], np.minimum(x0, x1))
    counts = np.searchsorted(spans[:, 1], np.maximum(x0, x1), side="right") - first
    line = np.repeat(np.arange(len(x0)), counts)
    span = np.arange(len(line)) + np.repeat(first - np.cumsum(counts) + counts, counts)
    line, span = (each[np.argsort(span, kind="stable")] for each in (line, span))
    heights = y0[line, None] + (spans[span] - x0[line, None]) * ((y1 - y0) / (x1 - x0))[line, None]
    starts = np.flatnonzero(np.diff(span, prepend=-1))
    found[span[starts]] = extreme.reduceat(heights, starts, axis=0)
    return found


def one_by_one(pieces: Mapping[str, Piece], gap: float) -> RollLayout:
    """Pieces one behind the other, each once, for drawings without a roll.

    Args:
        pieces: The pieces.
        gap: Distance between them [m].
    """
    lengths = np.array([piece.length for piece in pieces.values()])
    starts = np.cumsum(lengths + gap) - lengths - gap
    placements = tuple(
        Placement(piece.name, piece.name, row, False, False, np.array([start, 0.0]) - piece.cut.min(axis=0))
        for row, (start, piece) in enumerate(zip(starts, pieces.values(), strict=True))
    )
    width = max(piece.width for piece in pieces.values())
    area = sum(piece.cut_area for piece in pieces.values())
    return RollLayout(placements, np.stack([starts, lengths], axis=1), width, area)
