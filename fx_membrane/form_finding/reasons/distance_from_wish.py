"""Distance of the stress found from the wish, in words: mean, largest, where, and a ring too far from its base."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..nearest_stress.equilibrium import State
from ..nearest_stress.ratios import differences
from ..nearest_stress.state import NearestProblem
from ..plan import place
from .ring_reach import far_ring

Array = NDArray[np.float64]

TOLD = 0.1  # mean relative difference of stress and wish, above which a form says so
LOCAL = 0.25  # largest relative difference in a cell, above which it says so: few nearest forms are off by more
ACCEPTED_RING_ERROR = 0.01  # the same, up to which a ring counts as near enough: rules for rings are a guide


def distance(problem: NearestProblem, state: State) -> str:
    """Tell how far the stress is from the wish, and of a ring too far for it; empty where it is near."""
    is_far = state.mean > TOLD or state.largest > LOCAL
    if state.mean <= ACCEPTED_RING_ERROR and not is_far:
        return ""
    ring = far_ring(problem.structure, problem.structure.points, wished(problem))
    if not (is_far or ring):
        return ""
    words = f"The stress differs from the wish by {mean(problem, state)}. {worst(problem, state)}"
    return f"{words} {ring}." if ring else words


def wished(problem: NearestProblem) -> dict[str, Array]:
    """Stress wished for in the first mesh as tensors in space, by membrane, shape (cells, 3, 3) [N/m]."""
    found = {}
    for name, block in problem.membranes.items():
        triangles = block.triangles(problem.structure.points[block.cells])
        found[name] = triangles.frame.swapaxes(1, 2) @ triangles.wish @ triangles.frame
    return found


def mean(problem: NearestProblem, state: State) -> str:
    """Tell the mean difference; it can be above the largest one, as squares for directions and cables add up in it."""
    together = "warp, weft and cables" if problem.bars else "warp and weft"
    return f"{100 * state.mean:.3g} % in the mean, {together} together"


def worst(problem: NearestProblem, state: State) -> str:
    """Tell of the cell whose stress is farthest from the wish."""
    sizes = {name: differences(ratio) for name, ratio in state.ratios.items()}
    name = max(sizes, key=lambda name: float(sizes[name].max(initial=0.0)))
    cell = int(sizes[name].argmax())
    cells = problem.membranes[name].cells if name in problem.membranes else problem.bars[name].cells
    alone = " in one direction" if name in problem.membranes else ""
    return (
        f"The stress is farthest from the wish in part {name!r}, cell {cell} at {place(state.points, cells, cell)}, by "
        f"{100 * state.largest:.3g} %{alone}; form.differences has all."
    )
