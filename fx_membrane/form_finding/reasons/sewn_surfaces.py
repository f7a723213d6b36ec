"""Membranes joined along seams: surfaces, of which each may be sewn of several parts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...geometry.topology import boundary_edges
from ...model.structure import Structure

Numbers = NDArray[np.int64]

LISTED = 3  # parts named at most


def joined_membranes(structure: Structure, names: Iterable[str] | None = None) -> list[list[str]]:
    """Names of the membranes of each surface, joined where they have an edge in common.

    Args:
        structure: The structure.
        names: Membranes to join; all if not given.
    """
    chosen = [name for name in (structure.parts if names is None else names) if name in structure.membranes]
    if not chosen:
        return []
    edges = [np.sort(boundary_edges(structure.parts[name].cells), axis=1) for name in chosen]
    keys = [edge @ [len(structure.points), 1] for edge in edges]
    _, seam = np.unique(np.concatenate(keys), return_inverse=True)
    owner = np.repeat(np.arange(len(chosen)), [len(key) for key in keys])
    ties = sparse.coo_matrix((np.ones(len(owner)), (owner, seam.ravel()))).tocsr()
    surface = connected_components(ties @ ties.T, directed=False)[1]
    return [[chosen[k] for k in np.flatnonzero(surface == number)] for number in range(surface.max() + 1)]


def cells_of(structure: Structure, names: Sequence[str]) -> Numbers:
    """Cells of membranes, one part after the other, shape (cells, 3)."""
    return np.concatenate([structure.parts[name].cells for name in names])


def cell_in(structure: Structure, names: Sequence[str], cell: int) -> tuple[str, int]:
    """Part and number in it of a cell of membranes that follow each other."""
    counts = np.cumsum([len(structure.parts[name].cells) for name in names])
    number = int(np.searchsorted(counts, cell, side="right"))
    return names[number], cell - int(counts[number]) + len(structure.parts[names[number]].cells)


def listed(names: Sequence[str]) -> str:
    """Name parts in a message, the first few of many."""
    if len(names) == 1:
        return f"part {names[0]!r}"
    words = ", ".join(repr(name) for name in names[:LISTED])
    return f"parts {words}{f' and {len(names) - LISTED} more' if len(names) > LISTED else ''}"
