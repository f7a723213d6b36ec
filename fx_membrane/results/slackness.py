"""Sentences on slack parts and on free cable ends."""

from __future__ import annotations

import numpy as np

from ..model.parts import Cable
from ..model.restraint import loose_ends
from .initial_stress import reference_stress
from .principal import principal_values
from .states import StageResult


def hanging_ends(state: StageResult) -> str:
    """Sentence on cables with a free, unconnected end; empty if there are none."""
    for name in state.structure.parts_of(Cable):
        for cell, node in loose_ends(state.structure, name, state.actions.held)[:1]:
            return (
                f" Cable {name!r}, cell {cell} has a free end at node {node}: support that node, or connect it to a "
                "part."
            )
    return ""


def slack_parts(state: StageResult) -> str:
    """Sentence on parts with no cell, or few cells, in tension; empty if there are none."""
    slack = {name: part.slack for name, part in state.parts.items()}
    most = [name for name, cells in slack.items() if np.count_nonzero(cells) > 0.5 * len(cells)]
    if not most:
        return ""
    words = [f"{name!r} is slack in {np.count_nonzero(slack[name])} of {len(slack[name])} cells" for name in most]
    given = [
        repr(name)
        for name in most
        if principal_values(reference_stress(state.structure, name, state.actions)).max() > 0
    ]
    advice = ": give it prestress, or a shorter length to begin with."
    if given:
        advice = (
            f". The prestress of {', '.join(given)} is lost there: see whether a stay, a mast or a support is missing, "
            "and whether the prestress is enough for the loads."
        )
    return f" In the last state tried {', '.join(words)}{advice}"
