"""Reasons for which the nearest stress is not that of the wish: by rules, by trials without one cause, or unknown."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...model.structure import Structure
from ..form import FormStep
from ..nearest_stress.ratios import differences
from ..nearest_stress.state import NearestProblem, State
from ..wishes import Wish
from .as_asked import Asked, as_asked
from .distance import wished, worst
from .folds import fold
from .necks import neck
from .no_form import causes, forces_in
from .ring_reach import far_ring
from .unheld import lone_point
from .weak_edges import GUIDED, WeakEdges, weak_edges

Array = NDArray[np.float64]
Trial = Callable[[NearestProblem, bool], bool]

MARGINS = (0.01, 0.0)  # shares above the force needed, with which a form is tried
FEW, WORK = 2, 3000  # trials with stronger cables at least, and cells of all: a reason takes no longer than the search
UNEQUAL = 1.05  # ratio of principal stresses, above which they count as unequal
UNKNOWN = (
    "The reason is not established: by the rules the edge cables are strong enough and no ring is too far, and no "
    "trial with stronger cables, without loads or with equal stress has a form. Refine the mesh, or begin with another "
    "first shape, as that of projected_stress."
)

UNTRIED = (
    "The reason is not established: by the rules the edge cables are strong enough and no ring is too far. Try without "
    "the constraints, refine the mesh, or begin with another first shape, as that of projected_stress."
)


def reason_of(
    problem: NearestProblem,
    state: State,
    steps: Sequence[FormStep],
    failure: str,
    tolerance: float,
    most: int,
    far: float,
    is_found: Trial | None,
) -> str:
    """Tell of the reason for which a form is not that of the wish, in words; empty if it is the nearest one.

    Args:
        problem: The problem.
        state: Its last state.
        steps: Its steps.
        failure: Failure of the search for its form, in words; empty without one.
        tolerance: Accepted change in a step [-].
        most: Maximum number of steps.
        far: Mean difference of stress and wish above which the form is not that of the wish [-].
        is_found: Trial of another problem, near to the wish at once or by the whole search: True if it has a form; None
            under constraints, for which there is none.
    """
    structure, where = problem.structure, worst(problem, state)
    asked = Asked(structure, {}) if problem.balance is None else as_asked(structure, problem.balance)
    weak = weak_edges(asked.structure, structure.points, wished(problem), forces_in(asked.structure), asked.densities)
    lone = lone_point(structure, structure.points)
    settled = bool(steps) and steps[-1].change <= tolerance
    if failure or state.mean > far:
        distance = failure or f"its stress is far from the wish, by {100 * state.mean:.3g} % in the mean"
        return f"it is not that of the wish: {distance}. {_established(problem, state, weak, lone, is_found)} {where}"
    if lone or (weak.words and _is_far(problem, state, weak, far)):
        depends = "it depends on the mesh" if lone else "it is not that of the wish"
        return f"{depends}. {causes(weak.words, lone)} {where}"
    if settled:
        return ""
    ring = causes(far_ring(structure, structure.points, wished(problem)), where.removesuffix("."))
    if len(steps) < most:
        return (
            f"it has not settled: no step after {len(steps)} brings the stress nearer to the wish, as a Ring or a "
            "RigidBody slides within the surface or between its cables. Guide it by supports, or give a ring its "
            f"radius, or a cable with a force along it. {ring}"
        )
    return (
        f"it has not settled: step {len(steps)}, the last, changed it by {steps[-1].change:.3g}, more than the "
        f"tolerance {tolerance:g}; allow more steps (max_iterations=...). {ring}"
    )


def _established(problem: NearestProblem, state: State, weak: WeakEdges, lone: str, is_found: Trial | None) -> str:
    """Sentences on the reason that is established, or on that none is."""
    structure = problem.structure
    ring = far_ring(structure, structure.points, wished(problem))
    if weak.words:
        stronger = _with_stronger_edges(problem, weak, is_found)
        return causes(stronger.words, lone) if stronger else causes(weak.words, ring, lone)
    if ring or lone:
        return causes(ring, lone)
    found = (
        _by_trial(problem, weak, is_found) or neck(structure, state.points) or causes(fold(structure, structure.points))
    )
    return found or (UNTRIED if is_found is None else UNKNOWN)


def _by_trial(problem: NearestProblem, weak: WeakEdges, is_found: Trial | None) -> str:
    """Tell of the cause without which a form is found, in words; empty without one."""
    if is_found is None:
        return ""
    if problem.loads and is_found(NearestProblem(problem.structure, (), problem.wishes), True):
        return "The loads are too large for the stress wished for: without them a form is found."
    if weak.edges and (stronger := _with_stronger_edges(problem, weak, is_found)):
        return causes(stronger.words)
    ratio = _ratio(problem)
    if ratio > UNEQUAL and is_found(_equal(problem), True):
        return (
            f"The stress wished for is {ratio:.3g} times as large in one direction as in the other, and only with "
            "their mean in all directions a form is found: wish for a smaller ratio, or give the stress in plan, "
            "projected_stress."
        )
    return ""


def _with_stronger_edges(problem: NearestProblem, weak: WeakEdges, is_found: Trial | None) -> WeakEdges | None:
    """Edge cables with the forces of the first form found by trial; None without one."""
    if is_found is None:
        return None
    cells = sum(len(block.cells) for block in problem.membranes.values())
    given, trials = forces_in(problem.structure), list(weak.trials())[: max(FEW, WORK // max(cells, 1))]
    # Near their limit cables are worth the whole search, a longer one.
    whole = trials[:2] if weak.weak and weak.largest <= GUIDED else []
    for at_once, of_these in ((True, trials), (False, whole)):
        for raised in of_these:
            tried = (_with_forces(problem.structure, raised.forces(given, margin)) for margin in MARGINS)
            if all(is_found(NearestProblem(one, problem.loads, problem.wishes), at_once) for one in tried):
                return raised
    return None


def _with_forces(structure: Structure, forces: dict[str, Array]) -> Structure:
    parts = {
        name: replace(part, prestress=forces[name]) if part.dimension == 1 and name in forces else part
        for name, part in structure.parts.items()
    }
    return replace(structure, parts=parts)


def _is_far(problem: NearestProblem, state: State, weak: WeakEdges, far: float) -> bool:
    """Return True if the stress at edges that are too weak is far from the wish: the rules for them are a guide."""
    parts = problem.structure.parts
    edges = (weak.edges[k] for k in weak.weak)
    nodes = np.concatenate([parts[edge.part].cells[edge.cells].ravel() for edge in edges])
    blocks = {name: block.cells for name, block in problem.membranes.items()}
    blocks |= {name: block.cells for name, block in problem.bars.items()}
    return any(
        (differences(state.ratios[name])[np.isin(cells, nodes).any(axis=1)] > far).any()
        for name, cells in blocks.items()
    )


def _ratio(problem: NearestProblem) -> float:
    """Largest ratio of principal stresses of the wish, in the mean of a membrane [-]."""
    found = 1.0
    for block in problem.membranes.values():
        values = np.linalg.eigvalsh(block.triangles(problem.structure.points[block.cells]).wish)
        found = max(found, float(np.mean(values[:, 1] / values[:, 0])))
    return found


def _equal(problem: NearestProblem) -> NearestProblem:
    """Problem with the mean of the principal stresses in all directions."""

    def equal(wish: Wish) -> Wish:
        def size(x: Array) -> Array:
            mean = np.trace(wish.size(x), axis1=1, axis2=2) / 2
            return np.asarray(mean[:, None, None] * np.eye(2))

        return wish._replace(direction=None, size=size)

    return NearestProblem(
        problem.structure, problem.loads, {name: equal(wish) for name, wish in problem.wishes.items()}
    )
