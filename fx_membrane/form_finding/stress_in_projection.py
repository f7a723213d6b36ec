"""Form finding with stress given in projection: membrane stress in plan, cables by their force in plan.

The stress in plan is the 2nd Piola-Kirchhoff stress with respect to the plan. It turns a cell into the linear operator
A B^T N B, with its plan area A, gradients B in plan and stress N. A bar has its force density. The sum K of all acts on
the three coordinates alike, K x = f, and is positive definite for positive stress. The stress in the shape, F N F^T / J
with the gradient F from the plan into space, balances the loads at each node exactly.

A constant stress with edge cables along funicular curves balances in plan: the plan stays, and carries the stress
prescribed. Elsewhere the nodes move in plan, and the stress in plan changes with them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.calls import unfit
from ..geometry.sizes import measures
from ..model.loads import FormLoad
from ..model.parts import Membrane
from ..model.structure import Structure
from ..runtime.processes import together
from ..solvers.progress import Pulse
from .balance.cable_forces import MEASURES, check_bars, difference
from .balance.constrained_balance import ConstrainedBalance, shortfall
from .balance.edge_balance import with_balanced_forces
from .balance.membrane_balance import collapse_of, stressed
from .constraints.cable_targets import TARGET_ERROR
from .constraints.hand_over import failed_mast, handed_over
from .constraints.kinds import Constraint
from .form import Form, FormStep, refuse_unfit
from .form_loads import checked_form_loads
from .masts.standing_masts import stand
from .plan import Field, Plan, place, plan_of
from .reasons.plan_reasons import reasons_in_plan
from .reference_updates import STRAY
from .same_input import refuse_different_input
from .shape_change import change_of_shape
from .unsettled_form import warn_of_doubt

Array = NDArray[np.float64]

BALANCED_WORDS = "balanced force"  # a horizontal force that varies along a cable


def projected_stress(
    structure: Structure,
    loads: Sequence[FormLoad] = (),
    stress: Mapping[str, Field] | None = None,
    cables: str = "horizontal force",
    direction: ArrayLike = (0.0, 0.0, 1.0),
    tolerance: float = 1e-3,
    max_iterations: int = 100,
    constraints: Sequence[Constraint] = (),
) -> Form:
    """Find the shape whose stress, projected on a plan, is the prestress of the structure.

    Membrane stress and force densities make one linear system, which has a result for any positive stress. Cables given
    by force take further steps, each a linear solve. Every step is in exact equilibrium with the stress that it hands
    over. The heights of free nodes do not matter; their places in plan are the mesh of the plan.

    The nodes rest in plan if the stress balances there: a constant one with edge cables along their arcs, or with
    (r n_radial)' = n_tangential about an axis. Else they move in plan, which changes the stress there:
    `FormStep.stress_error`. A start from `dataclasses.replace(structure, points=form.points)` comes nearer. To keep a
    plan whose stress does not balance, hold its nodes by `Support(nodes, "xy")`: only heights are found then, and the
    reactions of these nodes are the missing balance.

    Args:
        structure: The mesh in plan, and the held nodes in space. The prestress of a membrane is its stress in plan,
            force per length of the plan [N/m]; warp is a vector whose projection on the plan is the warp direction
            there. That of the form is the same thread in space. Masts with a force need two held ends.
        loads: Loads that the form balances; all but point loads are per area or length of the form.
        stress: By membrane, its stress in plan as a function of place instead of its prestress: called with the
            centres of the cells in space, shape (3, cells) [m]. It returns numbers, shape (cells,), pairs along warp
            and weft, (cells, 2), or tensors in that frame, (cells, 2, 2) [N/m]. About an axis, let warp be radial.
        cables: Meaning of the prestress of cables: "horizontal force", in projection on the plan [N]; "balanced force",
            the mean of a horizontal force that varies along each line as the stress pulls along it; "force" [N]; or
            "force density", ratio of force to length [N/m]. Unequal stress at a curved edge asks for a balanced force:
            the force T of radius R balances T / R across the edge and dT/ds along it.
        direction: Normal of the plan, shape (3,), any length.
        tolerance: Accepted relative difference of cable forces from the prescribed ones [-].
        max_iterations: Maximum number of steps towards the cable forces; 1 is a single linear solve.
        constraints: Cables by force, force density, length, sag or angle; nodes that slide; rings and rigid bodies.

    Returns:
        The form. It has converged if cable forces are within the tolerance, stress in plan within 10 %, and the plan
        has no fold.

    Raises:
        ValueError: The stress of a membrane is not positive, or that of a cable compressive; the balanced force of a
            cable is no tension somewhere; a cell has no area in plan, or the plan folds over itself; a warp vanishes in
            plan; a cable has no length in plan; a part is tied to no held node in some component; stresses differ too
            much for the number of digits; the loads do not fit the structure; it has energy terms; a constraint does
            not fit it, or contradicts its supports.
        RuntimeError: The loads grow with the form faster than the stress can carry; in the first step a cell shrinks to
            nothing, or a cable of given horizontal force becomes upright.

    Warns:
        UnsettledFormWarning: The form has not converged; it says in which respect, and where. Where the next step would
            collapse, the form is the last one before it.

    Source:
        R. M. O. Pauletti, P. M. Pimenta, The natural force density method for the shape finding of taut structures,
        Computer Methods in Applied Mechanics and Engineering 197 (2008) 4419-4428; A. Pucher, Über den Spannungszustand
        in gekrümmten Flächen, Beton und Eisen 33 (1934) 298-304, for the equilibrium of stress in projection.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> rim = np.unique(boundary_edges(triangles))
        >>> points[rim, 2] = points[rim, 0] * points[rim, 1]
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), prestress=(3e3, 2e3), warp=(1, 0, 0))
        >>> form = projected_stress(Structure(points, {"film": film}, [Support(rim)]))
        >>> bool(np.allclose(form.points[:, 2], points[:, 0] * points[:, 1]))
        True

        About the z axis, radial and tangential stress that balance in plan:

        >>> def about_axis(x):
        ...     r = np.hypot(x[0], x[1])
        ...     return np.stack([1e3 / r + 2e3, np.full_like(r, 2e3)], axis=1)
        >>> radial = points[triangles].mean(axis=1) * [1, 1, 0]
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), warp=radial)
        >>> form = projected_stress(Structure(points, {"film": film}, [Support(rim)]), stress={"film": about_axis})
        >>> form.steps[-1].stress_error < 0.1
        True
    """
    with together(MPI.COMM_WORLD):
        validation.instance("projected_stress structure", structure, Structure)
        refuse_unfit(structure)
        loads = checked_form_loads(structure, loads)
        fields = _checked_fields(structure, stress)
        validation.choice("cables", cables, (*MEASURES, BALANCED_WORDS), f"one of {[*MEASURES, BALANCED_WORDS]}")
        axes = _axes(validation.direction("direction", direction))
        tolerance = validation.positive("tolerance", tolerance)
        max_iterations = validation.positive_integer("max_iterations", max_iterations)
        check_bars(structure)
    settings: dict[str, Any] = {"loads": loads, "cables": cables, "direction": direction}
    settings |= {"tolerance": tolerance, "max_iterations": max_iterations}
    refuse_different_input(structure, settings | {"constraints": constraints}, {"stress": fields})
    membranes = structure.parts_of(Membrane)
    plans = {name: plan_of(name, part, structure.points, axes, fields.get(name)) for name, part in membranes.items()}
    asked, measure = _measured(structure, plans, axes, cables)
    balance = ConstrainedBalance(
        asked, loads, constraints, axes, measure, lambda shape, _: collapse_of(structure, shape)
    )
    found = _settled(balance, plans, axes, tolerance, max_iterations)
    problem = found.problem or _motion(plans, found.points, axes)
    targets = balance.targets
    given = targets.by_density(structure.points)
    problem = reasons_in_plan(structure, plans, axes, found.first, given, targets.kinds, problem, bool(constraints))
    made = stressed(structure, found.points, plans, found.densities)
    form = handed_over(structure, balance.motions, found.points, made, found.reactions, found.steps, True)
    again = partial(projected_stress, stress=stress, **settings)
    standing, missing = stand(again, structure, constraints, form, ended=bool(found.problem))
    if standing is not None:
        return standing
    turned = balance.motions.turned(found.points)
    problem = failed_mast(structure, balance.motions, form) or (missing and turned) or problem or turned
    problem = f"{problem} {missing}".strip()
    warn_of_doubt(problem, stacklevel=2)
    return replace(form, converged=not problem)


class _Settled(NamedTuple):
    """Shape after the steps towards the forces of cables: points, reactions, force densities, the first of these."""

    points: Array
    reactions: Array
    densities: dict[str, Array]
    first: dict[str, Array]
    steps: tuple[FormStep, ...]
    problem: str


def _settled(
    balance: ConstrainedBalance, plans: Mapping[str, Plan], axes: Array, tolerance: float, max_iterations: int
) -> _Settled:
    """Iterate until the forces of cables are those asked for; else say in words why the steps end."""
    pulse = Pulse("form finding", MPI.COMM_WORLD.rank == 0)
    points, reactions, error, stray, steps = balance.structure.points, np.zeros(0), np.inf, np.inf, list[FormStep]()
    first = balance.start(plans)
    densities, following, kept = dict[str, Array](), first, None
    collapse, accelerated, miss, fold = "", balance.acceleration(), np.inf, ""
    while (error > tolerance or miss > TARGET_ERROR) and len(steps) < max_iterations:
        pulse(f"step {len(steps) + 1} towards the forces of cables")
        found = balance(points, plans, following, len(steps) + 1)
        if isinstance(found, str):
            collapse = found
            break
        before, points, reactions, densities = points, found.points, found.reactions, following
        (miss, words), error = (
            balance.targets.miss(points, densities, found.wanted),
            difference(densities, found.wanted),
        )
        following = accelerated(densities, found.wanted)
        stray = max([_stray(plan, points @ axes[:, :2]).max() for plan in plans.values()], default=0.0)
        area = float(sum(measures(points, plan.cells).sum() for plan in plans.values()))
        change = change_of_shape(balance.structure, before, points - before)
        steps.append(FormStep(float(area), float(change), float(max(error, stray))))
        fold = _fold(plans, points, axes)
        kept = (points, reactions, densities, len(steps)) if not fold else kept
    if not steps:
        raise RuntimeError(f"Form finding has no form after its first step: {collapse}")
    if fold and kept is not None:
        points, reactions, densities, count = kept
        fold, steps = f"it is that of step {count}, and in later ones {fold}", steps[:count]
    problem = collapse or fold or shortfall(error, tolerance, len(steps), miss, words)
    return _Settled(points, reactions, densities, first, tuple(steps), problem)


def _axes(normal: Array) -> Array:
    """Axes of the plan and its normal as columns, right-handed, shape (3, 3); x, y and z for the normal z."""
    first = np.eye(3)[0 if abs(normal[0]) < 0.9 else 1]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(normal, first), normal], axis=1)


def _measured(structure: Structure, plans: Mapping[str, Plan], axes: Array, cables: str) -> tuple[Structure, str]:
    """Structure with the force of each cell of its cables, and their meaning, one of `MEASURES`."""
    if cables != BALANCED_WORDS:
        return structure, cables
    return with_balanced_forces(structure, plans, axes), "horizontal force"


def _checked_fields(structure: Structure, stress: Any) -> dict[str, Field]:
    validation.instance("stress", stress, Mapping | None)
    fields = dict(stress or {})
    for name, field in fields.items():
        if not isinstance(name, str) or name not in structure.parts_of(Membrane):
            raise ValueError(f"stress names {validation.short_repr(name)}, which is no membrane of the structure.")
        if shown := unfit(field, 1):
            raise ValueError(
                f"stress of part {name!r} is {shown}; give a function of place, or the number "
                "as the prestress of the part."
            )
    return fields


def _stray(plan: Plan, flat: Array) -> Array:
    """Difference of the stress in the plan of a shape from the prescribed one, over its largest, shape (cells,) [-]."""
    gradient = plan.deformation(flat)
    ratio = np.maximum(np.abs(np.linalg.det(gradient)), np.finfo(float).eps)
    stress = gradient @ plan.stress @ gradient.swapaxes(1, 2) / ratio[:, None, None]
    difference = np.abs(np.linalg.eigvalsh(stress - plan.stress)).max(axis=1)
    return np.asarray(difference / np.linalg.eigvalsh(plan.stress).max())


def _fold(plans: Mapping[str, Plan], points: Array, axes: Array) -> str:
    """Tell of a cell that a shape has turned over in plan, in words; empty without one."""
    for name, plan in plans.items():
        turned = np.flatnonzero(np.linalg.det(plan.deformation(points @ axes[:, :2])) <= 0)
        if len(turned):
            return (
                f"part {name!r} folds over itself in plan at cell {turned[0]}, {place(points, plan.cells, turned[0])}: "
                "edge cables there are too weak for the stress of the membrane, or the stress does not balance in "
                "plan; give larger forces to the cables, or hold nodes."
            )
    return ""


def _motion(plans: Mapping[str, Plan], points: Array, axes: Array) -> str:
    """Tell of a cell whose stress in plan has left the prescribed one, in words; empty if it is near."""
    for name, plan in plans.items():
        stray = _stray(plan, points @ axes[:, :2])
        cell = int(stray.argmax())
        if stray[cell] > STRAY:
            return (
                f"nodes of part {name!r} have moved in plan; its stress there is off by {100 * stray[cell]:.3g} % "
                f"of the largest prescribed, in cell {cell} at {place(points, plan.cells, cell)}: it does not balance "
                "in the plan given."
            )
    return ""
