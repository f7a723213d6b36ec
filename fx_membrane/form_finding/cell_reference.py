"""Membranes in space as the reference of their stress: each cell in its own plane, along warp and weft."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures, normals, projected
from ..model.parts import Membrane
from .plan import Plan, place

Array = NDArray[np.float64]

NORMAL_TO_X = 0.99  # component of a normal along x, above which the warp of a membrane without one is along y


def reference_of(cells: NDArray[np.int64], points: Array, warp: Array, stress: Array) -> Plan:
    """Make the present shape of a membrane the reference of its stress.

    Args:
        cells: Nodes of the cells, shape (cells, 3).
        points: Positions of the nodes, shape (n, 3) [m].
        warp: Unit tangents, shape (cells, 3) [-].
        stress: Cauchy stress times thickness in the frame of warp and weft, shape (cells, 2, 2) [N/m].
    """
    areas, normal = measures(points, cells), normals(points, cells)
    frame = np.stack([warp, np.cross(normal, warp)], axis=1)
    corners = points[cells]
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    inward = np.cross(normal[:, None], sides) / (2 * areas[:, None, None])
    gradients = frame @ inward.swapaxes(1, 2)
    return Plan(cells, gradients, areas, stress, np.broadcast_to(np.eye(2), stress.shape))


def warp_at(name: str, part: Membrane, points: Array) -> Array:
    """Project the warp of a membrane on its cells in a shape: unit tangents, shape (cells, 3) [-].

    Raises:
        ValueError: The warp is normal to a cell.
    """
    normal = normals(points, part.cells)
    if part.warp is None:
        given = np.where(np.abs(normal[:, :1]) < NORMAL_TO_X, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
    else:
        given = np.broadcast_to(np.asarray(part.warp, dtype=np.float64), normal.shape)
    return tangents(name, part, points, given)


def tangents(name: str, part: Membrane, points: Array, vectors: Array) -> Array:
    """Project vectors on the cells of a membrane in a shape: unit tangents, both of shape (cells, 3) [-].

    Raises:
        ValueError: A vector is zero, or normal to its cell.
    """
    tangent = projected(vectors, normals(points, part.cells))
    bad = np.flatnonzero(~tangent.any(axis=1))
    if len(bad):
        where, given = place(points, part.cells, bad[0]), vectors[bad[0]]
        what = "is normal to the cell" if given.any() else "vanishes there"
        raise ValueError(
            f"Part {name!r}, cell {bad[0]} at {where}: its warp {given.tolist()} {what}; give a vector that lies "
            "roughly in the surface."
        )
    return tangent


def check_tension(name: str, part: Membrane, points: Array, stress: Array) -> None:
    """Refuse a stress that is not a tension in all directions, shape (cells, 2, 2) [N/m].

    Raises:
        ValueError: A principal stress of a cell is not positive.
    """
    least = np.linalg.eigvalsh(stress)[:, 0]
    cell = int(least.argmin())
    if least[cell] <= 0:
        raise ValueError(
            f"Part {name!r}, cell {cell} at {place(points, part.cells, cell)}: its stress is not positive, with a "
            f"principal value of {least[cell]:g}; give a tension in all directions."
        )
