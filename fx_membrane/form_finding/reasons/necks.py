"""Necks: places where a membrane between rings closes, as no surface of its stress spans them."""

import numpy as np
from numpy.typing import NDArray

from ...geometry.measures import measures
from ...model.structure import Structure
from ..plan import place
from .ring_reach import has_ring

SHRUNK = 0.3  # length of a cell over the usual one, below which a membrane closes to a neck


def neck(structure: Structure, points: NDArray[np.float64]) -> str:
    """Tell of the place where a membrane between rings closes to a neck, in words; empty without one.

    Args:
        structure: The first shape.
        points: The shape now, shape (n, 3) [m].
    """
    least, where = SHRUNK, ""
    for name, part in structure.parts.items():
        if part.dimension != 2 or not has_ring(structure, part.cells):
            continue
        ratio = np.sqrt(measures(points, part.cells) / measures(structure.points, part.cells))
        ratio /= np.median(ratio)
        cell = int(ratio.argmin())
        if ratio[cell] < least:
            least, where = float(ratio[cell]), f"part {name!r}, at {place(points, part.cells, cell)}"
    if not where:
        return ""
    return (
        f"No surface of such stress spans the supports; it closes to a neck in {where}. Bring the rings nearer to "
        "each other, make the ring larger, wish for more stress from ring to ring than around them, or give the stress "
        "in plan, projected_stress."
    )
