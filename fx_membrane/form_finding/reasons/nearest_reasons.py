"""Reasons for which the nearest stress is not that of the wish: by rules, by trials without one cause, or unknown."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...model.structure import Structure
from ..form import FormStep
from ..nearest_stress.equilibrium import State
from ..nearest_stress.ratios import differences
from ..nearest_stress.start import factor_for_loads
from ..nearest_stress.state import NearestProblem
from ..wishes import Wish
from .asked_structure import Asked, as_asked
from .distance_from_wish import ACCEPTED_RING_ERROR, mean, wished, worst
from .edge_forces import GUIDED, WeakEdges, weak_edges
from .folds import fold
from .necks import neck
from .no_form import UNEQUAL_RATIO, causes, forces_in
from .ring_reach import far_ring
from .unheld import lone_point
from .wish_balance import unbalanced_wish

Array = NDArray[np.float64]
Trial = Callable[[NearestProblem, bool], bool]

MARGINS = (0.01, 0.0)  # shares above the force needed, with which a form is tried
FEW, WORK = 1, 3000  # trials with stronger cables at least, and cells of all: a reason takes no longer than the search
WHOLE = 1000  # cells up to which a trial may be a whole search
# Distance of a ring over the reach of its membrane, above which a shape is that of its mesh: on canopies of 12 m forms
# are found on all meshes tried at 1.1 and 1.49, and found on some only at 1.7 and 2.1. From 1.3 on, cones with 12
# segments around the ring lose their stress there on the way to a form.
BEYOND = 1.5
UNKNOWN = (
    "The reason is not established: by the rules the edge cables are strong enough and no ring is too far. No trial "
    "with stronger cables, without loads or with equal stress has a form. Change the stress there, refine the mesh, or "
    "begin with another first shape, as that of projected_stress."
)

UNTRIED = (
    "By the rules the edge cables are strong enough and no ring is too far. Try without the constraints, change the "
    "stress there, refine the mesh, or begin with another first shape, as that of projected_stress."
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
    weak, folded = _weak_edges(problem), fold(problem.structure, problem.structure.points)
    asked = structure if problem.balance is None else as_asked(structure, problem.balance).structure
    lone = lone_point(asked, structure.points)
    settled = bool(steps) and steps[-1].change <= tolerance
    if failure or state.mean > far:
        distance = failure or f"its stress is far from the wish, by {mean(problem, state)}"
        reason = _established(problem, state, weak, lone, folded, is_found)
        return f"it is not that of the wish: {distance}. {reason} {where}"
    if lone or (weak.words and _is_far(problem, state, weak, far)):
        depends = "it depends on the mesh" if lone else "it is not that of the wish"
        return f"{depends}. {causes(weak.words, lone, folded)} {where}"
    far_away = far_ring(structure, structure.points, wished(problem))
    if settled and state.mean > ACCEPTED_RING_ERROR and is_beyond_reach(problem):
        return (
            "no surface has the stress wished for, and the form depends on the mesh: its stress differs by "
            f"{mean(problem, state)}. {causes(far_away, folded)} {where}"
        )
    if settled:
        return ""
    ring = causes(weak.words, _loose_ring(problem), far_away, folded, where.removesuffix("."))
    if len(steps) < most:
        return (
            f"it has not settled: no step after {len(steps)} brings the stress nearer to the wish. A Ring or a "
            "RigidBody slides within the surface or between its cables. Guide it by supports, or give a ring its "
            f"radius. {ring}"
        )
    return (
        f"it has not settled: step {len(steps)}, the last, changed it by {steps[-1].change:.3g}, more than the "
        f"tolerance {tolerance:g}; allow more steps (max_iterations=...). {ring}"
    )


def has_weak_edges(problem: NearestProblem) -> bool:
    """Return True if cables are too weak by the rules, so that a form is not to be expected."""
    return bool(_weak_edges(problem).words)


def has_far_too_weak_edges(problem: NearestProblem) -> bool:
    """Return True if cables lack so much by the rules that no search is worth its time."""
    weak = _weak_edges(problem)
    return bool(weak.words) and weak.largest > GUIDED


def is_beyond_reach(problem: NearestProblem) -> bool:
    """Return True if a ring is so far from its base that a form would depend on the mesh."""
    return bool(far_ring(problem.structure, problem.structure.points, wished(problem), BEYOND))


def is_far_at_edges(problem: NearestProblem, state: State, far: float) -> bool:
    """Return True if cables are too weak by the rules, and the stress there differs by more than a share."""
    weak = _weak_edges(problem)
    return bool(weak.words) and _is_far(problem, state, weak, far)


def _weak_edges(problem: NearestProblem) -> WeakEdges:
    """Edge cables with the forces that constraints ask for, under the wish in the first mesh."""
    asked = Asked(problem.structure, {}) if problem.balance is None else as_asked(problem.structure, problem.balance)
    points, forces = problem.structure.points, forces_in(asked.structure)
    return weak_edges(asked.structure, points, wished(problem), forces, asked.densities, found=asked.found)


def _established(
    problem: NearestProblem, state: State, weak: WeakEdges, lone: str, folded: str, is_found: Trial | None
) -> str:
    """Sentences on the reason that is established, or on that none is."""
    structure = problem.structure
    ring = _loose_ring(problem) or _far_ring(problem)
    if heavy := _heavy_loads(problem):
        return causes(heavy, weak.words, ring, lone, folded)
    if weak.words:
        stronger = _with_stronger_edges(problem, weak, is_found)
        return causes(*((stronger.words,) if stronger else (weak.words, ring)), lone, folded)
    if ring or lone:
        return causes(ring, lone, folded)
    found = _by_trial(problem, weak, is_found) or neck(structure, state.points) or causes(folded)
    return found or f"{causes(unbalanced_wish(problem, state))} {UNTRIED if is_found is None else UNKNOWN}".strip()


def _far_ring(problem: NearestProblem) -> str:
    """Tell of a ring too far from its base, and of the mesh where others have a form; empty without one."""
    ring = far_ring(problem.structure, problem.structure.points, wished(problem))
    if not ring or is_beyond_reach(problem):
        return ring
    return f"{ring}. Up to {BEYOND:g} times that, a mesh finer around the ring may have a form, whose stress differs"


def _heavy_loads(problem: NearestProblem) -> str:
    """Tell of loads that equal stress as large as the wish cannot hold, in words; empty without them."""
    factor = factor_for_loads(problem)
    if factor <= 1:
        return ""
    return (
        "The loads are too large for the stress wished for: they grow with the form faster than stress of that size, "
        f"equal in all directions, holds; an even shape with {factor:g} times as much holds them. Give a larger stress "
        "or smaller loads"
    )


def _loose_ring(problem: NearestProblem) -> str:
    """Tell of a ring of free radius with no cable along it, in words; empty without one."""
    bodies = () if problem.balance is None else problem.balance.motions.bodies
    for body in bodies:
        along = (np.isin(bar.cells, body.nodes).all(axis=1).any() for bar in problem.bars.values())
        if body.is_ring and not body.radius_given and not any(along):
            return (
                f"{body.label} has neither a radius of its own nor a cable with a force along it. Nothing within it "
                "holds it against the membrane: give its radius (radius=...), or a cable along it"
            )
    return ""


def _by_trial(problem: NearestProblem, weak: WeakEdges, is_found: Trial | None) -> str:
    """Tell of the cause without which a form is found, in words; empty without one."""
    if is_found is None:
        return ""
    if problem.loads and is_found(NearestProblem(problem.structure, (), problem.wishes), True):
        return "The loads are too large for the stress wished for: without them a form is found."
    if weak.edges and (stronger := _with_stronger_edges(problem, weak, is_found)):
        return causes(stronger.words)
    ratio = _ratio(problem)
    if ratio > UNEQUAL_RATIO and is_found(_equal(problem), True):
        return (
            f"The stress wished for is {ratio:.3g} times as large in one direction as in the other. Only with their "
            "mean in all directions a form is found: wish for a smaller ratio, or give the stress in plan, "
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
    whole = trials[:2] if cells <= WHOLE and weak.weak and weak.largest <= GUIDED else []
    for at_once, of_these in ((True, trials), (False, whole)):
        for raised in of_these:
            tried = (_with_forces(problem.structure, raised.forces(given, margin)) for margin in MARGINS)
            if all(is_found(NearestProblem(one, problem.loads, problem.wishes), at_once) for one in tried):
                return raised
    return None


def _with_forces(structure: Structure, forces: dict[str, Array]) -> Structure:
    parts = {
        name: replace(part, prestress=forces[name]) if name in structure.bars and name in forces else part
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

        return wish._replace(direction=None, size=size, along=None)

    return NearestProblem(
        problem.structure, problem.loads, {name: equal(wish) for name, wish in problem.wishes.items()}
    )
