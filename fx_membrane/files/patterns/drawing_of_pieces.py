"""DXF of pieces of cloth by ezdxf, in millimetres, by layer: cut, sew, warp, marks and text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...patterns.cloth_pieces import Label, Piece
from ...patterns.roll_layout import Placement
from ..whole_file import writing

Array = NDArray[np.float64]

LAYERS = {"cut": 1, "sew": 5, "warp": 3, "marks": 6, "text": 7}  # with the numbers of their colours
MILLIMETRES = 4  # code of $INSUNITS
HEAD = 0.05  # length of the arrow's head over that of the arrow


def write_drawing(pieces: Mapping[str, Piece], placements: Sequence[Placement], file: Path, millimetres: float) -> None:
    """Write pieces at their places; cut and sewing lines are closed LWPOLYLINE.

    Args:
        pieces: The pieces.
        placements: Their places.
        file: The file, .dxf.
        millimetres: Length of the unit of the pieces [mm].

    Raises:
        ValueError: The file cannot be written.
        ImportError: ezdxf is not installed.
    """
    try:
        import ezdxf  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError(
            "DXF files need the package ezdxf; install it by pip install 'fx-membrane[patterns]'."
        ) from None
    with _without_time(ezdxf.options):
        document = _document(ezdxf, pieces, placements, millimetres)
        with writing(file, encoding="utf-8", errors="dxfreplace") as stream:
            document.write(stream)


def _document(ezdxf: Any, pieces: Mapping[str, Piece], placements: Sequence[Placement], millimetres: float) -> Any:
    document = ezdxf.new("R2010", units=MILLIMETRES)
    document.header["$MEASUREMENT"] = 1
    for layer, colour in LAYERS.items():
        document.layers.add(layer, color=colour)
    space = document.modelspace()
    for placement in placements:
        _draw(space, pieces[placement.piece], placement, millimetres)
    return document


@contextmanager
def _without_time(options: Any) -> Iterator[None]:
    """Let ezdxf write no time and no random identifier, so that equal patterns give equal files."""
    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before


def _draw(space: Any, piece: Piece, placement: Placement, scale: float) -> None:
    def moved(points: Array) -> list[Any]:
        return (scale * placement.moved(points)).tolist()

    space.add_lwpolyline(moved(piece.cut), close=True, dxfattribs={"layer": "cut"})
    space.add_lwpolyline(moved(piece.sewing), close=True, dxfattribs={"layer": "sew"})
    space.add_lwpolyline(moved(arrow(piece.warp)), dxfattribs={"layer": "warp"})
    for mark in piece.marks:
        space.add_line(*moved(mark.line), dxfattribs={"layer": "marks"})
    for label in labels_at(piece, placement):
        text = space.add_text(
            plain(label.words), height=scale * label.height, rotation=label.angle, dxfattribs={"layer": "text"}
        )
        _centre(text, moved(label.place[None])[0])


def labels_at(piece: Piece, placement: Placement) -> Sequence[Label]:
    """Labels of a piece at a place; copies have their name alone, as their seams have other neighbours."""
    if placement.strip == piece.name:
        return piece.labels
    words = f"{placement.strip} (as {piece.name}{', turned over' * placement.mirrored})"
    return [replace(label, words=words) for label in piece.labels[:1]]


def _centre(text: Any, place: list[float]) -> None:
    """Put the middle of a text at a place."""
    from ezdxf.enums import TextEntityAlignment  # noqa: PLC0415  (ezdxf is loaded)

    text.set_placement(place, align=TextEntityAlignment.MIDDLE_CENTER)


def plain(words: str) -> str:
    """Text in one line, in which per cent signs and carets begin no code of DXF."""
    return " ".join(words.split()).replace("%%", "%%%%%%").replace("^", "^ ")


def arrow(warp: Array) -> Array:
    """Open line that draws an arrow with its head, shape (5, 2)."""
    tail, tip = warp
    along = HEAD * (tip - tail)
    across = 0.3 * np.array([-along[1], along[0]])
    return np.array([tail, tip, tip - along + across, tip - along - across, tip])
