"""Balance of a wish within the surface of a shape: where its forces along the surface have nothing to hold them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...checks.values import format_point
from ...geometry.sizes import lengths, measures
from ...geometry.vector_columns import columns
from ..nearest_stress.equilibrium import State
from ..nearest_stress.state import NearestProblem

Array = NDArray[np.float64]


def unbalanced_wish(problem: NearestProblem, state: State) -> str:
    """Tell where a wish is farthest from balance within the surface of a state, in words; empty without membranes."""
    here, points = problem.at(state), state.points
    forces, areas, pulls = -here.point_loads.copy(), np.zeros(len(points)), np.zeros(len(points))
    for block in here.blocks:
        at = columns(points[block.cells])
        size = measures(points, block.cells) / 3
        for corner, part in zip(block.cells.T, block.forces(at, np.zeros_like(at)), strict=True):
            np.add.at(forces, corner, part.T)
            np.add.at(pulls, corner, lengths(part.T))
            np.add.at(areas, corner, size if block.cells.shape[1] == 3 else 0.0)
    along = here.control.ways(points).along
    left = lengths(np.asarray(along @ (along.T @ forces.ravel())).reshape(points.shape))
    inside = (areas > 0) & ~here.control.lines.on_line & (pulls > 0)
    if not inside.any():
        return ""
    share = np.divide(left, pulls, where=inside, out=np.zeros_like(left))
    node = int(share.argmax())
    return (
        f"Within the surface the stress wished for is farthest from balance at {format_point(points[node])}: a load of "
        f"{left[node] / areas[node]:.3g} per area along it is missing there, {100 * share[node]:.3g} % of the forces "
        "that meet at the node"
    )
