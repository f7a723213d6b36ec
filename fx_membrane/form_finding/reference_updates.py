"""Form finding with prescribed stress: soap films, and membranes and edge cables of given prestress.

Each step solves for equilibrium with the prestress as 2nd Piola-Kirchhoff stress with respect to the present shape. The
result is the next reference shape. The energy is quadratic: a step is one linear solve, and nodes have a definite place
within the surface. With an isotropic stress it is the algorithm of Pinkall and Polthier for minimal surfaces. The shape
settles in a few steps, while the nodes slide within it for many more; the steps end when only sliding remains.
Equilibrium is exact after each step, with the stress found. That stress differs from the prescribed one by the
remaining sliding, which vanishes in the end. Loads along a line or a surface, such as the weight of a hanging cable,
are an exception: no constant stress balances them.

Distributed loads are per area of the form, which a step finds only by solving. So each step is solved again with the
loads of its result until these no longer change.

Source: K.-U. Bletzinger, E. Ramm, A general finite element approach to the form finding of tensile structures by the
updated reference strategy, Int. J. Space Structures 14 (1999) 131-145; U. Pinkall, K. Polthier, Computing discrete
minimal surfaces and their conjugates, Experimental Mathematics 2 (1993) 15-36.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from mpi4py import MPI

from ..checks import validation
from ..model.digests import of_settings
from ..model.loads import FormLoad, Load, Pressure
from ..model.restraint import check_supports
from ..model.ropes import refuse_ropes
from ..model.stages import Stage
from ..model.structure import Structure
from ..runtime.processes import refuse_differences, together
from ..solvers.progress import Pulse
from .balance.constrained_balance import ConstrainedBalance
from .cell_reference import check_tension
from .constraints.kinds import CableConstraint, Constraint
from .density_steps import ABANDONED, collapse_of_step, natural_steps
from .form import Form, FormStep, refuse_unfit
from .form_loads import checked_form_loads
from .masts.standing_masts import stand
from .plan import place
from .reasons.asked_structure import Asked, as_asked
from .reasons.few_supports import check_supports_of_form
from .reasons.necks import neck
from .reasons.no_form import established
from .reference_steps import Course
from .unsettled_form import UnsettledFormWarning

STRAY = 0.1  # accepted error of the stress where it can settle, relative to the prescribed stress
STRAY_LOADED = 0.5  # the same with loads along lines and surfaces, which no constant stress balances


def updated_reference(
    structure: Structure,
    loads: Sequence[FormLoad] = (),
    tolerance: float = 1e-3,
    max_iterations: int = 100,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    constraints: Sequence[Constraint] = (),
) -> Form:
    """Find the shape in which the prestress of membranes, cables and masts is in equilibrium, without elasticity.

    The length of a mast is not prescribed, but found with its force. A free mast head is found where the forces there
    have an equilibrium near the first shape. Where the steps find none, the heads are searched for, with the rest of
    the form held there; for bars alone, under point loads at most, the balance of their forces is solved. For a mast of
    given place or length hold its head by a support, and add masts and stays by `masts_and_stays`.

    Stress and warp stay with the cells, whose nodes slide for hundreds of steps: with warp unlike weft, and along edge
    cables, stress and area drift on. `prescribed_stress` keeps the mesh even, takes both anew where the cell is, and
    settles. Take it for them, and this function for soap films and masts.

    Args:
        structure: Initial shape with the intended prestress and the supports of the form.
        loads: Loads that the form balances, such as an inner pressure; distributed loads are per area or length of the
            form.
        tolerance: Accepted change of shape in a step, `FormStep.change` [-].
        max_iterations: Maximum number of steps, and of moves of free mast heads in search of their places.
        comm: The processes that share the work.
        constraints: Cables by force, force density, length, sag or angle; nodes that slide; rings and rigid bodies.
            Each step keeps them; for the geometry of cables it takes several linear solves. No place of a free mast
            head is searched for then.

    Returns:
        The form, in equilibrium even if the steps were too few. It has converged if the change of shape fell below the
        tolerance, with an error of the stress below 10 %; below 50 % under loads per area or length or at points, which
        may leave no constant stress. A form with a fallen mast, or with one in tension, has not.

    Raises:
        ValueError: The structure has no prestress at all, or a compressive one in a membrane or a cable; it is not
            supported; the loads do not fit it; it has energy terms; a constraint does not fit it, or contradicts its
            supports.
        RuntimeError: The first step finds no equilibrium, or collapses.

    Warns:
        UnsettledFormWarning: The steps were too few; the form is that of the last one. Or a mast has fallen by more
            than 45 degrees to another balance, or one of given length is in tension. Or a later step collapses, as that
            of a catenoid between rings too far apart; a cable or a mast shrinks to a point or grows without bound; no
            place of a free mast head was found, and the force that is missing there is named; or distributed loads grow
            with the form faster than the prestress can carry. The form is then that of the step before whose stress is
            nearest to the prestress.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> points[:, 2] = points[:, 0] * points[:, 1] + 0.1 * (1 - points[:, 0] ** 2)
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)
        >>> form = updated_reference(Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))]))
        >>> form.steps[-1].area < form.steps[0].area
        True
    """
    validation.communicator("updated_reference comm", comm)
    with together(comm):
        validation.instance("updated_reference structure", structure, Structure)
        refuse_ropes("updated_reference", structure)
        refuse_unfit(structure)
        tolerance = validation.positive("tolerance", tolerance)
        max_iterations = validation.positive_integer("max_iterations", max_iterations)
        stage = Stage("form", checked_form_loads(structure, loads))
        constraints = tuple(validation.instances("constraints", constraints, Constraint))
        if not constraints:
            check_supports_of_form(structure, stage.loads)
            check_supports(structure, structure.supported)
        _check_prestress(structure, any(isinstance(each, CableConstraint) for each in constraints))
    settings = {"loads": stage.loads, "tolerance": tolerance, "max_iterations": max_iterations}
    refuse_differences(comm, lambda: of_settings(settings | {"constraints": constraints}))
    pulse = Pulse("form finding", comm.rank == 0)
    stray = largest_stray(stage.loads)

    def is_settled(step: FormStep) -> bool:
        return step.change <= tolerance and step.stress_error <= stray

    asked = None
    if constraints:
        form, collapse, asked = _constrained(structure, stage, constraints, is_settled, max_iterations, pulse)
        again = partial(updated_reference, loads=loads, tolerance=tolerance, max_iterations=max_iterations, comm=comm)
        standing, missing = stand(again, structure, constraints, form, comm, ended=collapse.startswith(ABANDONED))
        if standing is not None:
            return standing
        collapse = f"{collapse} {missing}".strip()
    else:
        form, collapse = Course(structure, stage, is_settled, max_iterations, pulse, comm).form()
    with together(comm):
        if collapse and comm.rank == 0:
            warnings.warn(collapse, UnsettledFormWarning, stacklevel=2)
        elif not form.converged and comm.rank == 0:
            _warn_of_unsettled_form(structure, form, tolerance, asked)
    return form


def largest_stray(loads: Sequence[Load]) -> float:
    """Accept a difference of the stress from the prescribed one, relative to the latter [-], under loads."""
    return STRAY if all(isinstance(load, Pressure) for load in loads) else STRAY_LOADED


def _constrained(
    structure: Structure,
    stage: Stage,
    constraints: Sequence[Constraint],
    is_settled: Callable[[FormStep], bool],
    most: int,
    pulse: Pulse,
) -> tuple[Form, str, Asked]:
    """Form under constraints, the collapse in words that ended its steps, and what is asked for."""
    for name, part in structure.membranes.items():
        check_tension(name, part, structure.points, part.prestress_tensors())
    balance = ConstrainedBalance(
        structure,
        stage.loads,
        constraints,
        np.eye(3),
        "force",
        lambda points, number: collapse_of_step(structure, points, number, asked),
    )
    asked = as_asked(structure, balance)
    form, collapse = natural_steps(balance, most, is_settled, pulse)
    return replace(form, converged=not collapse and is_settled(form.steps[-1])), collapse, asked


def _warn_of_unsettled_form(structure: Structure, form: Form, tolerance: float, asked: Asked | None) -> None:
    last = form.steps[-1]
    reason = established(structure, structure.points, asked) or neck(structure, form.points)
    remedy = "Allow more steps (max_iterations=...) or a larger tolerance"
    if reason:
        remedy = f"{reason} Change the prestress or the supports, or allow more steps (max_iterations=...)"
    warnings.warn(
        f"The form has not settled: step {len(form.steps)}, the last, changed it by {last.change:.3g} of the length of "
        f"an edge, more than the tolerance {tolerance:g}; its stress is off by {100 * last.stress_error:.3g} % of "
        f"the prescribed one; it is in equilibrium with the stress found. {remedy}; where the change does not fall "
        "from step to step (form.steps), the prestress may have no form.",
        UnsettledFormWarning,
        stacklevel=3,
    )


def _check_prestress(structure: Structure, given: bool) -> None:
    """Refuse compression in membranes and cables, membranes without stress, and, without given forces, no prestress."""
    stresses = {name: part.prestress_tensors() for name, part in structure.parts.items()}
    if not given and not any(stress.any() for stress in stresses.values()):
        raise ValueError("No part has a prestress; form finding needs the stress that the form is to have.")
    for name, part in structure.parts.items():
        least = np.linalg.eigvalsh(stresses[name])[:, 0]
        if not part.is_strut and least.min() < 0:
            cell = int(np.argmin(least))
            where = validation.format_point(structure.points[part.cells[cell]].mean(axis=0))
            raise ValueError(
                f"Part {name!r}, cell {cell}: its prestress is compressive ({least[cell]:g}) at {where}; no form of "
                "fabric or cables holds that, give a tension."
            )
        bare = np.flatnonzero(~stresses[name].any(axis=(1, 2)))
        if name in structure.membranes and len(bare):
            where = place(structure.points, part.cells, bare[0])
            raise ValueError(
                f"Part {name!r}, cell {bare[0]} at {where}: it has no prestress, and its nodes no place without one; "
                "give a tension."
            )
