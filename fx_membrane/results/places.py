"""Places of nodes and cells in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..model.structure import Structure


def node_place(structure: Structure, node: int) -> str:
    """Name a node and its place."""
    return f"node {node} at {_shown(structure, structure.points[node])}"


def cell_place(structure: Structure, part: str, cell: int) -> str:
    """Name a cell of a part and the place of its centroid."""
    return f"cell {cell} at {_shown(structure, structure.points[structure.parts[part].cells[cell]].mean(axis=0))}"


def _shown(structure: Structure, point: NDArray[np.float64]) -> str:
    """Show a place to a millionth of the size of the structure."""
    unit = 10.0 ** np.floor(np.log10(1e-6 * structure.size))
    return f"({', '.join(f'{np.round(value / unit) * unit + 0.0:.5g}' for value in point)})"
