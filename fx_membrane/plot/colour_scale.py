"""Colours of a field, and their scale beside a picture (matplotlib)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .fields import STATES as ORDER
from .fields import Checked, joined
from .scene import INK, Colours

BANDS = 16
DIGIT_ROUNDING = 5e-4  # number over the range of a scale, below which its three digits have none for it
BAR_LENGTH = 5.1  # length of a colour bar [inches]
LETTER = 0.64  # width of a digit over the size of its font
STATES = dict(zip(ORDER, ("#8fc1b5", "#f2b950", "#d1495b"), strict=True))  # taut, wrinkled, slack


def colours(
    field: Checked, symmetric: bool, limits: tuple[float, float] | None
) -> tuple[Colours, dict[str, NDArray[np.float64]] | NDArray[np.float64]]:
    """Colours of a field, and its values as numbers; a symmetric scale if both signs matter."""
    values = joined(field)
    if values.dtype.kind == "U":
        assert isinstance(field, dict)
        order = list(STATES)
        numbers = {name: np.array([order.index(state) for state in states]) for name, states in field.items()}
        return Colours(list(STATES.values()), -0.5, 2.5, len(order)), numbers
    if limits is not None:
        return Colours("coolwarm" if limits[0] == -limits[1] else "viridis", *limits, BANDS), field
    low, high = float(values.min()), float(values.max())
    largest = max(-low, high)
    if symmetric or min(-low, high) > 0.02 * largest:
        return Colours("coolwarm", -largest, largest, BANDS), field
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size:  # uniform: the last digits are rounding
        low, high = low - 0.05 * (size or 1.0), high + 0.05 * (size or 1.0)
    return Colours("viridis", low, high, BANDS), field


def beyond(values: NDArray[np.float64], ends: tuple[float, float]) -> tuple[bool, bool]:
    """Tell if values lie below the ends of a scale, and if they lie above; rounding beside its range does not count."""
    room = DIGIT_ROUNDING * (ends[1] - ends[0])
    return bool(values.min() < ends[0] - room), bool(values.max() > ends[1] + room)


def colour_bar(figure: Any, axes: Any, shown: Colours, outside: tuple[bool, bool], name: str = "") -> None:
    """Draw the scale of the colours below a picture, with a name where there are several.

    Args:
        figure, axes: The figure, and the picture in it.
        shown: The colours.
        outside: True for an end beyond which there are values, the lower one first.
        name: Name of the scale.
    """
    import matplotlib.cm  # noqa: PLC0415
    import matplotlib.colors  # noqa: PLC0415

    named = not isinstance(shown.map, str)
    ticks, texts = (np.arange(len(STATES)), list(STATES)) if named else _ticks(shown)
    bounds = np.linspace(*shown.ends, shown.bands + 1)
    shades: Any = matplotlib.colors.ListedColormap(list(shown.map)) if named else shown.map
    norm = matplotlib.colors.BoundaryNorm(bounds, shown.bands if named else 256)
    mappable = matplotlib.cm.ScalarMappable(norm, shades)
    fraction = max(
        0.05, BAR_LENGTH / 20.0 / max(figure.get_figheight() - 0.8, 1.0)
    )  # a flat picture has a long one, too
    bar = figure.colorbar(mappable, ax=axes, location="bottom", fraction=fraction, pad=0.02, shrink=0.8, ticks=ticks)
    below, above = outside
    texts = ["≤ " * below + texts[0], *texts[1:-1], "≥ " * above + texts[-1]]
    bar.ax.set_xticklabels(texts, color=INK)
    bar.ax.tick_params(which="both", length=0)
    bar.outline.set_visible(False)
    if name:
        bar.set_label(name, color=INK, fontsize=10)


def _ticks(shown: Colours) -> tuple[NDArray[np.float64], list[str]]:
    """Find five places on the scale and their values as texts, or three where five texts would overlap."""
    import matplotlib as mpl  # noqa: PLC0415

    letters = 72 * BAR_LENGTH / (LETTER * mpl.rcParams["font.size"])
    places, values = shown.ticks(5)
    texts = _texts(values)
    if 4 * (max(map(len, texts)) + 1) > letters:
        places, values = shown.ticks(3)
        texts = _texts(values)
    return places, texts


def _texts(values: NDArray[np.float64]) -> list[str]:
    """Write numbers with three digits, or more to tell them apart; zero for one that is rounding beside them."""
    values = np.where(np.abs(values) < DIGIT_ROUNDING * np.ptp(values), 0.0, values)
    for digits in range(3, 10):
        texts = [_text(value, digits) for value in values]
        if len(set(texts)) == len(texts):
            break
    return texts


def _text(value: float, digits: int) -> str:
    """Write a number without an exponent from a thousandth to ten millions."""
    short = float(f"{value:.{digits}g}")
    if 1e3 <= abs(short) < 1e7:
        return np.format_float_positional(short, trim="-")
    return f"{short:.{digits}g}"
