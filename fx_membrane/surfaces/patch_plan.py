"""Plans of connected pieces of membranes, flattened, in which they are meshed anew."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..checks import validation
from ..geometry.sizes import lengths
from ..geometry.topology import boundary_edges
from .flattening import Flat, flattened
from .plan_checks import area, crossing, inside
from .plan_mesh import PlanSegments

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

GROWTH = 0.3  # growth of the size of cells with the distance from finer lines
FINER = 0.8  # size of a segment over the wanted one from which on cells around it are finer
TOUCHING_DISTANCE = 1e-9  # distance over the size of a patch that counts as touching


def ordered(part: str, places: Array, points: Array, segments: Integers, loops: Integers) -> tuple[Integers, Integers]:
    """Segments of the rim end to start, the outer loop first, then those within; and the number of the loop of each."""
    beside: dict[int, list[int]] = {}
    for a, b in segments[loops == 0].tolist():
        beside.setdefault(a, []).append(b)
        beside.setdefault(b, []).append(a)
    pinched = [node for node, others in beside.items() if len(others) != 2]
    if pinched:
        where = validation.format_point(points[pinched[0]])
        raise ValueError(f"Part {part!r} touches itself in a node of its rim, at {where}; join or part it there.")
    found, left = [], set(beside)
    while left:
        loop = [min(left)]
        while True:
            left.discard(loop[-1])
            following = [node for node in beside[loop[-1]] if node in left]
            if not following:
                break
            loop.append(following[0])
        found.append(np.array(loop))
    found.sort(key=lambda loop: -abs(area(places[loop])))
    ordered = [np.column_stack([loop, np.roll(loop, -1)]) for loop in found]
    numbers = np.repeat(np.arange(len(found)), [len(loop) for loop in found])
    within = segments[loops < 0]
    return np.concatenate([*ordered, within]), np.concatenate([numbers, np.full(len(within), -1)])


def check_plan(part: str, plan: PlanSegments, points: Array) -> None:
    """Refuse segments that cut across others, as where few of them follow a narrow strip."""
    touching = TOUCHING_DISTANCE * float(np.ptp(plan.points, axis=0).max())
    found = crossing(plan.points, plan.segments, touching)
    node = plan.segments[found[0], 0] if found else None
    rim = plan.points[plan.segments[plan.loops == 0, 0]]
    alone = np.setdiff1d(np.arange(len(points)), plan.segments)
    outside = alone[~inside(plan.points[alone], rim)] if len(alone) else alone
    node = outside[0] if len(outside) else node
    if node is not None:
        raise ValueError(
            f"size is too large for part {part!r}: its lines cut across each other near "
            f"{validation.format_point(points[node])}; give a smaller one."
        )


def graded(points: Array, wanted: Array, ends: Array) -> Array:
    """Size of cells at nodes, which grows from that of finer segments around.

    Args:
        points: The nodes, shape (n, 3) [m].
        wanted: Wanted size there, shape (n,) [m].
        ends: Ends of segments, shape (k, 2, 3) [m].
    """
    length, middles = lengths(ends[:, 1] - ends[:, 0]), ends.mean(axis=1)
    there = wanted[cKDTree(points).query(middles)[1]]
    finer = length < FINER * there
    if not finer.any():
        return wanted
    distance, nearest = cKDTree(middles[finer]).query(points)
    return np.minimum(wanted, length[finer][nearest] + GROWTH * distance)


def flat_of(part: str, points: Array, triangles: Integers) -> Flat:
    """Flatten a connected piece of a membrane.

    Raises:
        ValueError: It is closed, or folds over itself in its plan.
    """
    where = validation.format_point(points.mean(axis=0))
    if not len(boundary_edges(triangles)):
        raise ValueError(
            f"Part {part!r} is closed around {where}, without a rim, and so without a plan; make it of two parts."
        )
    flat = flattened(points, triangles)
    if flat is None:
        raise ValueError(f"Part {part!r} folds over itself in its plan around {where}; make it of parts that do not.")
    return flat
