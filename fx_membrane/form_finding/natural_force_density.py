"""Natural force densities of surfaces: the stress of each cell, given in a first mesh, makes one linear system.

A Cauchy stress S in a cell of the area A is the operator A B^T S B on its nodes, with the gradients B of its shape
functions. Its entries off the diagonal are force densities along the three sides. The shape that balances them, K x =
f, carries the stress F S F^T / J, with the gradient F from the first mesh. That is the stress prescribed as far as F
is a rotation. Taking the shape found for the next mesh comes nearer to it, where it has a form: the updated reference
strategy, whose first step the linear system is.
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
from ..model.parts import Membrane, Part
from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..runtime.processes import together
from ..solvers.progress import Pulse
from .balance.cable_forces import check_bars
from .balance.constrained_balance import ConstrainedBalance
from .balance.membrane_balance import collapse_of, stressed
from .cell_reference import check_tension, reference_of, warp_at
from .constraints.hand_over import handed_over
from .constraints.kinds import Constraint
from .form import Form, FormStep, refuse_terms
from .reasons.no_form import causes
from .reasons.unheld import lone_point
from .same_input import refuse_different_input
from .shape_change import change_of_shape, check_collapse
from .updated_reference import UnsettledFormWarning

Array = NDArray[np.float64]


def natural_force_density(
    structure: Structure,
    loads: Sequence[PointLoad | DistributedLoad | PlanLoad | Pressure] = (),
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
        UnsettledFormWarning: An iteration after the first would collapse; the form is that of the one before it whose
            stress is nearest to the prestress.

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
        refuse_terms(structure)
        stage = Stage("form", validation.instances("loads", loads, PointLoad | DistributedLoad | PlanLoad | Pressure))
        check_stages(structure, [stage])
        iterations = validation.positive_integer("iterations", iterations)
        tolerance = validation.positive("tolerance", tolerance)
        check_bars(structure)
        membranes = {name: part for name, part in structure.parts.items() if isinstance(part, Membrane)}
        for name, part in membranes.items():
            check_tension(name, part, structure.points, part.prestress_tensors())
    settings = {
        "loads": stage.loads,
        "iterations": iterations,
        "tolerance": tolerance,
        "constraints": constraints,
    }
    refuse_different_input(structure, settings, {})

    balance = ConstrainedBalance(
        structure,
        stage.loads,
        constraints,
        np.eye(3),
        "force",
        lambda points, number: _collapse(structure, points, number),
    )
    pulse = Pulse("form finding", MPI.COMM_WORLD.rank == 0)
    form, densities, collapse, steps = None, dict[str, Array](), "", tuple[FormStep, ...]()
    best, error = 0, np.inf
    while not collapse and len(steps) < iterations and not (steps and steps[-1].stress_error <= tolerance):
        pulse(f"iteration {len(steps) + 1}")
        found = _step(balance, structure.points if form is None else form.points, densities, len(steps) + 1)
        if isinstance(found, str):
            collapse = found
        else:
            (form, densities), steps = found, (*steps, *found[0].steps)
            if steps[-1].stress_error < error:
                nearest, best, error = form, len(steps), steps[-1].stress_error
    if form is None:
        raise RuntimeError(f"Form finding has no form after its first iteration: {collapse}")
    lone, words = lone_point(structure, structure.points), ""
    if collapse:
        form, reached, steps = nearest, len(steps), steps[:best]
        words = (
            f"The form is that of iteration {best}, whose stress is nearest to the prestress, in equilibrium with the "
            f"stress it is handed over with; iteration {reached + 1} found none: {collapse}"
        )
    elif lone:
        words = (
            "The form is in equilibrium with the stress it is handed over with, but it depends on the mesh. "
            f"{causes(lone)}"
        )
    if words:
        warnings.warn(words, UnsettledFormWarning, stacklevel=2)
    return replace(form, steps=steps, converged=steps[-1].stress_error <= tolerance and not lone)


def _step(
    balance: ConstrainedBalance, reference: Array, before: dict[str, Array], number: int
) -> tuple[Form, dict[str, Array]] | str:
    """Form of the prestress in a reference shape, with one step; a sentence on its collapse, if it has no other.

    Args:
        balance: The balance of the structure.
        reference: The reference shape, shape (n, 3) [m].
        before: Force densities of the step before, which lines of given geometry start from; empty in the first.
        number: Number of the step, for messages.

    Returns:
        The form and its force densities, or the sentence.
    """
    structure = balance.structure
    membranes = {name: part for name, part in structure.parts.items() if isinstance(part, Membrane)}
    plans = {
        name: reference_of(part.cells, reference, warp_at(name, part, reference), part.prestress_tensors())
        for name, part in membranes.items()
    }
    given = balance.targets.by_force(reference)
    start = balance.targets.mixed(given, before) if before else balance.start(plans)
    found = balance.settled(reference, plans, start, number)
    if isinstance(found, str):
        return found
    points = found.points
    try:
        warps = {name: warp_at(name, part, points) for name, part in membranes.items()}
    except ValueError as upright:
        return str(upright)
    made = stressed(structure, points, plans, found.densities, warps)
    area = float(sum(measures(points, part.cells).sum() for part in membranes.values()))
    change = change_of_shape(structure, reference, points - reference)
    asked: dict[str, Part] = {**structure.parts, **balance.targets.asked(points, found.densities)}
    step = FormStep(area, change, stress_error(asked, made[1]))
    return handed_over(structure, balance.motions, points, made, found.reactions, (step,), True), found.densities


def _collapse(structure: Structure, points: Array, number: int) -> str:
    """Tell of the collapse of a shape in words; empty without one."""
    try:
        check_collapse(structure, points, number)
    except RuntimeError as collapse:
        return str(collapse)
    return collapse_of(structure, points)


def stress_error(parts: Mapping[str, Part], forces: Mapping[str, Array]) -> float:
    """Largest difference of forces from the prestress of parts, over the largest of each part [-]."""
    error = 0.0
    for name, part in parts.items():
        wanted = part.prestress_tensors()
        found = forces[name].reshape(wanted.shape)
        largest = np.abs(np.linalg.eigvalsh(wanted)).max()
        if largest > 0:
            error = max(error, float(np.abs(np.linalg.eigvalsh(found - wanted)).max() / largest))
    return error
