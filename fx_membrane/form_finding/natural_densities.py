"""Natural force densities of surfaces: the stress of each cell, given in a first mesh, makes one linear system.

A Cauchy stress S in a cell of the area A is the operator A B^T S B on its nodes. B has the gradients of its shape
functions. Its entries off the diagonal are force densities along the three sides. The shape that balances them, K x =
f, carries the stress F S F^T / J, with the gradient F from the first mesh. That is the stress prescribed as far as F is
a rotation. Taking the shape found for the next mesh comes nearer to it, where it has a form: the updated reference
strategy, whose first step the linear system is.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..checks import validation
from ..checks.values import counted
from ..model.loads import FormLoad
from ..model.structure import Structure
from ..runtime.processes import together
from ..solvers.progress import Pulse
from .balance.cable_forces import check_bars
from .balance.constrained_balance import ConstrainedBalance
from .cell_reference import check_tension
from .constraints.kinds import Constraint
from .density_steps import ABANDONED, collapse_of_step, natural_steps
from .form import Form, refuse_unfit
from .form_loads import checked_form_loads
from .masts.standing_masts import stand
from .plan import place
from .reasons.asked_structure import as_asked
from .reasons.no_form import causes, established
from .reasons.unheld import lone_point
from .reference_updates import largest_stray
from .same_input import refuse_different_input
from .unsettled_form import UnsettledFormWarning

Array = NDArray[np.float64]


def natural_force_density(
    structure: Structure,
    loads: Sequence[FormLoad] = (),
    iterations: int = 1,
    tolerance: float = 1e-3,
    constraints: Sequence[Constraint] = (),
) -> Form:
    """Find the shape whose stress, pulled back to the mesh given, is the prestress of the structure.

    One linear solve, which has a result for any positive stress. The form is in exact equilibrium with the stress that
    it hands over; this differs from the prestress by the stretch from the first mesh: `FormStep.stress_error`.

    The number of iterations says how far to go. One keeps the mesh even, and a mesh near the form gives a stress near
    the prestress. Each further one prescribes the Cauchy stress in the shape found so far. A few come near to it; many
    settle only if a surface with that stress exists, as a soap film. Else nodes slide and cells degenerate: take
    `prescribed_stress`, which holds the mesh and finds the nearest stress, or `projected_stress`, with stress in plan.

    Args:
        structure: The first mesh, near to the form, with the intended prestress and the supports. A membrane may lie
            in a plane at the start, with its held nodes out of it. The warp is projected on the cells of each shape.
            Masts with a force need two held ends.
        loads: Loads that the form balances; all but point loads are per area or length of the form.
        iterations: Maximum number of linear solves.
        tolerance: Accepted `FormStep.stress_error`, at which the iterations end [-].
        constraints: Cables by force, force density, length, sag or angle; nodes that slide; rings and rigid bodies.
            Each iteration keeps them; for the geometry of cables it takes several linear solves.

    Returns:
        The form. It has converged if the stress is within the tolerance of the prestress.

    Raises:
        ValueError: The stress of a membrane is not positive, or that of a cable compressive; a part is tied to no held
            node in some component; stresses differ too much for the number of digits; the loads do not fit the
            structure; it has energy terms; a constraint does not fit it, or contradicts its supports.
        RuntimeError: The loads grow with the form faster than the stress can carry; in the first iteration a cell
            shrinks to nothing, or the warp becomes normal to it.

    Warns:
        UnsettledFormWarning: The stress is off by more than the tolerance; it says where. Above 10 %, or 50 % under
            loads other than pressure, it names edge cables too weak or a ring too far. `Form.differences` has all. Or
            an iteration after the first would collapse; the form is that of the one before it whose stress is nearest
            to the prestress.

    Source:
        R. M. O. Pauletti, P. M. Pimenta, The natural force density method for the shape finding of taut structures,
        Computer Methods in Applied Mechanics and Engineering 197 (2008) 4419-4428.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> points[:, 2] = points[:, 0] * points[:, 1] + 0.1 * (1 - points[:, 0] ** 2)
        >>> film = Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)
        >>> sail = Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))])
        >>> errors = [step.stress_error for step in natural_force_density(sail, iterations=5).steps]
        >>> errors[-1] < errors[0]
        True
    """
    with together(MPI.COMM_WORLD):
        validation.instance("natural_force_density structure", structure, Structure)
        refuse_unfit(structure)
        loads = checked_form_loads(structure, loads)
        iterations = validation.positive_integer("iterations", iterations)
        tolerance = validation.positive("tolerance", tolerance)
        check_bars(structure)
        membranes = structure.membranes
        for name, part in membranes.items():
            check_tension(name, part, structure.points, part.prestress_tensors())
    settings = {"loads": loads, "iterations": iterations, "tolerance": tolerance, "constraints": constraints}
    refuse_different_input(structure, settings, {})

    balance = ConstrainedBalance(
        structure,
        loads,
        constraints,
        np.eye(3),
        "force",
        lambda points, number: collapse_of_step(structure, points, number, asked),
    )
    asked = as_asked(structure, balance)
    pulse = Pulse("form finding", MPI.COMM_WORLD.rank == 0)
    form, collapse = natural_steps(balance, iterations, lambda step: step.stress_error <= tolerance, pulse)
    again = partial(natural_force_density, loads=loads, iterations=iterations, tolerance=tolerance)
    standing, missing = stand(again, structure, constraints, form, ended=collapse.startswith(ABANDONED))
    if standing is not None:
        return standing
    collapse = f"{collapse} {missing}".strip()
    lone = lone_point(asked.structure, structure.points)
    form = replace(form, converged=not (collapse or lone) and form.steps[-1].stress_error <= tolerance)
    if lone and not collapse:
        collapse = (
            f"The form is in equilibrium with the stress that it carries, but it depends on the mesh. {causes(lone)}"
        )
    if not form.converged:
        far = not collapse and form.steps[-1].stress_error > largest_stray(loads)
        reason = established(structure, structure.points, asked) if far else ""
        warnings.warn(collapse or f"{_off(form)} {reason}".strip(), UnsettledFormWarning, stacklevel=2)
    return form


def _off(form: Form) -> str:
    """Tell how far the stress of a form is from the prestress, and where."""
    differences = {name: each for name, each in form.differences.items() if len(each)}
    name = max(differences, key=lambda each: float(differences[each].max()))
    cell, count = int(differences[name].argmax()), len(form.steps)
    where = place(form.points, form.structure.parts[name].cells, cell)
    return (
        f"The form is in equilibrium with its stress, but after {counted(count, 'iteration')} that is "
        f"off by {100 * form.steps[-1].stress_error:.3g} % of the largest prescribed. The largest relative "
        f"difference is {100 * differences[name][cell]:.3g} %, in part {name!r}, cell {cell} at {where}; "
        "form.differences has all. Allow more iterations (iterations=...), start nearer to the form, or take "
        "prescribed_stress, whose stress is nearest to the prestress."
    )
