"""Reasons for which prescribed stresses have no form, in words with numbers and places."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import normals, projected
from ...model.structure import Structure
from .asked_structure import Asked
from .edge_forces import weak_edges
from .folds import fold
from .necks import neck
from .ring_reach import far_ring, has_ring
from .unheld import free_edge, lone_point

Array = NDArray[np.float64]

UNEQUAL_RATIO = 1.05  # ratio of principal stresses, above which they count as unequal


def cause(structure: Structure, points: Array, asked: Asked | None = None, collapsed: Array | None = None) -> str:
    """Tell of the causes that rules establish, or else of unequal stress and of a neck; see `established`.

    Args:
        structure: The structure.
        points: Its first shape, shape (n, 3) [m].
        asked: The same with what its constraints ask for.
        collapsed: The shape that it collapses to, shape (n, 3) [m]; it tells of a neck.

    Returns:
        Sentences; empty without any, which does not mean that there is a form.
    """
    narrow = "" if collapsed is None or not np.isfinite(collapsed).all() else neck(structure, collapsed)
    return established(structure, points, asked) or " ".join(filter(None, (_unequal(structure), narrow)))


def possible(structure: Structure) -> str:
    """Tell of reasons for a collapse that the structure may have, where no rule establishes one."""
    reasons = ["loads too large for the stress, or along the surface"]
    if any(not part.is_strut for part in structure.bars.values()):
        reasons.append("cables too weak, as edges whose force over stress of the fabric is below half their span")
    if any(has_ring(structure, part.cells) for part in structure.membranes.values()):
        reasons.append("rings too far apart")
    return f"No rule establishes the reason; possible ones: {'; '.join(reasons)}."


def established(structure: Structure, points: Array, asked: Asked | None = None) -> str:
    """Sentences on weak edge cables, far rings, edges and points without hold, and folds.

    Args:
        structure: The structure.
        points: Its shape, shape (n, 3) [m].
        asked: The same with what its constraints ask for, see `as_asked`; the structure itself if not given.
    """
    asked = asked or Asked(structure, {})
    stresses = stresses_in(structure, points)
    found = [
        weak_edges(
            asked.structure, points, stresses, forces_in(asked.structure), asked.densities, found=asked.found
        ).words
    ]
    found += [far_ring(structure, points, stresses), free_edge(asked.structure, points), lone_point(structure, points)]
    return causes(*found, fold(structure, points))


def causes(*found: str) -> str:
    """Join the causes that are not empty to sentences."""
    return " ".join(f"{words}." for words in found if words)


def _unequal(structure: Structure) -> str:
    """Tell of a membrane whose stress is unlike along warp and weft."""
    for name, part in structure.membranes.items():
        least, largest = np.linalg.eigvalsh(part.prestress_tensors()).mean(axis=0)
        if largest > UNEQUAL_RATIO * least:
            unequal = (
                f"{largest / least:.3g} times as large in one direction as in the other"
                if least > 0
                else "zero in one direction"
            )
            return (
                f"The stress of part {name!r} is {unequal}, which few surfaces carry everywhere: stress in plan "
                "(projected_stress) has more forms."
            )
    return ""


def stresses_in(structure: Structure, points: Array) -> Mapping[str, Array]:
    """Prestress of membranes in a shape as tensors in space, by name, shape (cells, 3, 3) [N/m]."""
    found = {}
    for name, part in structure.membranes.items():
        normal = normals(points, part.cells)
        warp = projected(structure.warp(name), normal)
        frame = np.stack([warp, np.cross(normal, warp)], axis=2)
        found[name] = frame @ part.prestress_tensors() @ frame.swapaxes(1, 2)
    return found


def forces_in(structure: Structure) -> Mapping[str, Array]:
    """Prestress of cables, by name, shape (cells,) [N]."""
    cables = ((name, part) for name, part in structure.bars.items() if not part.is_strut)
    return {name: part.prestress_tensors().ravel() for name, part in cables}
