"""Steps with natural force densities: the prescribed stress in the shape before, under constraints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..geometry.sizes import measures
from ..model.parts import Part
from ..model.structure import Structure
from ..solvers.progress import Pulse
from .after_collapse import MAX_SHAPES, last_good
from .balance.constrained_balance import ConstrainedBalance, continued
from .balance.membrane_balance import collapse_of, stressed
from .cell_reference import reference_of, warp_at
from .constraints.hand_over import failed_mast, handed_over
from .form import Form, FormStep
from .reasons.asked_structure import Asked, as_asked
from .reasons.no_form import established
from .shape_change import STOPPED, change_of_shape, check_collapse

Array = NDArray[np.float64]

ABANDONED = "The form is that of step"
LOST_STRESS = 1.0  # difference of the stress over the prestress, above which cells may be too slender for its digits


def natural_steps(
    balance: ConstrainedBalance, most: int, is_met: Callable[[FormStep], bool], pulse: Pulse
) -> tuple[Form, str]:
    """Form after steps from shape to shape, and what ended or spoilt them, in words; empty without fault.

    After a collapse the form is that of the step whose stress is nearest to the prestress, see `last_good`.

    Args:
        balance: The balance of the structure.
        most: Maximum number of steps.
        is_met: Tells of a step if it is the last.
        pulse: Told the number of each step.

    Raises:
        ValueError, RuntimeError: The first step has no form.
    """
    form: Form | None = None
    nearest = list[Form]()
    densities, steps = dict[str, Array](), tuple[FormStep, ...]()
    while len(steps) < most and not (steps and is_met(steps[-1])):
        number = len(steps) + 1
        pulse(f"step {number}")
        try:
            found = natural_step(balance, balance.structure.points if form is None else form.points, densities, number)
        except RuntimeError as grown:
            raise RuntimeError(f"{grown} {_reason(balance)}".strip()) from grown
        if isinstance(found, str):
            if form is None:
                raise RuntimeError(f"Form finding has no form after its first step: {found}")
            told = (
                found if found.startswith(STOPPED) else f"Step {number} found none: {found} {_reason(balance)}".strip()
            )
            made = [each.structure for each in nearest]
            good = nearest[last_good(made, balance.loads, MPI.COMM_SELF)]
            return good, " ".join([abandoned(len(good.steps), told), *form.remarks])
        (form, densities), steps = found, (*steps, *found[0].steps)
        form = replace(form, steps=steps)
        nearest = sorted([*nearest, form], key=lambda each: each.steps[-1].stress_error)[:MAX_SHAPES]
    assert form is not None
    if form.steps[-1].stress_error > LOST_STRESS:
        shapes = [form, *nearest]
        good = shapes[last_good([each.structure for each in shapes], balance.loads, MPI.COMM_SELF)]
        if good is not form:
            told = f"Step {len(steps)} found one of slender cells, whose stress has lost its digits. {_reason(balance)}"
            return good, " ".join([abandoned(len(good.steps), told.strip()), *form.remarks])
    trouble = balance.motions.turned(form.points) or failed_mast(balance.structure, balance.motions, form)
    return form, f"The form is in equilibrium, but {continued(trouble)}" if trouble else ""


def _reason(balance: ConstrainedBalance) -> str:
    """Sentences on what rules tell of the first shape; empty without."""
    structure = balance.structure
    return established(structure, structure.points, as_asked(structure, balance))


def abandoned(kept: int, collapse: str) -> str:
    """Tell which step the form is of, after the collapse of a later one."""
    return (
        f"{ABANDONED} {kept}, whose stress is nearest to the prestress among the last at rest, in equilibrium with "
        f"the stress that it carries; the steps after it lead to none. {collapse}"
    )


def natural_step(
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
    membranes = structure.membranes
    plans = {
        name: reference_of(part.cells, reference, warp_at(name, part, reference), part.prestress_tensors())
        for name, part in membranes.items()
    }
    given = balance.targets.by_force(reference)
    start = balance.targets.mixed(given, before) if before else balance.start(plans)
    found = balance.settled(reference, plans, start, number, bool(balance.targets.given))
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
    form = handed_over(structure, balance.motions, points, made, found.reactions, (step,), True)
    off = balance.targets.off(points, found.densities)
    return replace(form, wish=wish_of(asked), remarks=(*form.remarks, *([off] if off else []))), found.densities


def collapse_of_step(structure: Structure, points: Array, number: int, asked: Asked | None = None) -> str:
    """Tell of the collapse of a shape in words; empty without one. See `check_collapse`."""
    try:
        check_collapse(structure, points, number, asked)
    except RuntimeError as collapse:
        return str(collapse)
    return collapse_of(structure, points)


def wish_of(parts: Mapping[str, Part]) -> dict[str, Array]:
    """Prestress of parts as the wish of a form: tensors of membranes, shape (cells, 2, 2), and forces, (cells,)."""
    return {name: part.prestress_values() for name, part in parts.items()}


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
