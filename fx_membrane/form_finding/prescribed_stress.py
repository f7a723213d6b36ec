"""Form finding with a wish for the stress: the shape in equilibrium whose stress is nearest to it.

In general no surface carries a stress that is given in size and direction: equilibrium within a surface demands more.
On a surface of revolution (r n_r)' = n_t along the meridian, so a constant n_r unlike n_t has no form. The form
found here minimizes, over all shapes and all stresses in equilibrium with each other and the loads,

    J = sum over cells of A |w^-1/2 s w^-1/2 - 1|^2 + sum over bars of L b (T / T_w - 1)^2

with the stress s and the wish w where the cell now is, areas A, forces T and lengths L of bars, and the width b, their
force wished for over the mean stress of the membranes: of an edge cable about its radius. Differences are relative, of
warp and weft alike. Among the stresses of one shape the nearest is w + w e w, with the strain e of a multiplier field;
so the optimum is a stationary point of a function of the multipliers and the shape, found by Newton's method with
Levenberg's damping. Nodes move across the surface for the optimum, and within it to the even mesh of `MeshControl`,
the same from all starts. After each step one linear solve with the stress at hand makes the equilibrium exact.

Source: U. Pinkall, K. Polthier 1993 and K.-U. Bletzinger et al. 2005 for the drift of nodes within the surface; A. R.
Conn, N. I. M. Gould, P. L. Toint, Trust-Region Methods, SIAM 2000, ch. 15, for Newton's method under equations; the
optimum itself is that of least-squares control with the equilibrium as its state equation.
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.measures import measures
from ..model.loads import DistributedLoad, PlanLoad, PointLoad, Pressure
from ..model.structure import Structure
from ..runtime.processes import together
from ..solvers.progress import Pulse
from .balance.cable_forces import check_bars
from .balance.constrained_balance import ConstrainedBalance, continued
from .balance.membrane_balance import collapse_of
from .constraints.hand_over import failed_mast
from .constraints.kinds import Constraint
from .form import Form, FormStep, refuse_terms
from .form_loads import checked_form_loads
from .masts.bar_balance import fallen_mast
from .nearest_stress.start import even_state, near_state
from .nearest_stress.state import NearestProblem, State
from .nearest_stress.system import step_of, system_of
from .plan import Field
from .reasons.as_asked import as_asked
from .reasons.axis_balance import remarks_of
from .reasons.distance import distance
from .reasons.few_supports import check_supports_of_form
from .reasons.nearest_reasons import reason_of
from .reasons.unheld import check_edges
from .same_input import refuse_different_input
from .shape_change import change_of_shape
from .updated_reference import UnsettledFormWarning
from .wishes import wishes_of

Array = NDArray[np.float64]

WAY = 0.25  # first share of the way from an even stress to the wish
LONGER = 1.5  # factor on it after a success
WAYS = 14  # maximum number of shares tried
SHORTEST = 0.02  # share, below which no further one is tried
LOOSE = 1e-2  # tolerance of the states on the way
ON_WAY = 12  # maximum number of steps of each
ON_TRIAL = 25  # the same of a trial without one cause of a failure
TRIED = 1e-4  # tolerance of a trial
EXACT = 0.05  # largest change in a step, below which Newton's equations of the mesh are exact, not convex
DAMPING = 1e-2  # first factor of Levenberg's damping
FACTOR = 6.0  # its change from try to try
TRIES = 7  # maximum number of tries of a step
RISE = 1e-2  # relative increase of the norm accepted in a step: the mesh that becomes even has its own
SLACK = 0.01  # rise of the mean difference accepted where the difference is small
EVEN = 1e-6  # mean difference that is none
PRESSED = 0.1  # area of a cell over its first one, below which a body is not to slide further
FAR = 0.5  # relative difference of stress and wish, in the mean over the area, above which the form is not the wish
NEAR = 0.02  # the same, below which a form under constraints stays where no step comes nearer


def prescribed_stress(
    structure: Structure,
    loads: Sequence[PointLoad | DistributedLoad | PlanLoad | Pressure] = (),
    stress: Mapping[str, Field] | None = None,
    warp: Mapping[str, Field] | None = None,
    tolerance: float = 1e-6,
    max_iterations: int = 100,
    constraints: Sequence[Constraint] = (),
) -> Form:
    """Find the shape in equilibrium whose stress is nearest to the prestress of the structure, warp unlike weft.

    The wish is given in space, by the prestress and the warp of the parts, or as functions of place, and taken anew
    where each cell is. Nearest is the least mean over the area of the squared relative difference; edge cables count
    as strips of membrane as wide as their radius, force over stress. The form is in exact equilibrium with the stress
    that it hands over. `Form.wish` and `Form.differences` say how far that is from the wish, cell by cell.

    Args:
        structure: The first mesh with the supports; the prestress is the wish. The mesh may lie in a plane, with its
            held nodes out of it. Nodes slide to an even mesh, which does not depend on the first one. Masts with a
            force need two held ends.
        loads: Loads that the form balances; all but point loads are per area or length of the form.
        stress: By membrane, its stress as a function of place instead of its prestress: called with the centres of the
            cells, shape (3, cells) [m]. It returns numbers, shape (cells,), pairs along warp and weft, (cells, 2), or
            tensors in that frame, (cells, 2, 2) [N/m].
        warp: By membrane, its warp as a function of place, which returns vectors, shape (3,) or (cells, 3); their
            projection on the cell is the warp. `RadialDirection` is that about an axis.
        tolerance: Accepted change of area and of stress in a step, and motion of nodes over the mean edge, each
            relative [-]; the largest is `FormStep.change`. The last steps are Newton's, so the change that is left is
            far smaller, and a form finding of the form moves nothing.
        max_iterations: Maximum number of steps.
        constraints: Cables by force, force density, length, sag or angle; nodes that slide; rings and rigid bodies.
            Forces of these cables are no wish: only the stress of membranes and the forces of other cables give way.

    Returns:
        The form. It has converged if it has settled, and the mean relative difference of stress and wish is below 50 %.
        `Form.remarks` names the wish that would be exact, where it is known; above 10 % in the mean, or 1 % with a ring
        too far from its base, how far the stress is from the wish, where, and the reach of the ring.

    Raises:
        ValueError: A stress is not positive; a warp vanishes in a cell or is normal to it, or its axis goes through a
            cell; an edge has neither cable nor support; a cable is in compression; a part is tied to no held node; the
            loads do not fit the structure; it has energy terms; a constraint does not fit it, or contradicts its
            supports.
        RuntimeError: The loads grow with the form faster than the stress can carry; the first mesh has no form.

    Warns:
        UnsettledFormWarning: The form has not converged; it says for which reason and where, such as edge cables too
            weak for their span. The form is the last one in exact equilibrium.

    Source:
        Equilibrium about an axis: W. Flügge, Stresses in Shells, Springer 1960, ch. 2. Drift of the updated reference:
        K.-U. Bletzinger, R. Wüchner, F. Daoud, N. Camprubí, Computational methods for form finding and optimization of
        shells and membranes, Computer Methods in Applied Mechanics and Engineering 194 (2005) 3438-3452.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 6, 6)
        >>> rim = np.unique(boundary_edges(triangles))
        >>> points[rim, 2] = 0.5 * points[rim, 0] * points[rim, 1]
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), prestress=(3e3, 2e3), warp=(1, 0, 0))
        >>> form = prescribed_stress(Structure(points, {"film": film}, [Support(rim)]))
        >>> form.converged, bool(form.differences["film"].max() < 0.2)
        (True, True)
    """
    with together(MPI.COMM_WORLD):
        validation.instance("prescribed_stress structure", structure, Structure)
        refuse_terms(structure)
        loads = checked_form_loads(structure, loads)
        tolerance = validation.positive("tolerance", tolerance)
        max_iterations = validation.positive_integer("max_iterations", max_iterations)
        constraints = validation.instances("constraints", constraints, Constraint)
        check_bars(structure)
        wishes = wishes_of(structure, stress, warp)
        balance = None
        if not constraints:
            check_supports_of_form(structure, loads)
        else:
            balance = ConstrainedBalance(
                structure, loads, constraints, np.eye(3), "force", lambda shape, _: collapse_of(structure, shape)
            )
        check_edges(structure if balance is None else as_asked(structure, balance).structure)
    settings = {"loads": loads, "tolerance": tolerance, "max_iterations": max_iterations, "constraints": constraints}
    refuse_different_input(structure, settings, {"stress": stress, "warp": warp})
    problem = NearestProblem(structure, loads, wishes, balance=balance)
    pulse = Pulse("form finding", MPI.COMM_WORLD.rank == 0)
    state, steps, failure = _nearest(problem, pulse, tolerance, max_iterations)

    def is_found(other: NearestProblem, at_once: bool) -> bool:
        return _is_found(other, pulse, max(tolerance, TRIED), max_iterations, at_once)

    trial = is_found if balance is None else None
    trouble = reason_of(problem.at(state), state, steps, failure, tolerance, max_iterations, FAR, trial)
    told = tuple(steps) or (FormStep(state.area, np.inf, state.largest),)  # a shape on the way to the wish
    off = "" if balance is None else balance.targets.off(state.points, state.densities)
    apart = distance(problem, state)
    form = problem.form(state, told, True, (*remarks_of(problem, state), *filter(None, (off, apart))))
    if balance is None:
        trouble = trouble or fallen_mast(structure, state.points)
    else:
        trouble = trouble or balance.motions.turned(state.points) or failed_mast(structure, balance.motions, form)
    if trouble:
        warnings.warn(
            f"The form is in equilibrium with the stress it is handed over with, but {continued(trouble)}",
            UnsettledFormWarning,
            stacklevel=2,
        )
    return replace(form, converged=not trouble)


def _nearest(problem: NearestProblem, pulse: Pulse, tolerance: float, most: int) -> tuple[State, list[FormStep], str]:
    """Last state, its steps, and the reason for no further one; from a shape near the wish, or by a way of wishes."""
    reason = ""
    try:
        found = _settled(problem, near_state(problem, pulse), pulse, tolerance, most)
        if not found[2]:
            return found
        if problem.cables is not None and found[0].mean <= NEAR:  # at rest but for bodies that slide within it
            return found[0], found[1], ""
    except (RuntimeError, ValueError) as trouble:  # the even shape has no such limits
        reason = f"; near it, {trouble}" if problem.cables is not None else ""
    start = even_state(problem)
    state, share, length = start, 0.0, WAY
    for _ in range(WAYS):
        following = min(1.0, share + length)
        pulse(f"{100 * following:.0f} % of the way to the wish, difference of the stress {state.mean:.2e}")
        reached = _reached(problem, start, state, following, pulse, tolerance, most)
        if reached is None:
            length /= 2
            if length < SHORTEST:
                break
        elif following == 1:
            return reached
        else:
            state, share, length = reached[0], following, length * LONGER
    words = f"no form is found beyond {100 * share:.0f} % of the way from an even stress to the wish{reason}"
    return problem.measured(*state[:5], 0.0), [], words


def _is_found(problem: NearestProblem, pulse: Pulse, tolerance: float, most: int, at_once: bool) -> bool:
    """Return True if a form is found in a few steps, from a shape near to the wish or by the whole search."""
    few = min(most, ON_TRIAL)
    try:
        if at_once:
            state, steps, failure = _settled(problem, near_state(problem, pulse), pulse, tolerance, few)
        else:
            state, steps, failure = _nearest(problem, pulse, tolerance, few)
    except (RuntimeError, ValueError):
        return False
    return not failure and state.mean <= FAR and steps[-1].change <= tolerance


def _reached(
    problem: NearestProblem, start: State, state: State, share: float, pulse: Pulse, tolerance: float, most: int
) -> tuple[State, list[FormStep], str] | None:
    """State at a share of the way from an even stress to the wish; None without one."""
    at = problem if share == 1 else problem.towards(start, share)
    try:
        begun = at.state(state.points, state.multipliers, least=0.0, before=state.densities)
        found = _settled(at, begun, pulse, *((tolerance, most) if share == 1 else (LOOSE, ON_WAY)))
    except (RuntimeError, ValueError):
        return None
    return None if found[2] else found


def _settled(
    problem: NearestProblem, state: State, pulse: Pulse, tolerance: float, most: int
) -> tuple[State, list[FormStep], str]:
    """Last state, its steps, and the reason for no further one; empty if settled or out of steps."""
    steps, damping, largest = list[FormStep](), DAMPING, np.inf
    while len(steps) < most and not largest <= tolerance:
        before = state
        blocks = problem.at(before).blocks
        exact = largest < EXACT
        system = system_of(blocks, problem.control, problem.point_loads, before.points, before.multipliers, exact)
        basis = problem.control.guide.basis(before.points)
        for tried in range(TRIES):
            pulse(f"step {len(steps) + 1}, try {tried + 1}, difference of the stress {before.mean:.2e}")
            found = _stepped(problem, before, step_of(system, basis, damping / before.area, 0.5**tried))
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


def _stepped(problem: NearestProblem, before: State, step: tuple[Array, Array]) -> State | None:
    """State after a step; None if it has no form, or one that is farther from the wish."""
    try:
        found = problem.state(before.points + step[1], before.multipliers + step[0], before=before.densities)
    except (RuntimeError, ValueError):
        return None
    if not problem.control.keeps_sides(before.points, found.points):
        return None
    if not problem.control.guide.motions.bodies:
        return found if found.norm <= before.norm * (1 + RISE) + (SLACK * SLACK) * before.area else None
    # No mesh keeps bodies from sliding within surfaces: each step comes nearer, and no cell is pressed flat.
    blocks, first = problem.membranes.values(), problem.structure.points
    areas = [measures(found.points, block.cells) / measures(first, block.cells) for block in blocks]
    shrunk = min((float(area.min()) for area in areas), default=1.0)
    limit = before.norm * (1 + RISE) + (EVEN * EVEN) * before.area
    return found if found.norm <= limit and shrunk > PRESSED else None


def _largest(problem: NearestProblem, change: float, before: State, state: State) -> float:
    """Largest change in a step: of area, shape and stress, and motion within the surface, each relative."""
    area = abs(state.area / before.area - 1)
    stress = max((float(np.abs(now - before.ratios[name]).max()) for name, now in state.ratios.items()), default=0.0)
    motion = float(np.linalg.norm(state.points - before.points, axis=1).max()) / problem.control.mean_edge(
        before.points
    )
    return max(area, stress, change, motion)
