"""First shapes on the way to the nearest stress: near to it at once, or even and far, with a way of wishes to it."""

import numpy as np
from numpy.typing import NDArray

from ...solvers.progress import Pulse
from ..plan import Plan
from .state import NearestProblem, State
from .system import tangential_multipliers

Array = NDArray[np.float64]

GUESSES = 14  # maximum number of linear solves
WORSE = 3  # number of guesses in a row farther than the nearest, after which the guesses end
HALVINGS = 5  # of a correction that leaves a stress no tension
SETTLED = 0.02  # relative change of the difference from the wish, at which the guesses end
EVENED = 6  # number of solves of the even shape with cables, whose force densities follow their lengths
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])  # triangle of equal sides


def near_state(problem: NearestProblem, pulse: Pulse) -> State:
    """Shape near the nearest stress, the nearest of several, each found from the one before.

    The mesh is evened, the wish there is corrected so that it balances within the surface, and the shape is that of the
    corrected stress as natural force densities.

    Raises:
        RuntimeError, ValueError: The first mesh has no form.
    """
    points = problem.structure.points
    state = problem.state(points, np.zeros_like(points), least=0.0)
    found = [state]
    for number in range(GUESSES):
        pulse(f"first shape {number + 1}, difference of the stress {state.mean:.2e}")
        following = _following(problem, state)
        if following is None:
            break
        found.append(following)
        if len(found) > 3 and abs(following.norm / max(state.norm, 1e-300) - 1) <= SETTLED:
            break
        state = following
        nearest = min(range(1, len(found)), key=lambda number: found[number].norm)
        if len(found) - nearest > WORSE:
            break
    return min(found[1:] or found, key=lambda state: state.norm)


def _following(problem: NearestProblem, state: State) -> State | None:
    """Next shape; None without one."""
    points = problem.control.evened(state.points)
    try:
        multipliers = tangential_multipliers(problem.blocks, problem.control, problem.point_loads, points)
    except RuntimeError:
        return None
    for _ in range(HALVINGS):
        try:
            return problem.state(points, multipliers, least=0.0, before=state.densities)
        except (RuntimeError, ValueError):
            multipliers = multipliers / 2
    return None


def even_state(problem: NearestProblem) -> State:
    """Shape of equal stress in triangles of equal sides as references: smooth, even, without a neck, for any wish.

    Raises:
        RuntimeError: The loads grow with the form faster than the stress can carry.
        ValueError: A wish as a function of place is no tension there, or its warp vanishes or is normal to a cell.
    """
    points = problem.structure.points
    none = np.zeros_like(points)
    sides = np.roll(CORNERS, -2, axis=0) - np.roll(CORNERS, -1, axis=0)
    twice = np.sqrt(0.75)
    gradients = np.stack([-sides[:, 1], sides[:, 0]]) / twice
    plans = {}
    for name, block in problem.membranes.items():
        wish = block.triangles(points[block.cells]).wish
        n, stress = len(block.cells), float(np.trace(wish, axis1=1, axis2=2).mean() / 2)
        tensors = np.broadcast_to(stress * np.eye(2), (n, 2, 2))
        frame = np.broadcast_to(np.eye(2), (n, 2, 2))
        plans[name] = Plan(block.cells, np.broadcast_to(gradients, (n, 2, 3)), np.full(n, twice / 2), tensors, frame)
    for _ in range(EVENED if problem.bars else 1):
        densities = problem.densities(points, none)
        found = problem.balanced(points, plans, densities)
        points = found.points
    try:
        return problem.measured(points, none, plans, found.densities, found.reactions, 0.0)
    except RuntimeError:
        for block in problem.membranes.values():
            block.wish.check(points)
        raise
