"""Necks: places where a membrane between rings closes, as no surface of its stress spans them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...model.structure import Structure
from ..plan import place
from .ring_reach import has_ring
from .sewn_surfaces import cell_in, cells_of, joined_membranes

SHRUNK = 0.3  # length of a cell over the usual one, below which a membrane closes to a neck


def neck(structure: Structure, points: NDArray[np.float64]) -> str:
    """Tell of the place where a membrane between rings closes to a neck, in words; empty without one.

    Args:
        structure: The first shape.
        points: The shape now, shape (n, 3) [m].
    """
    least, where = SHRUNK, ""
    for names in joined_membranes(structure):
        cells = cells_of(structure, names)
        if not has_ring(structure, cells):
            continue
        ratio = np.sqrt(measures(points, cells) / measures(structure.points, cells))
        ratio /= np.median(ratio)
        cell = int(ratio.argmin())
        if ratio[cell] < least:
            name, _ = cell_in(structure, names, cell)
            least, where = float(ratio[cell]), f"part {name!r}, at {place(points, cells, cell)}"
    if not where:
        return ""
    return (
        f"No surface of this stress spans the supports; it closes to a neck in {where}. Bring the rings nearer to "
        "each other, or make the ring larger. Or wish for more stress from ring to ring than around them, or give the "
        "stress in plan, projected_stress."
    )
