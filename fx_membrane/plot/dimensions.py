"""Axes with units around a structure in space, and a length scale beside it (matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .scene import INK
from .windows import Window, window_of

Array = NDArray[np.float64]

SHORT_AXIS = 0.12  # length of an axis on the screen over the size of the window below which its ends alone are told
ALONG = 0.99  # cosine of the angle to the view from which an axis is a point
TEXT_SIZE = 9  # size of texts [points]
PIECES = (1, 2, 5)


def box_of(shapes: Sequence[Array]) -> Array:
    """Corners of the box around sets of points, shape (8, 3)."""
    points = np.concatenate(shapes)
    ends = np.stack([points.min(axis=0), points.max(axis=0)])
    return np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for i in (0, 1) for j in (0, 1) for k in (0, 1)])


def edges_of(box: Array, view: ArrayLike) -> dict[int, Array]:
    """Edges of a box that x, y and z are drawn along, each (2, 3); no axis that points to the eye."""
    window = window_of([box], view)
    return {number: _edge(window, box, number) for number in range(3) if abs(window.view[number]) < ALONG}


def draw_axes(axes: Any, window: Window, box: Array, unit: str) -> None:
    """Draw x, y and z with ticks and values along three edges of a box; make room for them."""
    middle = window.seen(box).mean(axis=0)
    for number, edge in edges_of(box, window.view).items():
        _draw_axis(axes, window, edge, number, middle, "xyz"[number] + in_brackets(unit))
    left, right, low, high = window.extent
    room = 0.10 * window.size
    axes.set_xlim(left - room, right + room)
    axes.set_ylim(low - room, high)


def in_brackets(unit: str) -> str:
    """Write a unit after a name; nothing for none."""
    return f" [{unit}]" if unit else ""


def draw_scale(axes: Any, window: Window, unit: str) -> None:
    """Draw a bar whose length is that of a round number below the picture."""
    left, right, low, _ = window.extent
    length = round_length(0.25 * (right - left))
    bottom = min(low, axes.get_ylim()[0]) - 0.02 * window.size
    start = axes.get_xlim()[0]
    ends = ([start, start + length], [bottom, bottom])
    axes.plot(*ends, color=INK, linewidth=2.5, solid_capstyle="butt", clip_on=False)
    for end in ends[0]:
        axes.plot([end, end], [bottom - 0.008 * window.size, bottom + 0.008 * window.size], color=INK, linewidth=1.2)
    axes.text(
        start + length + 0.015 * window.size,
        bottom,
        f"{length:g} {unit}".strip(),
        va="center",
        color=INK,
        fontsize=TEXT_SIZE,
    )
    axes.set_ylim(bottom - 0.03 * window.size, axes.get_ylim()[1])


def round_length(most: float) -> float:
    """Largest of 1, 2 or 5 times a power of ten that is not above a length."""
    power = 10.0 ** np.floor(np.log10(most))
    return float(max(piece * power for piece in PIECES if piece * power <= most * (1 + 1e-12)))


def _edge(window: Window, box: Array, number: int) -> Array:
    """Edge of a box along an axis, the lowest of its outline, or the leftmost of an upright one."""
    order = np.moveaxis(box.reshape(2, 2, 2, 3), number, 2).reshape(4, 2, 3)
    seen = window.seen(order.reshape(-1, 3)).reshape(4, 2, 2)
    along = _along(window, number)
    offset = seen[:, 0] @ np.array([-along[1], along[0]])
    outer = [int(offset.argmin()), int(offset.argmax())]
    upright = abs(along[1]) > 2 * abs(along[0])
    rank = seen[outer].mean(axis=1)[:, 0 if upright else 1]
    beside = upright and number < 2 and abs(window.view[2]) < 0.9  # z is on the left
    return np.asarray(order[outer[int(rank.argmax() if beside else rank.argmin())]])


def _along(window: Window, number: int) -> Array:
    """Direction of a coordinate on the screen, a unit vector."""
    seen = window.axes[:, number]
    return np.asarray(seen / np.linalg.norm(seen))


def _draw_axis(axes: Any, window: Window, edge: Array, number: int, middle: Array, name: str) -> None:
    import matplotlib.ticker  # noqa: PLC0415

    seen, along = window.seen(edge), _along(window, number)
    share = float(np.linalg.norm(seen[1] - seen[0])) / window.size
    out = np.array([-along[1], along[0]])
    out *= np.sign(round(float(out @ (seen.mean(axis=0) - middle)) / window.size, 9)) or 1.0
    axes.plot(*seen.T, color=INK, linewidth=0.9, clip_on=False)
    low, high = edge[:, number]
    if share < SHORT_AXIS:  # no room for ticks
        ends = dict.fromkeys(f"{end + 0.0:.3g}" for end in (low, high))
        _text(axes, seen.mean(axis=0) + 0.02 * window.size * out, out, f"{name}\n{' to '.join(ends)}")
        return
    ticks = matplotlib.ticker.MaxNLocator(nbins=max(2, int(7 * share)), steps=[1, 2, 5, 10]).tick_values(low, high)
    size = high - low
    for tick in ticks[(ticks >= low - 1e-9 * size) & (ticks <= high + 1e-9 * size)]:
        place = seen[0] + (tick - low) / size * (seen[1] - seen[0])
        axes.plot(*np.stack([place, place + 0.012 * window.size * out]).T, color=INK, linewidth=0.9, clip_on=False)
        _text(axes, place + 0.02 * window.size * out, out, f"{tick + 0.0:.10g}")
    _text(axes, seen.mean(axis=0) + 0.075 * window.size * out, out, name)


def _text(axes: Any, place: Array, out: Array, text: str) -> None:
    across = "left" if out[0] > 0.2 else "right" if out[0] < -0.2 else "center"
    up = "bottom" if out[1] > 0.4 else "top" if out[1] < -0.4 else "center"
    axes.text(*place, text, ha=across, va=up, color=INK, fontsize=TEXT_SIZE, clip_on=False)
