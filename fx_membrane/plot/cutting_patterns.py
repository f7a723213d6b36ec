"""Picture of a cutting pattern: strips on the roof, and the same strips flat beside it, in the same colours."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..patterns.flat_strips import CuttingPattern
from ..patterns.strips import Strips
from ..runtime.processes import by_the_first
from .contour_maps import VIEW
from .figures import checked_path, empty, plain, save
from .scene import INK, Colours, picture
from .screen import obstacle
from .strips_in_view import in_view
from .subjects import shown
from .windows import window_of

Array = NDArray[np.float64]

PALETTE = ("#8dd3c7", "#fdb462", "#bebada", "#b3de69", "#80b1d3", "#fb8072", "#fccde5", "#ffed6f")
STRIP_DISTANCE = 0.12  # between flat strips, over their mean width
LOOK: Any = {"scale": 1.0, "mirror": None, "antisymmetric": False}


@by_the_first
def cutting_pattern(
    pattern: CuttingPattern, path: str | Path, *, view: Sequence[float] = VIEW, length_unit: str | None = None
) -> None:
    """Plot the strips of a cutting pattern on the roof, and the cloth of each beside it, the warp upwards.

    Without pyvista, or if VTK cannot draw on a screen or in memory, a warning replaces the file.

    Args:
        pattern: The cutting pattern.
        path: Path of the picture.
        view: Direction from the structure to the eye; z points up.
        length_unit: Name of the length unit at the axes, None for that of the strips; no number is converted.

    Raises:
        ValueError: It is no pattern; view is not a direction; path ends in no picture format, or cannot be written.
    """
    validation.instance("cutting_pattern pattern", pattern, CuttingPattern)
    eye = validation.direction("view", view)
    unit = validation.text("length_unit", pattern.strips.length_unit if length_unit is None else length_unit)
    file = checked_path(path)
    if reason := obstacle():
        warnings.warn(f"{file} is not drawn: {reason}", stacklevel=4)
        return
    draw_pattern(pattern, file, eye, unit)


def draw_pattern(pattern: CuttingPattern, file: Path, eye: Array, unit: str) -> None:
    """Plot as `cutting_pattern`, on one process."""
    colour_of = strip_colours(pattern.strips)
    figure = empty(13.0, 5.6)
    roof, flat = figure.subplots(1, 2, width_ratios=(1, 1))
    _draw_roof(roof, pattern.strips, colour_of, eye)
    _draw_flat(flat, pattern, colour_of, unit)
    save(figure, file)


def strip_colours(strips: Strips) -> dict[str, int]:
    """Choose a colour for each strip, other than those of its neighbours as long as there are enough."""
    found: dict[str, int] = {}
    for number, name in enumerate(strips.names):
        beside = {found.get(other) for edge in strips.edges_of(name) for other in edge.strips}
        turned = [(number + step) % len(PALETTE) for step in range(len(PALETTE))]
        found[name] = next((colour for colour in turned if colour not in beside), turned[0])
    return found


def _draw_roof(axes: Any, strips: Strips, colour_of: dict[str, int], eye: Array) -> None:
    seen = in_view(strips, strips.structure.points).structure
    numbers = {name: np.full(len(strips.membrane(name).cells), float(colour_of[name])) for name in strips.names}
    window = window_of([seen.points[seen.used]], eye)
    colours = Colours(list(PALETTE), -0.5, len(PALETTE) - 0.5, len(PALETTE))
    image = picture(shown("cutting_pattern", seen), numbers, colours, view=eye, window=window, **LOOK)
    axes.imshow(image, extent=window.extent, interpolation="antialiased")
    axes.axis("off")
    axes.set_title("Strips on the roof", color=INK, fontsize=15)


def _draw_flat(axes: Any, pattern: CuttingPattern, colour_of: dict[str, int], unit: str) -> None:
    names = [name for name in pattern.cloth if name not in pattern.strips.copies]
    gap = STRIP_DISTANCE * float(np.mean([pattern.cloth[name].width for name in names]))
    left = 0.0
    for name in names:
        cloth = pattern.cloth[name]
        upright = cloth.points[cloth.outline] @ np.array([(0.0, 1.0), (-1.0, 0.0)])
        moved = upright + np.array([left - upright[:, 0].min(), -upright[:, 1].min()])
        axes.fill(*moved.T, facecolor=PALETTE[colour_of[name]], edgecolor=INK, lw=0.8)
        middle = 0.5 * (moved.min(axis=0) + moved.max(axis=0))
        axes.text(*middle, plain(name), rotation=90, ha="center", va="center", fontsize=8, color=INK)
        left += cloth.width + gap
    axes.set_aspect("equal")
    axes.set_ylabel(f"warp [{unit}]" if unit else "warp", color=INK)
    axes.spines[["top", "right", "bottom"]].set_visible(False)
    axes.set_xticks([])
    axes.set_title("Cloth", color=INK, fontsize=15)
