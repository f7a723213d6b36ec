"""Fields and the pictures that show them, in the same colours for several states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..checks import validation
from .colour_scale import beyond, colours
from .fields import Checked, Field, checked, checked_range, joined, smooth
from .panels import Panel
from .subjects import Shown


class Options(NamedTuple):
    """Titles of fields that are drawn in a special way.

    Attributes:
        antisymmetric: Those whose sign changes in the mirror image.
        ranges: Minimum and maximum of the colours of some.
        smoothed: Those drawn by means at the nodes.
    """

    antisymmetric: tuple[str, ...]
    ranges: Mapping[str, tuple[float, float]]
    smoothed: tuple[str, ...]


def checked_fields(subject: Shown, fields: Mapping[str, Field]) -> dict[str, Checked]:
    """Fields as arrays, by title.

    Raises:
        ValueError: There is none, or one is no field of the structure.
    """
    validation.instance("fields", fields, Mapping)
    if not fields:
        raise ValueError('fields is empty; give at least one, {"title": values}.')
    return {title: checked(subject, title, field) for title, field in fields.items()}


def checked_options(
    drawn: Mapping[str, Checked],
    antisymmetric: Sequence[str],
    ranges: Mapping[str, Sequence[float]] | None,
    smoothed: Sequence[str],
) -> Options:
    """Options whose titles are those of fields.

    Raises:
        ValueError: A title is none of them; a range is not two numbers, or is given for states.
    """
    validation.instance("ranges", ranges, Mapping | None)
    antisymmetric, smoothed = validation.texts("antisymmetric", antisymmetric), validation.texts("smoothed", smoothed)
    for what, titles in (("antisymmetric", antisymmetric), ("ranges", ranges or {}), ("smoothed", smoothed)):
        unknown = [title for title in titles if title not in drawn]
        if unknown:
            raise ValueError(f"{what} names {unknown[0]!r}; the fields are {list(drawn)}.")
    bounds = {title: checked_range(title, drawn[title], given) for title, given in (ranges or {}).items()}
    return Options(antisymmetric, bounds, smoothed)


def means(subject: Shown, drawn: Mapping[str, Checked], smoothed: Sequence[str]) -> dict[str, Checked]:
    """Fields, some of them by means at the nodes."""
    parts, points = subject.structure.parts, subject.structure.points
    return {
        title: smooth(parts, points, title, field) if title in smoothed else field for title, field in drawn.items()
    }


def panels_of(every: Sequence[Mapping[str, Checked]], options: Options) -> list[list[Panel]]:
    """Pictures of the fields of each state, all states in the same colours."""
    found: list[list[Panel]] = [[] for _ in every]
    for title in every[0]:
        odd, limits = title in options.antisymmetric, options.ranges.get(title)
        together = {str(number): joined(fields[title]) for number, fields in enumerate(every)}
        shades, _ = colours(together, symmetric=odd, limits=limits)
        outside = (False, False)
        if limits is not None:
            drawn = joined(together)
            outside = beyond(np.concatenate([drawn, -drawn]) if odd else drawn, limits)
        name = f"{title} (smoothed)" if title in options.smoothed else title
        for panels, fields in zip(found, every, strict=True):
            _, numbers = colours(fields[title], symmetric=odd, limits=limits)
            panels.append(Panel(name, numbers, shades, outside, antisymmetric=odd))
    return found
