"""Strips meshed anew, with cells of a wanted size and the nodes of their seams shared."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..model.parts import Cable
from ..surfaces.remeshing import Size, remeshed
from .split_mesh import pair
from .strip_edges import edges_of_strips
from .strips import Strips

Array = NDArray[np.float64]


def of_size(strips: Strips, points: Array, count: int, size: Size, comm: MPI.Intracomm) -> Strips:
    """Mesh strips anew, and all other membranes with them.

    Args:
        strips: Strips on split cells.
        points: Positions of their nodes on the curved surface, shape (n, 3) [m].
        count: Number of nodes before the split, the first ones.
        size: Wanted length of edges, a number or a function of places [m].
        comm: The processes that call.

    Raises:
        ValueError: As `remeshed`.
    """
    within = [edge for edge in strips.edges if len(edge.strips) > 1 and len(set(edge.strips)) == 1]
    marks = {
        f"{edge.name} within {edge.strips[0]}": Cable(list(pairwise(edge.nodes.tolist())), 1.0) for edge in within
    }  # lines that a new mesh keeps
    made = remeshed(replace(strips.structure, points=points, parts={**strips.structure.parts, **marks}), size, (), comm)
    seams = {pair(a, b) for name in marks for a, b in made.structure.parts[name].cells.tolist()}
    parts = {name: part for name, part in made.structure.parts.items() if name not in marks}
    structure = replace(made.structure, parts=parts)
    cells = [structure.parts[name].cells for name in strips.names]
    numbers = np.repeat(np.arange(len(cells)), [len(entry) for entry in cells])
    edges = edges_of_strips(structure, list(strips.names), numbers, np.concatenate(cells), seams)
    return replace(strips, structure=structure, edges=edges, nodes=made.nodes[:count])
