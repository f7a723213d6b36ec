"""Contours of fields, and lines of stress, on the deformed structure (pyvista inside matplotlib)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..checks import validation
from ..model.parts import Membrane
from ..runtime.processes import by_the_first
from ..solvers.progress import Pulse
from .field_panels import checked_fields, checked_options, means, panels_of
from .figures import DOTS, checked_path, empty, save
from .marks import TRAJECTORIES, strokes
from .panels import Look, Panel, checked_look, draw_panels, setting, size, without_unseen
from .screen import obstacle
from .subjects import Shape, Shown, shown

VIEW = (1.0, -1.6, 1.1)
SMALL_RESOLUTION = 108  # [1/inch]
MANY_TRIANGLES = 10_000  # triangles in a picture, from which it takes seconds


@by_the_first
def contours(
    result: Shape,
    fields: Mapping[str, Any],
    path: str | Path,
    *,
    scale: float = 1.0,
    view: Sequence[float] = VIEW,
    mirror: str | None = None,
    antisymmetric: Sequence[str] = (),
    ranges: Mapping[str, Sequence[float]] | None = None,
    smoothed: Sequence[str] = (),
    lines: Sequence[str] = (),
    spacing: float | None = None,
    forces: bool = False,
    axes: bool = False,
    force_unit: str = "N",
    length_unit: str = "m",
) -> None:
    """Plot fields on the deformed structure, one picture beside the other; cables and masts are drawn as tubes.

    Without pyvista, or if VTK cannot draw on a screen or in memory, a warning replaces the file.

    Args:
        result: A stage; or a form or a structure, as they are.
        fields: For each title, nodal values, shape (n,), or cell values by part, shape (cells,), as forces of cables;
            cell values may be the states "taut", "wrinkled" and "slack".
        path: Path of the picture.
        scale: Factor of the displacements.
        view: Direction from the structure to the eye; z points up, from straight above, (0, 0, 1), y.
        mirror: "x", "y" or "z" adds the mirror image about that coordinate's zero, for half models.
        antisymmetric: Titles of the fields whose sign changes in the mirror image, such as the displacement across it.
        ranges: Minimum and maximum of the colours for the titles of some fields, {"title": (low, high)}; values beyond
            have the colour of that end, and its number is written with <= or >=. By default the colours go from the
            minimum to the maximum. One peak can leave the rest in one colour.
        smoothed: Titles of fields of cells to be drawn with their means at the nodes, which are less than the peaks;
            "(smoothed)" is added to these titles.
        lines: Lines on the membranes: "stress I" and "stress II" for principal stress trajectories, "warp", "wrinkles"
            in wrinkled cells, "slack" to hatch slack cells.
        spacing: Distance between the lines; by default a twentieth of the extent of the membranes; half of it between
            wrinkles [m].
        forces: Colour cables and masts by their forces, with a colour bar of their own; a field of cables and masts
            alone is then left out, with a warning.
        axes: Draw axes with values and unit around the structure, and a length scale.
        force_unit: Name of the force unit at the forces; no number is converted.
        length_unit: Name of the length unit at the axes.

    Raises:
        ValueError: A field has a wrong number of values, values that are not finite, or names no part; mirror is none
            of the three; antisymmetric, ranges or smoothed name no field; smoothed names nodal values or states; a
            range is not two numbers, the lower first, or is given for states; view is not a direction; scale is not a
            number, or draws displacements 1e4 times as large as the structure; lines names none of its kinds, or the
            warp of membranes without; the structure has no membranes for lines, or no cables or masts for forces; path
            ends in no picture format, or cannot be written.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 8, 4)
        >>> parts = {"strip": Membrane(triangles, Fabric(4e5, 0.3), prestress=(2e3, 1e3), warp=(1, 0, 0))}
        >>> strip = Structure(points, parts)
        >>> plot.contours(strip, {"height [m]": points[:, 2]}, "strip.png", view=(0, 0, 1), lines=["stress I", "warp"])
    """
    subject = shown("contours", result)
    panels = _panels(subject, fields, antisymmetric, ranges, smoothed)
    given = Look(scale, view, mirror, lines, spacing, forces, axes, force_unit, length_unit)
    look = checked_look(subject, given)
    _draw(subject, without_unseen(subject, panels, look, told=True), look, path)


def small_picture(
    result: Shape,
    fields: Mapping[str, Any],
    path: Path,
    ends: tuple[float, float] | None = None,
    symmetric: bool = False,
) -> None:
    """Plot as `contours`, on one process and in two thirds of its time, for pages that show half its size.

    All fields have colours between the same ends, or between their own; symmetric about zero, or not.
    """
    subject = shown("contours", result)
    look = checked_look(subject, Look(1.0, VIEW))
    panels = _panels(subject, fields, tuple(fields) * symmetric, ends and dict.fromkeys(fields, ends), ())
    _draw(subject, panels, look, path, SMALL_RESOLUTION)


@by_the_first
def trajectories(
    result: Shape,
    path: str | Path,
    *,
    title: str = "Principal stress trajectories",
    scale: float = 1.0,
    view: Sequence[float] = VIEW,
    mirror: str | None = None,
    lines: Sequence[str] = TRAJECTORIES,
    spacing: float | None = None,
    forces: bool = False,
    axes: bool = False,
    force_unit: str = "N",
    length_unit: str = "m",
) -> None:
    """Plot lines of stress on the deformed membranes, without colours of a field.

    Args:
        result: A stage; or a form, or a structure as built.
        path: Path of the picture.
        title: Title.
        lines: Kinds of lines, by default all but the warp, see `contours`; the legend has those that there are.
        scale, view, mirror, spacing, forces, axes, force_unit, length_unit: As in `contours`.

    Raises:
        ValueError: As `contours`.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 8, 4)
        >>> parts = {"strip": Membrane(triangles, Fabric(4e5, 0.3), prestress=(2e3, 1e3), warp=(1, 0, 0))}
        >>> plot.trajectories(Structure(points, parts), "strip.png", view=(0, 0, 1), spacing=0.25)
    """
    subject = shown("trajectories", result)
    given = Look(scale, view, mirror, lines, spacing, forces, axes, force_unit, length_unit)
    if not validation.texts("lines", lines):
        raise ValueError("lines is empty; give at least one kind.")
    _draw(subject, [Panel(validation.text("title", title))], checked_look(subject, given), path)


def _panels(
    subject: Shown,
    fields: Mapping[str, Any],
    antisymmetric: Sequence[str],
    ranges: Mapping[str, Sequence[float]] | None,
    smoothed: Sequence[str],
) -> list[Panel]:
    """Check fields, and find their colours."""
    drawn = checked_fields(subject, fields)
    given = checked_options(drawn, antisymmetric, ranges, smoothed)
    return panels_of([means(subject, drawn, given.smoothed)], given)[0]


def _draw(subject: Shown, panels: Sequence[Panel], look: Look, path: str | Path, dots: int = DOTS) -> None:
    file = checked_path(path)
    if reason := obstacle():
        warnings.warn(f"{file} is not drawn: {reason}", stacklevel=4)
        return
    triangles = len(panels) * sum(len(part.cells) for part in subject.structure.parts_of(Membrane).values())
    if triangles > MANY_TRIANGLES:
        Pulse(file.name, shown=True).tell(f"drawing {triangles} triangles")
    groups = strokes(subject, look.lines, look.spacing)
    same = setting([subject], [groups], look)
    same = replace(same, window=same.window._replace(longer=same.window.longer * dots // DOTS))
    figure = empty(*size(panels, look, same))
    draw_panels(figure, subject, panels, look, same, groups)
    save(figure, file, dots)
