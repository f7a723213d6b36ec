"""Contours of fields on the deformed structure (pyvista inside matplotlib)."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..checks import validation
from ..results.states import StageResult
from ..runtime.processes import by_the_first
from .colours import colour_bar, colours
from .fields import Field, checked, checked_range, checked_scale
from .figures import checked_path, empty, save
from .scene import INK, picture
from .screen import obstacle


@by_the_first
def contours(
    result: StageResult,
    fields: Mapping[str, Field],
    path: str | Path,
    *,
    scale: float = 1.0,
    view: Sequence[float] = (1.0, -1.6, 1.1),
    mirror: str | None = None,
    antisymmetric: Sequence[str] = (),
    ranges: Mapping[str, Sequence[float]] | None = None,
) -> None:
    """Plot fields on the deformed structure, one picture beside the other; cables and masts are drawn as tubes.

    Without pyvista, or if VTK cannot draw on a screen or in memory, a warning replaces the file.

    Args:
        result: A stage.
        fields: For each title, nodal values, shape (n,), or cell values by part, shape (cells,), as forces of cables;
            cell values may be the states "taut", "wrinkled" and "slack".
        path: Path of the picture.
        scale: Factor of the displacements.
        view: Direction from the structure to the eye; z points up, from straight above, (0, 0, 1), y.
        mirror: "x", "y" or "z" adds the mirror image about that coordinate's zero, for half models.
        antisymmetric: Titles of the fields whose sign changes in the mirror image, such as the displacement across it.
        ranges: Minimum and maximum of the colours for the titles of some fields, {"title": (low, high)}; values beyond
            have the colour of that end, and the numbers at the ends are written with <= and >=. By default the colours
            go from the minimum to the maximum. One peak can leave the rest in one colour.

    Raises:
        ValueError: A field has a wrong number of values, values that are not finite, or names no part; mirror is none
            of the three; antisymmetric or ranges name no field; a range is not two numbers, the lower first, or is
            given for states; view is not a direction; scale is not a number, or draws displacements 1e4 times as large
            as the structure; path ends in no picture format, or cannot be written.
    """
    validation.instance("The first argument of contours", result, StageResult)
    validation.instance("fields", fields, Mapping)
    if not fields:
        raise ValueError('fields is empty; give at least one, {"title": values}.')
    drawn = {title: checked(result, title, field) for title, field in fields.items()}
    validation.choice("mirror", mirror, (None, "x", "y", "z"), '"x", "y", "z" or None')
    validation.instance("ranges", ranges, Mapping | None)
    antisymmetric = validation.texts("antisymmetric", antisymmetric)
    for what, titles in (("antisymmetric", antisymmetric), ("ranges", ranges or {})):
        unknown = [title for title in titles if title not in drawn]
        if unknown:
            raise ValueError(f"{what} names {unknown[0]!r}; the fields are {list(drawn)}.")
    bounds = {title: checked_range(title, drawn[title], given) for title, given in (ranges or {}).items()}
    scale = checked_scale(result, scale)
    eye = validation.direction("view", view)
    file = checked_path(path)
    if reason := obstacle():
        warnings.warn(f"{file} is not drawn: {reason}", stacklevel=3)
        return
    figure = empty(6.4 * len(drawn), 5.6)
    panels = figure.subplots(1, len(drawn), squeeze=False)[0]
    for axes, (title, field) in zip(panels, drawn.items(), strict=True):
        shades, numbers = colours(field, symmetric=title in antisymmetric, limits=bounds.get(title))
        axes.imshow(
            picture(result, numbers, shades, scale=scale, view=eye, mirror=mirror, antisymmetric=title in antisymmetric)
        )
        axes.axis("off")
        axes.set_title(title, color=INK, fontsize=15)
        colour_bar(figure, axes, shades, limited=title in bounds)
    save(figure, file)
