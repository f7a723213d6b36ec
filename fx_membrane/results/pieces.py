"""Pieces of a structure that meet at held nodes only: forces and motions of one say nothing of another."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..geometry.topology import connected
from ..model.structure import Structure


class Pieces:
    """The pieces of a structure.

    Args:
        structure: The structure.
        held: Nodes that connect nothing, as all their components are held, shape (n,).

    Attributes:
        count: Number of pieces.
        nodes: Piece of each node, shape (n,); a held node is a piece of its own.
        cells: Of each part, the piece of each cell, shape (cells,): that of its nodes that are not held. A cell without
            them is a piece of its own.
    """

    def __init__(self, structure: Structure, held: NDArray[np.bool_]):
        found = connected([part.cells for part in structure.parts.values()], ~held)
        self.count, self.nodes = found.pieces, found.nodes
        self.cells = dict(zip(structure.parts, found.cells, strict=True))
