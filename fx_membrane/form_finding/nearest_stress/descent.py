"""Newton's steps towards the nearest stress, damped where they lead away from it, each in exact equilibrium."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...solvers.progress import Pulse
from ..form import FormStep
from ..shape_change import change_of_shape
from .equilibrium import State
from .given_geometry import steered_lines
from .state import NearestProblem
from .system import Equations, equations_of, step_of, system_of

Array = NDArray[np.float64]

# The minimum does not depend on the way there: half and double of each but PRESSED move forms by less than 2e-8 of
# their size, at a tolerance of 1e-6. Tried: a cone, a roof under snow, one with given sags.
EXACT_CHANGE = 0.05  # largest change in a step, below which Newton's equations of the mesh are exact, not convex
DAMPING = 1e-2  # first factor of Levenberg's damping
FACTOR = 6.0  # its change from try to try
MAX_TRIES = 12  # maximum number of tries of a step: with 7, forms of rings between 1.3 and 1.4 of their reach are lost
RISE = 1e-2  # relative increase of the norm accepted in a step: the mesh that becomes even has its own
SLACK = 0.01  # rise of the mean difference accepted where the difference is small
EVEN_DIFFERENCE = 1e-6  # mean difference that is none
PRESSED = 0.1  # area of a cell over that in the first shape, below which a body is not to slide further


def settled(
    problem: NearestProblem, state: State, pulse: Pulse, tolerance: float, most: int
) -> tuple[State, list[FormStep], str]:
    """Go on from a state by Newton steps until it settles.

    Args:
        problem: The problem.
        state: The state to start from.
        pulse: Sign of life.
        tolerance: Accepted change in a step [-].
        most: Maximum number of steps.

    Returns:
        The last state, its steps, and the reason to stop, empty if it is settled or out of steps.
    """
    steps, damping, largest = list[FormStep](), DAMPING, np.inf
    starts = _first_areas(problem)
    while len(steps) < most and not (largest <= tolerance and damping <= DAMPING):  # a damped step is short by that
        before = state
        here = problem.on(before.points)
        blocks = problem.at(before).blocks
        exact = largest < EXACT_CHANGE
        lines = steered_lines(problem, before)
        system = system_of(
            blocks, problem.control, problem.point_loads, before.points, before.multipliers, lines, exact
        )
        equations = equations_of(system, problem.control.guide.basis(before.points))
        for tried in range(MAX_TRIES):
            pulse(f"step {len(steps) + 1}, try {tried + 1}, difference of the stress {before.mean:.2e}")
            found = _stepped(here, before, equations, damping / before.area, 0.5**tried, starts)
            if found is not None:
                break
            damping = max(damping, DAMPING / FACTOR) * FACTOR
        if found is None:
            return state, steps, "no step brings the stress nearer to the wish"
        state = found
        damping = damping / FACTOR if tried == 0 else damping
        change = change_of_shape(problem.structure, before.points, state.points - before.points)
        largest = _largest(problem, change, before, state)
        steps.append(FormStep(state.area, largest, state.largest))
    return state, steps, ""


def _stepped(
    problem: NearestProblem, before: State, equations: Equations, damping: float, share: float, starts: Array
) -> State | None:
    """State after a step, with areas of cells to compare; None without a form, or with one farther from the wish."""
    try:
        step = step_of(equations, damping, share)
        found = problem.state(before.points + step[1], before.multipliers + step[0], before=before.densities)
    except (RuntimeError, ValueError):
        return None
    if not problem.control.keeps_sides(before.points, found.points):
        return None
    if not problem.control.guide.motions.bodies:
        return found if found.norm <= before.norm * (1 + RISE) + (SLACK * SLACK) * before.area else None
    # No mesh keeps bodies from sliding within surfaces: each step comes nearer, and no cell is pressed flat.
    shrunk = float((_areas(problem, found.points) / starts).min(initial=1.0))
    limit = before.norm * (1 + RISE) + (EVEN_DIFFERENCE * EVEN_DIFFERENCE) * before.area
    return found if found.norm <= limit and shrunk > PRESSED else None


def _areas(problem: NearestProblem, points: Array) -> Array:
    """Areas of the cells of all membranes in a shape, shape (cells,) [m2]."""
    return np.concatenate([np.empty(0), *(measures(points, block.cells) for block in problem.membranes.values())])


def _first_areas(problem: NearestProblem) -> Array:
    """Areas in the first shape, shape (cells,) [m2]; of its own mesh or of the even one, where long cells are shorter.

    They are for bodies alone; without them there are none.
    """
    if not problem.control.guide.motions.bodies:
        return np.empty(0)
    first = problem.structure.points
    return np.minimum(_areas(problem, first), _areas(problem, problem.control.evened(first)))


def _largest(problem: NearestProblem, change: float, before: State, state: State) -> float:
    """Largest change in a step: of area, shape and stress, and motion within the surface, each relative."""
    area = abs(state.area / before.area - 1)
    stress = max((float(np.abs(now - before.ratios[name]).max()) for name, now in state.ratios.items()), default=0.0)
    motion = float(np.linalg.norm(state.points - before.points, axis=1).max()) / problem.control.mean_edge(
        before.points
    )
    return max(area, stress, change, motion)
