"""Nodes of ropes that nothing holds: free ends, and nodes over which a rope slides anywhere along its path."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .loads import PointLoad
from .ropes import Rope
from .stages import Stage
from .structure import Structure


def refuse_loose_nodes(structure: Structure, held: NDArray[np.bool_], stages: Sequence[Stage]) -> None:
    """Refuse ropes over nodes that no other part, support or load of any stage holds.

    Args:
        structure: The structure.
        held: Components that are held in some stage, shape (n, 3).
        stages: The stages.

    Raises:
        ValueError: A node is loose; the message names it.
    """
    loaded = _loaded(structure, stages)
    for name, rope in structure.parts_of(Rope).items():
        of_others = [part.cells.ravel() for other, part in structure.parts.items() if other != name]
        firm = held.any(axis=1) | loaded
        firm[np.concatenate([[], *of_others]).astype(np.int64)] = True
        loose = rope.nodes[~firm[rope.nodes]]
        if not len(loose):
            continue
        node, ends = int(loose[0]), {int(rope.nodes[0]), int(rope.nodes[-1])}
        if node in ends and len(ends) == 2:
            raise ValueError(
                f"Rope {name!r} has a free end at node {node}, without another part, a support or a load: support that "
                "node, connect it to a part, or load it."
            )
        raise ValueError(
            f"Rope {name!r} passes node {node}, which has no other part, support or load, so that its place on the "
            "path is open: leave that node out of the path, hold it, or load it."
        )


def _loaded(structure: Structure, stages: Sequence[Stage]) -> NDArray[np.bool_]:
    """Nodes that loads or energy terms act on, shape (n,)."""
    found = np.zeros(len(structure.points), dtype=bool)
    for load in (*structure.terms, *(load for stage in stages for load in stage.loads)):
        if isinstance(load, PointLoad):
            found[np.asarray(load.nodes)] = True
        else:
            found[structure.parts[load.part].cells] = True
    return found
