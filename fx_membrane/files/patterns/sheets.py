"""Sheets of pieces at a scale, as SVG or PDF by matplotlib; texts stay texts."""

from __future__ import annotations

import datetime
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...patterns.cloth_pieces import Label, Piece
from ...patterns.roll_layout import Placement
from ..whole_file import writing
from .drawing_of_pieces import arrow, labels_at
from .paper import Paper, page, write
from .sheet_plans import Head, Sheet

Array = NDArray[np.float64]

COLOURS = {"cut": "black", "sew": "#0054a6", "warp": "#007a33", "marks": "#b3005e"}
WIDTHS = {"cut": 0.9, "sew": 0.6, "warp": 0.8, "marks": 0.6}  # [points]
TITLE = "Cutting patterns"
LEAST, MOST = 1.4, 6.0  # heights of texts on paper [mm]
SETTINGS: Any = {
    "svg.fonttype": "none",
    "svg.hashsalt": "fx_membrane",
    "pdf.fonttype": 42,
    "font.family": "DejaVu Sans",
}


def write_svg(pieces: Mapping[str, Piece], sheet: Sheet, file: Path, head: Head, paper: Paper) -> None:
    """Write one sheet as SVG.

    Raises:
        ValueError: The file cannot be written.
    """
    import matplotlib  # noqa: PLC0415

    with matplotlib.rc_context(SETTINGS):
        figure = _drawn(pieces, sheet, head, paper)
        with writing(file, encoding="utf-8", errors="xmlcharrefreplace") as stream:
            figure.savefig(stream, format="svg", metadata={"Date": head.date or None, "Title": head.project or TITLE})


def write_pdf(pieces: Mapping[str, Piece], sheets: Sequence[Sheet], file: Path, head: Head, paper: Paper) -> None:
    """Write a PDF with a page for each sheet.

    Raises:
        ValueError: The file cannot be written.
    """
    import matplotlib  # noqa: PLC0415
    from matplotlib.backends.backend_pdf import PdfPages  # noqa: PLC0415

    with matplotlib.rc_context(SETTINGS):
        figures = [_drawn(pieces, sheet, head, paper) for sheet in sheets]
        told = {"Title": head.project or TITLE, "CreationDate": _moment(head.date)}
        with writing(file, "wb") as stream, PdfPages(stream, metadata=told) as pages:
            for figure in figures:
                pages.savefig(figure)


def _moment(date: str) -> datetime.datetime | None:
    """Date of a PDF, if the text is one as 2026-03-01."""
    try:
        return datetime.datetime.fromisoformat(date)
    except ValueError:
        return None


def _drawn(pieces: Mapping[str, Piece], sheet: Sheet, head: Head, paper: Paper) -> Any:
    entries = [("Project", head.project), *sheet.entries, ("Material", head.material), ("Scale", f"1:{sheet.scale}")]
    entries += [("Date", head.date)] if head.date else []
    figure, axes = page(paper, entries, sheet.line)
    factor = head.millimetres / sheet.scale
    middle = 0.5 * np.array(sheet.size)

    def on_paper(points: Array) -> Array:
        return np.asarray(paper.middle + (points - middle) * factor)

    for line in sheet.edges:
        axes.plot(*on_paper(line).T, color="#888888", lw=0.5, ls="--")
    for placement in sheet.placements:
        _draw(axes, pieces[placement.piece], placement, on_paper, factor, alone=len(sheet.placements) == 1)
    return figure


def _draw(axes: Any, piece: Piece, placement: Placement, on_paper: Any, factor: float, alone: bool) -> None:
    for layer, points in _lines(piece):
        x, y = on_paper(placement.moved(points)).T
        axes.plot(
            *(x, y),
            color=COLOURS[layer],
            lw=WIDTHS[layer],
            gid=f"{layer} {placement.strip}",
            solid_joinstyle="miter",
            zorder=1 if layer == "warp" else 3,
        )
    for label in labels_at(piece, placement):
        height = min(factor * label.height, MOST)
        over = label.outside is None  # the name interrupts the arrow
        place = on_paper(placement.moved((piece.warp.mean(axis=0) if over else label.place)[None]))[0]
        if label.outside is not None and height < LEAST:  # too small to be read on paper
            if alone:
                edge, out = label.outside
                away = (1.0 if label.words.isdigit() else 2.8) * LEAST
                place = on_paper(placement.moved(edge[None]))[0] + away * out
            elif height < 0.5 * LEAST:
                continue
        write(axes, label.words, place, max(height, LEAST), angle=_angle(label, height, alone), over=over)


def _angle(label: Label, height: float, alone: bool) -> float:
    """Direction of a text: along the side where it is outside."""
    if label.outside is None or label.words.isdigit() or height >= LEAST or not alone:
        return label.angle
    x, y = label.outside[1]
    return float((np.degrees(np.arctan2(x, -y)) + 90) % 180 - 90)


def _lines(piece: Piece) -> Iterator[tuple[str, Array]]:
    yield "cut", np.vstack([piece.cut, piece.cut[:1]])
    yield "sew", np.vstack([piece.sewing, piece.sewing[:1]])
    yield "warp", arrow(piece.warp)
    for mark in piece.marks:
        yield "marks", mark.line
