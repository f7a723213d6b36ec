"""Form finding with a wish for the stress: the shape in equilibrium whose stress is nearest to it.

In general no surface carries a stress that is given in size and direction: equilibrium within a surface demands more.
On a surface of revolution (r n_r)' = n_t along the meridian, so a constant n_r unlike n_t has no form. The form
found here minimizes, over all shapes and all stresses in equilibrium with each other and the loads,

    J = sum over cells of A |w^-1/2 s w^-1/2 - 1|^2 + sum over bars of L b (T / T_w - 1)^2

with the stress s and the wish w where the cell now is, areas A, forces T and lengths L of bars. The width b is their
force wished for over the mean stress of the membranes: of an edge cable about its radius. Differences are relative, of
warp and weft alike. Among the stresses of one shape the nearest is w + w e w, with the strain e of a multiplier field;
so the optimum is a stationary point of a function of the multipliers and the shape. Newton's method with Levenberg's
damping finds it. Across the surface nodes move to the optimum, within it to the even mesh of `MeshControl`, from all
starts. After each step one linear solve with the stress at hand makes the equilibrium exact.

Source: X. Pennec, P. Fillard, N. Ayache, A Riemannian framework for tensor computing, International Journal of Computer
Vision 66 (2006) 41-66, for relative differences of tensors, here to first order; U. Pinkall, K. Polthier 1993 and K.-U.
Bletzinger et al. 2005 for the drift of nodes within the surface; A. R. Conn, N. I. M. Gould, P. L. Toint, Trust-Region
Methods, SIAM 2000, ch. 15, for Newton's method under equations; M. Hinze, R. Pinnau, M. Ulbrich, S. Ulbrich,
Optimization with PDE Constraints, Springer 2009, for least squares with the equilibrium as state equation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..checks import validation
from ..model.loads import FormLoad, Load
from ..model.structure import Structure
from ..runtime.processes import together
from ..solvers.progress import Pulse
from .balance.cable_forces import check_bars
from .balance.constrained_balance import ConstrainedBalance
from .balance.membrane_balance import collapse_of
from .constraints.hand_over import failed_mast
from .constraints.kinds import Constraint
from .form import Form, FormStep, refuse_unfit
from .form_loads import checked_form_loads
from .masts.bar_balance import fallen_mast
from .masts.standing_masts import has_masts, stand
from .natural_densities import natural_force_density
from .nearest_stress.descent import settled
from .nearest_stress.equilibrium import State
from .nearest_stress.start import even_state, near_state
from .nearest_stress.state import NearestProblem
from .plan import Field
from .reasons.asked_structure import as_asked
from .reasons.axis_balance import remarks_of
from .reasons.distance_from_wish import distance
from .reasons.few_supports import check_supports_of_form
from .reasons.nearest_reasons import has_far_too_weak_edges, has_weak_edges, is_beyond_reach, is_far_at_edges, reason_of
from .reasons.unheld import check_edges
from .same_input import refuse_different_input
from .unsettled_form import warn_of_doubt
from .wishes import Directed, wishes_of

Array = NDArray[np.float64]

# Where the wish has no form, the last good one hangs on the way: with half of WAY, a cone of radius 0.8 m and height 6
# m, too far from its base, differs. Its places and forces change by up to a tenth of the largest. Each is exact.
WAY = 0.25  # first share of the way from an even stress to the wish
LONGER = 1.5  # factor on it after a success
WAYS = 14  # maximum number of shares tried
MIN_SHARE = 0.02  # share, below which no further one is tried
WAY_TOLERANCE = 1e-2  # tolerance of the states on the way
FEWEST, DOUBTED = 3, 7000  # shares tried at least, and shares times cells, where the rules let expect no form
ON_WAY = 12  # maximum number of steps of each
ON_TRIAL = 25  # the same of a trial without one cause of a failure
TRIED = 1e-4  # tolerance of a trial
# Relative difference of stress and wish, in the mean over the area, above which the form is not the wish.
MAX_STRESS_ERROR = 0.5
ACCEPTED_STRESS_ERROR = 0.02  # the same, below which a form under constraints stays where no step comes nearer


def prescribed_stress(
    structure: Structure,
    loads: Sequence[FormLoad] = (),
    stress: Mapping[str, Field] | None = None,
    warp: Mapping[str, Directed] | None = None,
    tolerance: float = 1e-6,
    max_iterations: int = 100,
    constraints: Sequence[Constraint] = (),
) -> Form:
    """Find the shape in equilibrium whose stress is nearest to the prestress of the structure, warp unlike weft.

    The wish is given in space: by prestress and warp of the parts, or as functions of place. It is taken anew where
    each cell is. Nearest is the least mean over the area of the squared relative difference; edge cables count as
    strips of membrane as wide as their radius, force over stress. The form is in exact equilibrium with the stress that
    it hands over. `Form.wish` and `Form.differences` say how far that is from the wish, cell by cell.

    Args:
        structure: The first mesh with the supports; the prestress is the wish. The mesh may lie in a plane, with its
            held nodes out of it. Nodes slide to an even mesh, which does not depend on the first one. Masts with a
            force need two held ends.
        loads: Loads that the form balances; all but point loads are per area or length of the form.
        stress: By membrane, its stress as a function of place instead of its prestress: called with the centres of the
            cells, shape (3, cells) [m]. It returns numbers, shape (cells,), pairs along warp and weft, (cells, 2), or
            tensors in that frame, (cells, 2, 2) [N/m].
        warp: By membrane, its warp as a function of place, which returns vectors, shape (3,) or (cells, 3); their
            projection on the cell is the warp. `RadialDirection` is that about an axis, `GeodesicDirection` that along
            geodesics between nodes, traced anew on each shape.
        tolerance: Accepted change of area and of stress in a step, and motion of nodes over the mean edge, each
            relative [-]; the largest is `FormStep.change`. The last steps are Newton's: the change that is left is far
            smaller, and another form finding moves nothing.
        max_iterations: Maximum number of steps.
        constraints: Cables by force, force density, length, sag or angle; nodes that slide; rings and rigid bodies.
            Forces of these cables are no wish: only the stress of membranes and the forces of other cables give way.

    Returns:
        The form. It has converged if it has settled, and the mean relative difference of stress and wish is below 50 %.
        Beside edge cables too weak by the rule of arcs, the difference is below that in each cell, too. A converged
        form need not have the stress of the wish. `Form.remarks` tells differences above 10 % in the mean or 25 % in a
        cell, and their places. For a ring too far from its base it tells those above 1 %, and the reach of the ring.
        It names the wish that would be exact, where it is known.

    Raises:
        ValueError: A stress is not positive; a warp vanishes in a cell or is normal to it; its axis goes through a
            cell; its geodesics end off their membrane; an edge has neither cable nor support; a cable is in
            compression; a part is tied to no held node; the loads do not fit the structure; it has energy terms; a
            constraint does not fit it, or contradicts its supports.
        RuntimeError: The loads grow with the form faster than thousands of times the stress can carry; the first mesh
            has no form.

    Warns:
        UnsettledFormWarning: The form has not converged; it says where and why, as edge cables too weak for their span,
            or loads too large for the stress. The form is the last one in exact equilibrium.

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
        refuse_unfit(structure)
        loads = checked_form_loads(structure, loads)
        tolerance = validation.positive("tolerance", tolerance)
        max_iterations = validation.positive_integer("max_iterations", max_iterations)
        constraints = validation.instances("constraints", constraints, Constraint)
        check_bars(structure)
        wishes = wishes_of(structure, stress, warp)
        balance = _balance(structure, loads, constraints)
    settings: dict[str, Any] = {"loads": loads, "tolerance": tolerance, "max_iterations": max_iterations}
    refuse_different_input(structure, settings | {"constraints": constraints}, {"stress": stress, "warp": warp})
    problem = NearestProblem(structure, loads, wishes, balance=balance)
    pulse = Pulse("form finding", MPI.COMM_WORLD.rank == 0)
    state, steps, failure = _nearest(problem, pulse, tolerance, max_iterations, has_masts(structure, constraints))

    def is_found(other: NearestProblem, at_once: bool) -> bool:
        return _is_found(other, pulse, max(tolerance, TRIED), max_iterations, at_once)

    trial = is_found if balance is None else None
    trouble = reason_of(problem.at(state), state, steps, failure, tolerance, max_iterations, MAX_STRESS_ERROR, trial)
    told = tuple(steps) or (FormStep(state.area, np.inf, state.largest),)  # a shape on the way to the wish
    off = "" if balance is None else balance.targets.off(state.points, state.densities)
    apart = distance(problem, state)
    form = problem.form(state, told, True, (*remarks_of(problem, state), *filter(None, (off, apart))))
    again = partial(prescribed_stress, stress=stress, warp=warp, **settings)
    guide = partial(natural_force_density, loads=loads)
    standing, missing = stand(again, structure, constraints, form, guide=guide, ended=bool(failure))
    if standing is not None:
        return standing
    if balance is None:
        trouble = trouble or fallen_mast(structure, state.points)
    elif missing:
        trouble = f"{balance.motions.turned(state.points) or trouble} {missing}"
    else:
        trouble = trouble or balance.motions.turned(state.points) or failed_mast(structure, balance.motions, form)
    warn_of_doubt(trouble, stacklevel=2)
    return replace(form, converged=not trouble)


