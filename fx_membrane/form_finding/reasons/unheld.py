"""Membranes that nothing holds where they need it: edges without cable or support, and single held points."""

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...geometry.topology import boundary_edges
from ...model.parts import Bar, Membrane
from ...model.structure import Structure

Array = NDArray[np.float64]


def free_edge(structure: Structure, points: Array) -> str:
    """Tell of an edge of a membrane with neither a bar nor supports, in words; empty without one."""
    held, count = structure.supported.any(axis=1), len(points)
    loaded = [
        part.cells[part.prestress_tensors().ravel() != 0] for part in structure.parts.values() if isinstance(part, Bar)
    ]
    membranes = {name: part for name, part in structure.parts.items() if isinstance(part, Membrane)}
    edges = {name: boundary_edges(part.cells) for name, part in membranes.items()}
    none = np.zeros(0, dtype=np.int64)
    seams, times = np.unique(
        np.concatenate([none, *(_keys(segments, count) for segments in edges.values())]), return_counts=True
    )
    carried = np.concatenate([seams[times > 1], *(_keys(cells, count) for cells in loaded)])
    for name, segments in edges.items():
        free = np.flatnonzero(~np.isin(_keys(segments, count), carried) & ~held[segments].all(axis=1))
        if len(free):
            where = validation.format_point(points[segments[free[len(free) // 2]]].mean(axis=0))
            return f"The edge of part {name!r} around {where} has neither a cable with a force nor a support"
    return ""


def lone_point(structure: Structure, points: Array) -> str:
    """Tell of a membrane that is held at a single point within it, in words; empty without one."""
    held = structure.supported.all(axis=1)
    shared = np.zeros(len(points), dtype=bool)
    for part in structure.parts.values():
        if isinstance(part, Bar):
            shared[part.cells] = True
        else:
            shared[boundary_edges(part.cells)] = True
            shared[part.cells[held[part.cells].sum(axis=1) > 1]] = True
    for name, part in structure.parts.items():
        nodes = np.unique(part.cells)
        alone = nodes[held[nodes] & ~shared[nodes]]
        if len(alone):
            return (
                f"Part {name!r} is held at a single point within it, node {alone[0]} at "
                f"{validation.format_point(points[alone[0]])}, which a film carries no force to: hold a ring there, or "
                "lead cables to it"
            )
    return ""


def _keys(segments: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """One number for each segment, whichever its sense."""
    return np.asarray(segments.min(axis=1) * count + segments.max(axis=1))
