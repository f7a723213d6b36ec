"""Sentences on slack parts and on free cable ends."""

import numpy as np
from numpy.typing import NDArray

from ..model.parts import Cable
from ..model.restraint import loose_ends
from .states import BarResult, StageResult


def hanging_ends(state: StageResult) -> str:
    """Sentence on cables with a free, unconnected end; empty if there are none."""
    for name, part in state.structure.parts.items():
        ends = loose_ends(state.structure, name, state.actions.held) if isinstance(part, Cable) else []
        if ends:
            cell, node = ends[0]
            return (
                f" Cell {cell} of {name!r} ends in the air at node {node}, where it can only hang by a weight: hold "
                "that node, or join it to a part."
            )
    return ""


def slack_parts(state: StageResult) -> str:
    """Sentence on parts with no cell, or few cells, in tension; empty if there are none."""
    words = [
        f"{name!r} is slack in {slack} of {len(cells)} cells"
        for name, cells in ((name, _slack(state, name)) for name in state.parts)
        if (slack := int(np.count_nonzero(cells))) > 0.5 * len(cells)
    ]
    if not words:
        return ""
    return f" In the last state tried {', '.join(words)}: give it prestress, or a shorter length to begin with."


def _slack(state: StageResult, name: str) -> NDArray[np.bool_]:
    part = state.parts[name]
    return part.slack if isinstance(part, BarResult) else part.state == "slack"
