"""Pieces of a structure that meet at held nodes only: forces and motions of one say nothing of another."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ..model.structure import Structure


class Pieces:
    """The pieces of a structure.

    Args:
        structure: The structure.
        held: Nodes that connect nothing, as all their components are held, shape (n,).

    Attributes:
        count: Number of pieces.
        nodes: Piece of each node, shape (n,); a held node is a piece of its own.
        cells: Of each part, the piece of each cell, shape (cells,): that of its nodes that are not held.
    """

    def __init__(self, structure: Structure, held: NDArray[np.bool_]):
        parts, n = structure.parts, len(structure.points)
        starts = np.concatenate([part.cells.ravel() for part in parts.values()])
        ends = np.concatenate([np.roll(part.cells, -1, axis=1).ravel() for part in parts.values()])
        free = ~held[starts] & ~held[ends]
        links = (np.ones(np.count_nonzero(free), dtype=np.int8), (starts[free], ends[free]))
        self.count, self.nodes = connected_components(sparse.coo_matrix(links, shape=(n, n)), directed=False)
        self.cells = {
            name: self.nodes[part.cells[np.arange(len(part.cells)), (~held[part.cells]).argmax(axis=1)]]
            for name, part in parts.items()
        }
