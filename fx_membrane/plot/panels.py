"""Picture of a structure with its title, colour bars, legend of lines, axes and length scale (matplotlib)."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..surfaces.shapes import surface_of
from ..surfaces.spread_lines import checked_spacing
from ..surfaces.walking import Terrain
from .colour_scale import colour_bar, colours
from .dimensions import box_of, draw_axes, draw_scale, edges_of, in_brackets
from .fields import checked_scale
from .marks import COLOURED, DASHED, NAMES, PLAIN, Strokes, border, checked_kinds
from .scene import INK, Bars, Colours, picture
from .subjects import Shown
from .windows import Window, mirrored, window_of

Array = NDArray[np.float64]

EVEN_FORCES = 0.01  # difference of forces over their size below which colours do not show it
WIDTH = 6.4  # of a picture [inches]


@dataclass(frozen=True, eq=False)
class Look:
    """Look of pictures, the same in all of a figure.

    Attributes:
        scale: Factor of the displacements.
        view: Direction to the eye, shape (3,).
        mirror: Coordinate of a mirror image, or None.
        lines: Kinds of lines, of `marks.KINDS`.
        spacing: Distance between lines [m]; None for that of their function.
        forces: True to colour cables and masts by their forces.
        axes: True for axes and a length scale.
        force_unit: Name of the force unit.
        length_unit: Name of the length unit.
    """

    scale: float
    view: ArrayLike
    mirror: str | None = None
    lines: Sequence[str] = ()
    spacing: float | None = None
    forces: bool = False
    axes: bool = False
    force_unit: str = "N"
    length_unit: str = "m"


@dataclass(frozen=True, eq=False)
class Panel:
    """A picture: its title, the numbers that colour it and their colours.

    Attributes:
        title: Title.
        numbers: Numbers of cells, corners or nodes; None for the colour of fabric.
        colours: Colours of the numbers.
        outside: True for an end of the colours beyond which there are values, the lower one first.
        antisymmetric: True if the sign changes in the mirror image.
    """

    title: str
    numbers: Any = None
    colours: Colours | None = None
    outside: tuple[bool, bool] = (False, False)
    antisymmetric: bool = field(default=False, kw_only=True)


def seen(shown: Shown, panel: Panel, look: Look) -> bool:
    """Tell if a field colours anything: cables and masts coloured by their forces do not show it."""
    membranes = shown.structure.membranes
    if isinstance(panel.numbers, Mapping):
        return any(name in membranes or not look.forces for name in panel.numbers)
    return not look.forces or bool(membranes)


def without_unseen(shown: Shown, panels: Sequence[Panel], look: Look, *, told: bool) -> list[Panel]:
    """Leave out fields that nothing shows, with a warning if it is to be told; one picture of the forces stays."""
    found = [panel for panel in panels if panel.colours is None or seen(shown, panel, look)]
    lost = [panel.title for panel in panels if panel not in found]
    if lost and told:
        warnings.warn(
            f"{', '.join(map(repr, lost))}: only cables and masts could show it, and forces=True colours them by their "
            "forces; leave forces out to see it.",
            stacklevel=4,
        )
    return found or [Panel("")]


def checked_look(shown: Shown, look: Look) -> Look:
    """Look with checked values.

    Raises:
        ValueError: One makes no sense, or asks for lines or forces that there are none of.
    """
    validation.choice("mirror", look.mirror, (None, "x", "y", "z"), '"x", "y", "z" or None')
    kinds = checked_kinds("lines", look.lines, shown)
    spacing = None if look.spacing is None else validation.positive("spacing", look.spacing)
    if kinds and spacing is not None:
        checked_spacing("spacing", Terrain(surface_of("lines", shown.shape, None), cut=True), spacing)
    if validation.truth("forces", look.forces) and not shown.forces:
        raise ValueError("forces is True, but the structure has no cables or masts; leave it out.")
    return Look(
        checked_scale(shown, look.scale),
        validation.direction("view", look.view),
        look.mirror,
        kinds,
        spacing,
        look.forces,
        validation.truth("axes", look.axes),
        validation.text("force_unit", look.force_unit),
        validation.text("length_unit", look.length_unit),
    )


@dataclass(frozen=True, eq=False)
class Setting:
    """Camera, scales and legend of pictures, the same for all of several states.

    Attributes:
        window: Window in which all are seen.
        box: Corners of the box around them, shape (8, 3) [m].
        bars: Colours of forces, or None.
        kinds: Kinds of lines in the legend.
    """

    window: Window
    box: Array
    bars: Colours | None
    kinds: tuple[str, ...]


def setting(subjects: Sequence[Shown], groups: Sequence[Sequence[Strokes]], look: Look) -> Setting:
    """Find the setting of some states, with their lines."""
    shapes = [
        shape[shown.structure.used]
        for shown in subjects
        for shape in mirrored(shown.structure.points + look.scale * shown.displacement, look.mirror)
    ]
    box = box_of(shapes)
    present = {group.kind for every in groups for group in every if len(group.counts)}
    if "slack" in look.lines and any(len(shown.slack) for shown in subjects):
        present.add("slack")
    return Setting(
        window_of([*shapes, *(edges_of(box, look.view).values() if look.axes else ())], look.view),
        box,
        _force_colours(subjects) if look.forces else None,
        tuple(kind for kind in look.lines if kind in present),
    )


def _force_colours(subjects: Sequence[Shown]) -> Colours:
    forces = np.concatenate([force for shown in subjects for force in shown.forces.values()])
    shades, _ = colours({"all": forces}, symmetric=False, limits=None)
    if shades.map == "coolwarm":  # colours that fields do not have; a mast must not make all cables pale
        return Colours("PuOr_r", float(forces.min()), float(forces.max()), shades.bands, halves=True)
    low, high = shades.low, shades.high
    if high - low < EVEN_FORCES * max(abs(low), abs(high)):
        low, high = low - EVEN_FORCES * abs(low), high + EVEN_FORCES * abs(high)
    return Colours("plasma", low, high, shades.bands)


def draw_panels(
    figure: Any, shown: Shown, panels: Sequence[Panel], look: Look, same: Setting, groups: Sequence[Strokes]
) -> None:
    """Draw pictures beside each other."""
    slack = shown.slack if "slack" in look.lines else None
    bars = None if same.bars is None else Bars(shown.forces, same.bars)
    every = figure.subplots(1, len(panels), squeeze=False)[0]
    for axes, panel in zip(every, panels, strict=True):
        image = picture(
            shown, panel.numbers, panel.colours, scale=look.scale, view=look.view, mirror=look.mirror,
            antisymmetric=panel.antisymmetric, strokes=groups, slack=slack, bars=bars, window=same.window,
        )  # fmt: skip
        axes.imshow(image, extent=same.window.extent, interpolation="antialiased")
        axes.axis("off")
        axes.set_title(panel.title, color=INK, fontsize=15)
        if look.axes:
            draw_axes(axes, same.window, same.box, look.length_unit)
            draw_scale(axes, same.window, look.length_unit)
        if same.kinds:
            _legend(axes, same.kinds, plain=panel.colours is None)
        if panel.colours is not None:
            name = panel.title if bars is not None else ""
            colour_bar(figure, axes, panel.colours, panel.outside, name)
        if same.bars is not None:
            masts = any(part.is_strut for part in shown.structure.parts.values())
            kinds = "cables and masts" if masts else "cables"
            colour_bar(figure, axes, same.bars, (False, False), f"Force of {kinds}{in_brackets(look.force_unit)}")


def _legend(axes: Any, kinds: Sequence[str], plain: bool) -> None:
    import matplotlib.lines  # noqa: PLC0415
    import matplotlib.patches  # noqa: PLC0415
    import matplotlib.patheffects  # noqa: PLC0415

    inks, handles = PLAIN if plain else COLOURED, list[Any]()
    for kind in kinds:
        name, ink, beside = NAMES[kind], inks[kind], border(kind, plain)
        if kind == "slack":
            swatch: Any = matplotlib.patches.Patch(
                facecolor="white", edgecolor=ink, hatch="/////", linewidth=0.8, label=name
            )
        else:
            style: Any = (0, (3, 1.5)) if kind in DASHED else "-"
            effects = [matplotlib.patheffects.withStroke(linewidth=3.6, foreground=beside)] if beside else None
            swatch = matplotlib.lines.Line2D(
                [], [], color=ink, linewidth=2.2, linestyle=style, label=name, path_effects=effects
            )
        handles.append(swatch)
    axes.legend(
        handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.01), ncols=min(len(kinds), 3), frameon=False,
        fontsize=10, labelcolor=INK, handlelength=2.6,
    )  # fmt: skip


def size(panels: Sequence[Panel], look: Look, same: Setting) -> tuple[float, float]:
    """Width and height of a figure, multiples of a fiftieth [inches]."""
    left, right, low, high = same.window.extent
    room = 0.1 * same.window.size * look.axes
    image = min(WIDTH * (high - low + 1.5 * room) / (right - left + 2 * room), 4.8)
    bars = (panels[0].colours is not None) + look.forces
    rows = 0.5 + (0.75 if look.forces else 0.55) * bars + 0.35 * bool(same.kinds) + 0.2 * look.axes
    return WIDTH * len(panels), round(50 * (image + rows)) / 50
