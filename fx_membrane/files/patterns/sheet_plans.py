"""Contents of sheets: pieces at their places, at a standard scale, and entries of the title block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import ceil, log10
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...patterns.cloth_pieces import Piece
from ...patterns.roll_layout import Placement, RollLayout, one_by_one
from .paper import SCALES, Paper, scale_for

Array = NDArray[np.float64]

BAND_DISTANCE = 0.1  # distance between pieces and bands, over the width of the roll


class Head(NamedTuple):
    """Entries of the title block that the user gives, and the unit.

    Attributes:
        project: Name of the project.
        material: Name of the cloth.
        date: Date, as text; empty for none.
        unit: Name of the unit of length.
        millimetres: Its length [mm].
    """

    project: str
    material: str
    date: str
    unit: str
    millimetres: float

    def length(self, value: float) -> str:
        """Write a length to a millimetre, or to the unit if that is shorter."""
        return f"{value:.{self._digits}f}"

    def area(self, value: float) -> str:
        """Write an area to 100 square centimetres, or to the square of a shorter unit."""
        return f"{value:.{max(0, 2 * self._digits - 4)}f}"

    @property
    def _digits(self) -> int:
        return max(0, ceil(log10(self.millimetres)))


class Sheet(NamedTuple):
    """One sheet.

    Attributes:
        placements: Places of its pieces.
        size: Width and height of the drawing, which begins at zero.
        scale: Its scale, 20 for 1:20.
        entries: Entries of the title block about it.
        line: Entry of its last row.
        edges: Edges of the roll, each of shape (2, 2).
    """

    placements: Sequence[Placement]
    size: tuple[float, float]
    scale: int
    entries: Sequence[tuple[str, str]]
    line: tuple[str, str] = ("", "")
    edges: Sequence[Array] = ()


def piece_sheet(piece: Piece, head: Head, paper: Paper, wanted: int | None) -> Sheet:
    """Sheet of a single piece.

    Raises:
        ValueError: It does not fit on the paper.
    """
    unit = head.unit
    sides = ", ".join(f"{side.edge} {head.length(side.length)}" for side in piece.sides)
    entries = [
        ("Strip", piece.name),
        ("Number", str(len(piece.copies))),
        (f"Area sewn / cut [{unit}2]", f"{head.area(piece.sewn_area)} / {head.area(piece.cut_area)}"),
        (f"Length / width [{unit}]", f"{head.length(piece.length)} / {head.length(piece.width)}"),
    ]
    size = piece.length, piece.width
    scale = scale_for(f"Strip {piece.name!r}", size, paper, wanted, head.millimetres)
    return Sheet(
        one_by_one({piece.name: piece}, 0.0).placements, size, scale, entries, (f"Lengths of sides [{unit}]", sides)
    )


def all_sheets(
    pieces: Mapping[str, Piece], roll: RollLayout | None, head: Head, paper: Paper, wanted: int | None
) -> list[Sheet]:
    """Sheets of all pieces: on the roll, drawn in bands if it is long, or else one behind the other, each once.

    Raises:
        ValueError: A row of the roll does not fit on the paper.
    """
    layout = roll
    if layout is None:
        layout = one_by_one(pieces, BAND_DISTANCE * max(piece.width for piece in pieces.values()))
    room = np.array(paper.room) / head.millimetres
    row = float(layout.rows[:, 1].max()), layout.width
    least = scale_for("The longest row of the drawing", row, paper, wanted, head.millimetres)
    scales = [scale for scale in SCALES if scale >= least] if wanted is None else [wanted]
    for scale in scales:
        bands = _bands(layout.rows, room[0] * scale)
        high = layout.width * (1 + BAND_DISTANCE)
        each = int((room[1] * scale * (1 + 1e-9) + BAND_DISTANCE * layout.width) // high)
        pages = -(-(bands[-1] + 1) // each)
        if pages == 1:
            break
    entries = _entries(pieces, roll, head)
    return [
        _sheet(layout, bands - page * each, each, scale, _numbered(entries, page, pages), roll is not None)
        for page in range(pages)
    ]


def _bands(rows: Array, room: float) -> NDArray[np.int64]:
    """Band of each row of a roll that is cut where it is longer than a room."""
    found, start = [0], 0.0
    for begin, length in rows[1:]:
        if begin + length - start > room * (1 + 1e-9):
            found.append(found[-1] + 1)
            start = begin
        else:
            found.append(found[-1])
    return np.array(found)


def _sheet(
    layout: RollLayout, bands: NDArray[np.int64], each: int, scale: int, entries: Sequence[tuple[str, str]], drawn: bool
) -> Sheet:
    """Sheet with the bands from 0 on of a roll."""
    there = np.unique(bands[(bands >= 0) & (bands < each)])
    starts = {band: float(layout.rows[bands == band, 0].min()) for band in there}
    ends = {band: float(layout.rows[bands == band].sum(axis=1).max()) for band in there}
    step = layout.width * (1 + BAND_DISTANCE)
    top = step * float(there.max())
    length = max(ends[band] - starts[band] for band in there)
    places = [
        replace(placement, shift=placement.shift + np.array([-starts[band], top - step * band]))
        for placement in layout.placements
        if (band := int(bands[placement.row])) in starts
    ]
    edges = [
        np.array([(0.0, level), (ends[band] - starts[band], level)])
        for band in there
        for level in (top - step * band, top - step * band + layout.width)
    ]
    return Sheet(places, (length, top + layout.width), scale, entries, edges=edges if drawn else ())


def _entries(pieces: Mapping[str, Piece], roll: RollLayout | None, head: Head) -> list[tuple[str, str]]:
    area = sum(len(piece.copies) * piece.cut_area for piece in pieces.values())
    entries = [
        ("Strips", str(sum(len(piece.copies) for piece in pieces.values()))),
        (f"Area cut [{head.unit}2]", head.area(area)),
    ]
    if roll is None:
        return entries
    return [
        *entries,
        (f"Roll width / length [{head.unit}]", f"{head.length(roll.width)} / {head.length(roll.length)}"),
        (f"Cloth [{head.unit}2]", head.area(roll.area)),
        ("Waste", f"{100 * roll.waste:.1f} %"),
    ]


def _numbered(entries: list[tuple[str, str]], page: int, pages: int) -> list[tuple[str, str]]:
    return entries if pages == 1 else [*entries, ("Sheet", f"{page + 1} of {pages}")]
