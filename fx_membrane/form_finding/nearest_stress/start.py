"""First shapes on the way to the nearest stress: near to it at once, or even and far, with a way of wishes to it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...model.loads import PointLoad
from ...solvers.progress import Pulse
from ..balance.constrained_balance import Balance
from ..plan import Plan
from .equilibrium import State
from .state import NearestProblem
from .system import tangential_multipliers

Array = NDArray[np.float64]

# Half and double of each were tried on a cone, a roof under snow and one with sags: forms move by less than 1e-8 of
# their size. They do not depend on where the steps towards them start.
GUESSES = 14  # maximum number of linear solves
WORSE = 3  # number of guesses in a row farther than the nearest, after which the guesses end
HALVINGS = 5  # of a correction that leaves a stress no tension
SETTLED_CHANGE = 0.02  # relative change of the difference from the wish, at which the guesses end
EVENED = 6  # number of solves of the even shape with cables, whose force densities follow their lengths
RAISES = 12  # number of doublings of the stress at most, with which an even shape holds the loads
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]])  # triangle of equal sides


def near_state(problem: NearestProblem, pulse: Pulse) -> State:
    """Shape near the nearest stress, the nearest of several, each found from the one before.

    The mesh is evened, and the wish there corrected so that it balances within the surface. The shape is that of the
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
        if len(found) > 3 and abs(following.norm / max(state.norm, 1e-300) - 1) <= SETTLED_CHANGE:
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
        here = problem.on(points)
        multipliers = tangential_multipliers(here.blocks, problem.control, problem.point_loads, points)
    except (RuntimeError, ValueError):
        return None
    for _ in range(HALVINGS):
        try:
            return here.state(points, multipliers, least=0.0, before=state.densities)
        except (RuntimeError, ValueError):
            multipliers = multipliers / 2
    return None


def even_state(problem: NearestProblem) -> State:
    """Shape of equal stress in triangles of equal sides as references: smooth, even, without a neck, for any wish.

    Where loads are too large for it, its stress is larger, see `factor_for_loads`.

    Raises:
        RuntimeError: The loads grow with the form faster than any stress tried can carry; a cable shrinks to nothing.
        ValueError: A wish as a function of place is no tension there, or its warp vanishes or is normal to a cell.
    """
    _, found, plans = _even_under_loads(problem)
    try:
        none = np.zeros_like(found.points)
        return problem.measured(found.points, none, plans, found.densities, found.reactions, 0.0)
    except RuntimeError:
        for block in problem.membranes.values():
            for points in (problem.structure.points, found.points):
                block.wish.check(points)
        raise


def factor_for_loads(problem: NearestProblem) -> float:
    """Factor on the wished stress and forces, a power of two, with which an even shape holds the loads [-].

    One if no load grows with the form.

    Raises:
        RuntimeError: The loads grow with the form faster than any stress tried can carry.
    """
    return _even_under_loads(problem)[0] if _loads_grow(problem) else 1.0


def _loads_grow(problem: NearestProblem) -> bool:
    return not all(isinstance(load, PointLoad) for load in problem.loads)


def _even_under_loads(problem: NearestProblem) -> tuple[float, Balance, dict[str, Plan]]:
    """Factor on the stress, and the even shape with it; the error is that of the wish itself."""
    failure = None
    for number in range(RAISES if _loads_grow(problem) else 1):
        try:
            return (2.0**number, *_even(problem, 2.0**number))
        except RuntimeError as error:
            failure = failure or error
    assert failure
    raise failure


def _even(problem: NearestProblem, factor: float) -> tuple[Balance, dict[str, Plan]]:
    """Shape of equal stress, the mean of the wish times a factor, and its references."""
    points = problem.structure.points
    none = np.zeros_like(points)
    sides = np.roll(CORNERS, -2, axis=0) - np.roll(CORNERS, -1, axis=0)
    twice = np.sqrt(0.75)
    gradients = np.stack([-sides[:, 1], sides[:, 0]]) / twice
    plans = {}
    for name, block in problem.membranes.items():
        wish = block.triangles(points[block.cells]).wish
        n, stress = len(block.cells), factor * float(np.trace(wish, axis1=1, axis2=2).mean() / 2)
        tensors = np.broadcast_to(stress * np.eye(2), (n, 2, 2))
        frame = np.broadcast_to(np.eye(2), (n, 2, 2))
        plans[name] = Plan(block.cells, np.broadcast_to(gradients, (n, 2, 3)), np.full(n, twice / 2), tensors, frame)
    for _ in range(EVENED if problem.bars else 1):
        densities = {
            name: np.where(problem.given(name), density, factor * density)
            for name, density in problem.densities(points, none).items()
        }
        found = problem.balanced(points, plans, densities)
        points = found.points
    return found, plans