def _balance(
    structure: Structure, loads: Sequence[Load], constraints: Sequence[Constraint]
) -> ConstrainedBalance | None:
    """Balance under the constraints, None without any.

    Raises:
        ValueError: Supports or edge cables admit no form; a constraint does not fit.
    """
    if not constraints:
        check_supports_of_form(structure, loads)
        check_edges(structure)
        return None
    balance = ConstrainedBalance(
        structure, loads, constraints, np.eye(3), "force", lambda shape, _: collapse_of(structure, shape)
    )
    check_edges(as_asked(structure, balance).structure)
    return balance


def _nearest(
    problem: NearestProblem, pulse: Pulse, tolerance: float, most: int, masted: bool = False
) -> tuple[State, list[FormStep], str]:
    """Last state, its steps, and the reason for no further one; from a shape near the wish, or by ways of wishes.

    With masts of given length, which the steps lay down, the ways are short: their heads are held next.
    """
    reason, near = "", None
    try:
        near = near_state(problem, pulse)
        found = settled(problem, near, pulse, tolerance, most)
        if not found[2]:
            return found
        if (
            problem.cables is not None and found[0].mean <= ACCEPTED_STRESS_ERROR
        ):  # at rest but for bodies that slide within it
            return found[0], found[1], ""
    except (RuntimeError, ValueError) as trouble:  # the even shape has no limits of this kind
        reason = f"; near it, {str(trouble).rstrip('.')}" if problem.cables is not None else ""
    doubted = masted or has_weak_edges(problem)
    cells = sum(len(block.cells) for block in problem.membranes.values())
    ways = min(WAYS, max(FEWEST, DOUBTED // max(cells, 1))) if doubted else WAYS
    ways = FEWEST if masted or has_far_too_weak_edges(problem) else ways
    start = even_state(problem)
    found = _by_way(problem, start, "an even stress", pulse, tolerance, most, ways)
    if found[2] and near is not None and not (doubted or is_beyond_reach(problem)):
        other = _by_way(problem, problem.at_rest(near), "a stress near it", pulse, tolerance, most, ways)
        found = found if other[2] else other
    return (*found[:2], f"{found[2]}{reason}" if found[2] else "")


def _by_way(
    problem: NearestProblem, start: State, of: str, pulse: Pulse, tolerance: float, most: int, ways: int
) -> tuple[State, list[FormStep], str]:
    """Go from the stress of a start to the wish: last state, its steps, and the reason for no further one.

    Args:
        problem: The problem.
        start: The start, without multipliers.
        of: Words for its stress.
        pulse: Sign of life.
        tolerance: Accepted change in the last steps [-].
        most: Maximum number of these.
        ways: Maximum number of shares tried.
    """
    state, share, length = start, 0.0, WAY
    for _ in range(ways):
        following = min(1.0, share + length)
        pulse(f"{100 * following:.0f} % of the way to the wish, difference of the stress {state.mean:.2e}")
        reached = _reached(problem, start, state, following, pulse, tolerance, most)
        if reached is None:
            length /= 2
            while share + length >= 1:  # the try that has just failed
                length /= 2
            if length < MIN_SHARE:
                break
        elif following == 1:
            return reached
        else:
            state, share, length = reached[0], following, length * LONGER
    words = f"no form is found beyond {int(100 * share)} % of the way from {of} to the wish"
    return problem.measured(*state[:5], 0.0), [], words


def _is_found(problem: NearestProblem, pulse: Pulse, tolerance: float, most: int, at_once: bool) -> bool:
    """Return True if few steps find a form, from a shape near the wish or by the whole search."""
    few = min(most, ON_TRIAL)
    try:
        if at_once:
            state, steps, failure = settled(problem, near_state(problem, pulse), pulse, tolerance, few)
        else:
            state, steps, failure = _nearest(problem, pulse, tolerance, few)
    except (RuntimeError, ValueError):
        return False
    is_near = not failure and state.mean <= MAX_STRESS_ERROR and steps[-1].change <= tolerance
    return is_near and not is_far_at_edges(problem, state, MAX_STRESS_ERROR)


def _reached(
    problem: NearestProblem, start: State, state: State, share: float, pulse: Pulse, tolerance: float, most: int
) -> tuple[State, list[FormStep], str] | None:
    """State at a share of the way from an even stress to the wish; None without one."""
    at = problem if share == 1 else problem.towards(start, share)
    try:
        begun = at.state(state.points, state.multipliers, least=0.0, before=state.densities)
        found = settled(at, begun, pulse, *((tolerance, most) if share == 1 else (WAY_TOLERANCE, ON_WAY)))
    except (RuntimeError, ValueError):
        return None
    return None if found[2] else found
