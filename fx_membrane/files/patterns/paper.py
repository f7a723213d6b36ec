"""Paper: sizes, standard scales, and the frame with the title block."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...checks import validation

Array = NDArray[np.float64]

PAPERS = {"A0": (1189, 841), "A1": (841, 594), "A2": (594, 420), "A3": (420, 297), "A4": (297, 210)}  # ISO 216 [mm]
SCALES = (1, 5, 10, 20, 25, 50, 100)
MARGIN, ROOM, BLOCK = 10.0, 4.0, 30.0  # around the frame, within it, and height of the title block [mm]
INCH = 25.4
POINT = INCH / 72
NAME, VALUE = 1.6, 2.4  # heights of texts in the title block [mm]
LETTER = 1.0  # width of a letter over the height of capitals
CAPITAL = 0.7  # height of capital letters over the size of a font


class Paper(NamedTuple):
    """Paper in landscape.

    Attributes:
        name: Name, as "A3".
        width: Its longer side [mm].
        height: Its shorter side [mm].
    """

    name: str
    width: float
    height: float

    @property
    def room(self) -> tuple[float, float]:
        """Width and height that a drawing can have [mm]."""
        return self.width - 2 * (MARGIN + ROOM), self.height - 2 * (MARGIN + ROOM) - BLOCK

    @property
    def middle(self) -> Array:
        """Middle of the room, from the lower left corner of the paper, shape (2,) [mm]."""
        return np.array([0.5 * self.width, 0.5 * (self.height + BLOCK)])


def paper_of(name: str) -> Paper:
    """Paper of a standard size.

    Raises:
        ValueError: There is none of that name.
    """
    known = validation.choice("paper", name, list(PAPERS), f"one of {', '.join(PAPERS)}")
    if known is None:
        raise ValueError(f"paper is None; give one of {', '.join(PAPERS)}.")
    return Paper(known, *PAPERS[known])


def scale_for(what: str, size: tuple[float, float], paper: Paper, wanted: int | None, millimetres: float = 1.0) -> int:
    """Largest standard scale at which a drawing fits on a paper, or a wanted one.

    Args:
        what: Name of the drawing, for messages.
        size: Width and height of the drawing, in a unit of length.
        paper: The paper.
        wanted: Scale that was asked for, 20 for 1:20; None to choose one.
        millimetres: Length of the unit [mm].

    Returns:
        The scale, 20 for 1:20.

    Raises:
        ValueError: It does not fit at the wanted scale, or at any.
    """
    width, height = size[0] * millimetres, size[1] * millimetres
    needed = max(width / paper.room[0], height / paper.room[1])
    fitting = [scale for scale in SCALES if needed <= scale * (1 + 1e-9)]
    if wanted is None and fitting:
        return fitting[0]
    if wanted is not None and needed <= wanted * (1 + 1e-9):
        return wanted
    shown = wanted or SCALES[-1]
    remedy = f"1:{fitting[0]}, or larger paper" if fitting else "larger paper"
    raise ValueError(
        f"{what} is {width / 1e3:.4g} m by {height / 1e3:.4g} m and does not fit on {paper.name} at 1:{shown}; "
        f"give {remedy}."
    )


def page(paper: Paper, entries: Sequence[tuple[str, str]], line: tuple[str, str]) -> tuple[Any, Any]:
    """Figure of the size of a paper, with axes in millimetres on it, a frame and a title block.

    Args:
        paper: The paper.
        entries: Names and values in two rows of the block.
        line: Name and value of the last row.
    """
    import matplotlib.figure  # noqa: PLC0415  (numbers alone must not wait for it)

    figure = matplotlib.figure.Figure(figsize=(paper.width / INCH, paper.height / INCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set(xlim=(0, paper.width), ylim=(0, paper.height))
    right, top = paper.width - MARGIN, paper.height - MARGIN
    block = MARGIN + BLOCK
    axes.plot([MARGIN, right, right, MARGIN, MARGIN], [MARGIN, MARGIN, top, top, MARGIN], color="black", lw=0.7)
    axes.plot([MARGIN, right], [block, block], color="black", lw=0.7)
    columns = -(-len(entries) // 2)
    step = (right - MARGIN) / columns
    for number, entry in enumerate(entries):
        row = 2 if number < columns else 1
        _entry(axes, entry, (MARGIN + 2 + step * (number % columns), MARGIN + row * BLOCK / 3), step)
    if line[1]:
        _entry(axes, line, (MARGIN + 2, MARGIN), right - MARGIN)
    return figure, axes


def _entry(axes: Any, entry: tuple[str, str], corner: tuple[float, float], room: float) -> None:
    """Write a name and a value below each other, smaller if the value is long."""
    x, y = corner
    name, value = entry
    height = min(VALUE, (room - 3) / (LETTER * max(1, len(value))))
    write(axes, name, (x, y + 6.6), NAME, colour="#555555", middle=False)
    write(axes, value, (x, y + 2.6), height, middle=False)


def write(
    axes: Any,
    words: str,
    place: Sequence[float],
    height: float,
    *,
    angle: float = 0.0,
    colour: str = "black",
    middle: bool = True,
    over: bool = False,
) -> None:
    """Write a text with capital letters of a height [mm], over a white ground that hides lines if wanted."""
    aligned = {"ha": "center", "va": "center"} if middle else {"ha": "left", "va": "baseline"}
    axes.text(
        *place,
        " ".join(words.split()),
        fontsize=height / CAPITAL / POINT,
        rotation=angle,
        rotation_mode="anchor",
        color=colour,
        parse_math=False,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3 * height / POINT} if over else None,
        zorder=2 if over else 4,
        **aligned,
    )
