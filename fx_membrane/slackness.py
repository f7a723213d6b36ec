"""Which parts of a state carry nothing, in words."""

import numpy as np
from numpy.typing import NDArray

from .results import BarResult, StageResult


def slack_parts(state: StageResult) -> str:
    """A sentence that names the parts of which no cell, or few, is in tension; nothing where there is none."""
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
