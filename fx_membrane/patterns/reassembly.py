"""Strips sewn together again: the designed shape with the cloth as the natural shape of its cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..model.natural_shape import natural_stretch
from ..model.parts import Membrane
from ..model.structure import Structure
from .flat_strips import CuttingPattern, FlatStrip, check_pattern
from .plane_cells import sides

Array = NDArray[np.float64]


def reassembled(pattern: CuttingPattern) -> Structure:
    """Sew the cloth of a pattern together: the structure as designed, with the cloth as natural shape of its strips.

    Strips have a natural stretch for each cell, from the cloth to the designed shape, and no prestress; their warp runs
    along the threads, straight in the cloth. Cables with their prestress, masts, supports and all other parts remain.

    Args:
        pattern: The pattern.

    Returns:
        The structure; an `Analysis` of it finds the shape and the stress on site, under any load.

    Raises:
        ValueError: It is no pattern; a cell of the cloth is flipped, or half or twice as large as on the surface.

    Example:
        >>> points, triangles = rectangle(8.0, 6.0, 8, 6)
        >>> points[:, 2] = points[:, 0] * points[:, 1] / 12.0  # a hypar, cut along a cable
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable(polyline(range(27, 36)), 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> sewn = reassembled(cutting_pattern(cut_strips(roof, ["valley"]), compensation=(0.995, 0.99)))
        >>> A = sewn.parts["strip 1"].natural_tensors()
        >>> A.shape, bool((np.linalg.det(A) < 1).all())
        ((48, 2, 2), True)
    """
    check_pattern("reassembled", pattern)
    structure = pattern.strips.structure
    sewn = {name: _sewn(structure, pattern, name) for name in pattern.strips.names}
    return replace(structure, parts={**structure.parts, **sewn})


def threads(structure: Structure, cells: NDArray[np.int64], flat: FlatStrip) -> Array:
    """Take unit vectors on the surface along the warp of a flat strip, shape (k, 3) [-]."""
    map_to_surface = sides(structure.points, cells) @ np.linalg.inv(sides(flat.points, flat.triangles))
    along = map_to_surface[:, :, 0]
    return np.asarray(along / np.linalg.norm(along, axis=1)[:, None])


def _sewn(structure: Structure, pattern: CuttingPattern, name: str) -> Membrane:
    part, cloth = pattern.strips.membrane(name), pattern.cloth[name]
    warp = threads(structure, part.cells, cloth)
    try:
        stretch = natural_stretch(structure.points, part.cells, cloth.points[cloth.triangles], warp)
    except ValueError as error:
        raise ValueError(f"Cloth of strip {name!r}: {error}") from None
    return replace(part, prestress=0.0, warp=warp, natural_stretch=stretch)
