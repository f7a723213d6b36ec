"""Tables of pieces of cloth: areas, widths and copies by strip, and lengths by side."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ...patterns.cloth_pieces import Piece
from ...patterns.roll_layout import RollLayout
from ..tables import LONE, quoted
from ..whole_file import writing

Rows = Sequence[Sequence[Any]]


def write_strip_tables(pieces: Mapping[str, Piece], roll: RollLayout | None, file: Path, unit: str) -> None:
    """Write a table of strips and their sum, and one of their sides beside it, as `sides_file` names it.

    Raises:
        ValueError: A file cannot be written.
    """
    _write(file, strip_rows(pieces, roll, unit))
    _write(sides_file(file), side_rows(pieces, unit))


def sides_file(file: Path) -> Path:
    """File of the table of sides beside that of strips."""
    return file.with_name(f"{file.stem}_sides{file.suffix}")


def strip_rows(pieces: Mapping[str, Piece], roll: RollLayout | None, unit: str) -> Rows:
    """Head and rows of strips, then the sum with the cloth of the roll, where one is given."""
    head = [
        "strip",
        "number",
        f"sewn area [{unit}2]",
        f"cut area [{unit}2]",
        f"length [{unit}]",
        f"width [{unit}]",
        "cut like it",
    ]
    rows = [
        [
            quoted(piece.name),
            len(piece.copies),
            piece.sewn_area,
            piece.cut_area,
            piece.length,
            piece.width,
            quoted("; ".join(f"{name}{' (turned over)' * (name in piece.mirrored)}" for name in piece.copies[1:])),
        ]
        for piece in pieces.values()
    ]
    counts = [len(piece.copies) for piece in pieces.values()]
    sewn, cut = (
        sum(count * area for count, area in zip(counts, areas, strict=True))
        for areas in ([piece.sewn_area for piece in pieces.values()], [piece.cut_area for piece in pieces.values()])
    )
    total = ["all strips", sum(counts), sewn, cut, "", "", ""]
    if roll is None:
        return [head, *rows, total]
    cloth = ["cloth of the roll", "", "", roll.area, roll.length, roll.width, f"waste {roll.waste!r}"]
    return [head, *rows, total, cloth]


def side_rows(pieces: Mapping[str, Piece], unit: str) -> Rows:
    """Head and a row for each side of each strip."""
    head = ["strip", "side", "edge", "beside", f"length [{unit}]", f"allowance [{unit}]", "marks"]
    return [head, *(row for piece in pieces.values() for row in _sides(piece))]


def _sides(piece: Piece) -> Iterator[Sequence[Any]]:
    for number, side in enumerate(piece.sides, 1):
        marks = sum(mark.edge == side.edge for mark in piece.marks)
        names = quoted(side.edge), quoted(side.beside)
        yield quoted(piece.name), number, *names, side.length, side.allowance, marks


def _write(file: Path, rows: Rows) -> None:
    with writing(file, encoding="utf-8-sig", errors=LONE, newline="") as stream:  # with a mark for Excel
        csv.writer(stream).writerows(rows)
