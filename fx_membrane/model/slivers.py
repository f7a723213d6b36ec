"""Refusal of cells without a measure, and a warning of slender triangles."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import SLENDER, SLIVER, aspects
from .parts import Part


class SliverWarning(UserWarning):
    """Triangle so slender that the rounding of its forces shows in results."""


def check(points: NDArray[np.float64], name: str, part: Part) -> None:
    """Refuse cells without a measure, and triangles whose stiffness is lost in rounding.

    Raises:
        ValueError: A cell has no area or no length, or is more than 1e7 times as long as it is high.

    Warns:
        SliverWarning: A triangle is more than 5e5 times as long as it is high.
    """
    aspect = aspects(points, part.cells)
    cell = int(aspect.argmax())
    if aspect[cell] <= SLENDER:
        return
    where = validation.format_point(points[part.cells[cell]].mean(axis=0))
    what = f"Part {name!r}, cell {cell} (nodes {part.cells[cell].tolist()})"
    if not np.isfinite(aspect[cell]):
        raise ValueError(f"{what} has no {part.measure}, at {where}; remove the cell or move its nodes apart.")
    sliver = f"{what} is a sliver, {aspect[cell]:.2g} times as long as it is high, at {where}"
    remedy = "remove the cell, join its nodes or move them apart"
    if aspect[cell] > SLIVER:
        raise ValueError(f"{sliver}; above {SLIVER:.2g} its stiffness is lost in rounding: {remedy}.")
    share = 400 * np.finfo(float).eps * aspect[cell] ** 2
    warnings.warn(f"{sliver}: up to {share:.1g} % of its forces are rounding; {remedy}.", SliverWarning, stacklevel=5)
