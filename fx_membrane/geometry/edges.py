"""Cables along the edges of a membrane, picked from its mesh."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _dolfinx  # before dolfinx: it keeps warnings as they are

# isort: split
from dolfinx import mesh

from ..checks import validation
from ..checks.calls import unfit


def edges_where(
    points: ArrayLike, triangles: ArrayLike, on: Callable[[NDArray[np.float64]], NDArray[np.bool_]]
) -> NDArray[np.int64]:
    """Edges of a membrane on a line or a surface, as cells for cables, shape (edges, 2).

    They are the cells of the dolfinx sub-mesh of these edges, in the user's node numbers.

    Args:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Cells of the membrane, shape (cells, 3).
        on: Function of positions as columns, shape (3, m), that is True for those on it, shape (m,): `lambda x:
            numpy.isclose(x[1], 0)`. An edge is chosen if both its ends are on it.

    Raises:
        ValueError: The triangles name nodes that do not exist; on is no function of that kind; no edge is on it.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 2, 1)
        >>> edges_where(points, triangles, lambda x: x[0] > 1.9).tolist()
        [[2, 5]]
    """
    if shown := unfit(on, 1):
        raise ValueError(f"on is {shown}; give a function of positions, lambda x: numpy.isclose(x[1], 0).")
    positions = validation.positions("points", points)
    mask = np.asarray(on(positions.T))
    if mask.shape != (len(positions),) or mask.dtype != bool:
        raise ValueError(
            f"on gives {validation.short_repr(mask)}; it must give True or False for each position, shape (m,)."
        )
    cells = validation.cells("triangles", triangles, 3)
    validation.in_range("triangles", cells.ravel(), len(positions), "node")
    nodes, local = np.unique(cells, return_inverse=True)
    membrane = _dolfinx.create_mesh(positions[nodes], local.reshape(-1, 3))
    membrane.topology.create_connectivity(1, 2)
    chosen = mesh.locate_entities(membrane, 1, on)
    if not len(chosen):
        raise ValueError(
            "No edge of the membrane lies where cables are wanted; allow for rounding, numpy.isclose(...)."
        )
    line = mesh.create_submesh(membrane, 1, chosen)[0]
    rows = np.asarray(line.geometry.input_global_indices)[_dolfinx.geometry_table(line.geometry)]
    return np.asarray(nodes[rows.reshape(-1, 2)])
