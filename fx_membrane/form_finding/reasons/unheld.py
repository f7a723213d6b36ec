"""Membranes that nothing holds where they need it: edges without cable or support, and single held points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...geometry.topology import boundary_edges
from ...model.structure import Structure
from ...model.supports import Support
from .edge_lines import keys_of

Array = NDArray[np.float64]


def check_edges(structure: Structure) -> None:
    """Refuse an edge of a membrane that neither a bar with a force, nor a support, nor another membrane holds.

    Raises:
        ValueError: There is one.
    """
    found = _unheld(structure, structure.points)
    if found is not None:
        raise ValueError(
            f"Part {found[0]!r} has an edge at {found[1]} with neither cable nor support, where no stress across it "
            "balances; put a cable there, or hold its nodes."
        )


def free_edge(structure: Structure, points: Array) -> str:
    """Tell of an edge of a membrane with neither a bar nor supports, in words; empty without one."""
    found = _unheld(structure, points)
    if found is None:
        return ""
    return f"The edge of part {found[0]!r} around {found[1]} has neither a cable with a force nor a support"


def lone_point(structure: Structure, points: Array) -> str:
    """Tell of a membrane that is held at a single point within it, in words; empty without one."""
    held = structure.supported.all(axis=1)
    for name, part in structure.membranes.items():
        on = np.isin(np.arange(len(points)), part.cells)
        shared = np.zeros(len(points), dtype=bool)
        shared[boundary_edges(part.cells)] = True
        shared[part.cells[held[part.cells].sum(axis=1) > 1]] = True
        for bar in structure.bars.values():  # only a cable within the membrane leads its force to the point
            shared[bar.cells[(bar.prestress_tensors().ravel() > 0) & on[bar.cells].all(axis=1)]] = True
        alone = np.flatnonzero(on & held & ~shared)
        if len(alone):
            return (
                f"Part {name!r} is held at a single point within it, node {alone[0]} at "
                f"{validation.format_point(points[alone[0]])}, which a film carries no force to: hold a ring there, or "
                "lead cables to it"
            )
    return ""


def lone_head(structure: Structure, node: int) -> str:
    """Tell of a mast head at a single point within a membrane, in words; empty for others."""
    return lone_point(replace(structure, supports=[*structure.supports, Support([node])]), structure.points)


def _unheld(structure: Structure, points: Array) -> tuple[str, str] | None:
    """Membrane with an edge that nothing holds, and its place; None without one."""
    held, count = structure.supported.any(axis=1), len(points)
    loaded = [part.cells[part.prestress_tensors().ravel() != 0] for part in structure.bars.values()]
    membranes = structure.membranes
    edges = {name: boundary_edges(part.cells) for name, part in membranes.items()}
    none = np.zeros(0, dtype=np.int64)
    seams, times = np.unique(
        np.concatenate([none, *(keys_of(segments, count) for segments in edges.values())]), return_counts=True
    )
    carried = np.concatenate([seams[times > 1], *(keys_of(cells, count) for cells in loaded)])
    for name, segments in edges.items():
        free = np.flatnonzero(~np.isin(keys_of(segments, count), carried) & ~held[segments].all(axis=1))
        if len(free):
            return name, validation.format_point(points[segments[free[len(free) // 2]]].mean(axis=0))
    return None
