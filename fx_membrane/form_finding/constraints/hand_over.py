"""Structure of a form: supports, or the bars of a ring, take the forces that constraints of nodes bear."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...checks.values import format_point
from ...model.parts import Part
from ...model.structure import Structure
from ...model.supports import Support
from ..form import Form, FormStep
from ..masts.bar_balance import fallen_mast
from ..reasons.few_supports import all_held
from .motions import Body, Motions

Array = NDArray[np.float64]

AXES = ["x", "y", "z"]
BALANCED_FORCE = 1e-11  # unbalanced force over the largest reaction, that counts as none; the same from 1e-12 to 1e-10


def handed_over(
    structure: Structure,
    motions: Motions,
    points: Array,
    made: tuple[Mapping[str, Part], Mapping[str, Array]],
    reactions: Array,
    steps: tuple[FormStep, ...],
    converged: bool,
) -> Form:
    """Make a form whose structure is in equilibrium as it is.

    A slide along axes becomes a support in its other components; an inclined one, a support in all. Bars without force
    along a ring take the forces that keep it in shape, if they balance them; supports take them otherwise.

    Args:
        structure: The structure at the start.
        motions: Free motions of its nodes.
        points: The shape, shape (n, 3) [m].
        made: Parts with their forces as prestress, and these forces.
        reactions: Forces of supports and constraints, shape (n, 3) [N].
        steps: Steps of the form.
        converged: True if it has the forces asked for.
    """
    parts, forces = dict(made[0]), dict(made[1])
    extra = motions.held & structure.used[:, None] & ~structure.supported
    extra[motions.slides] = True
    largest = np.abs(reactions).max(initial=0.0)
    reactions = reactions.copy()
    for body in motions.bodies:
        free = ~structure.supported[body.nodes]
        borne = np.where(free, reactions[body.nodes], 0.0)
        found = _bars(structure, points, body, borne, BALANCED_FORCE * largest)
        if found is None:
            extra[body.nodes] = True
            continue
        for name, (cells, force) in found.items():
            forces[name] = forces[name].copy()
            forces[name][cells] = force
            parts[name] = replace(parts[name], prestress=forces[name])
            _add_ends(reactions, structure.parts[name].cells[cells], points, force)
        reactions[body.nodes] = np.where(free, 0.0, reactions[body.nodes])
    patterns = np.unique(extra[extra.any(axis=1)], axis=0)
    added = [Support(np.flatnonzero((extra == row).all(axis=1)), "".join(np.array(AXES)[row])) for row in patterns]
    made_of = replace(structure, points=points, parts=parts, supports=[*structure.supports, *added])
    told = [
        words
        for body in motions.bodies
        for words in (body.turned(points), body.grown(points, _has_cable(structure, body, forces)))
    ]
    remarks = (*filter(None, told), *all_held(structure))
    return Form(points, forces, reactions, steps, converged, made_of, remarks=remarks)


def _has_cable(structure: Structure, body: Body, forces: Mapping[str, Array]) -> bool:
    """Return True for a body with a cable in tension along it."""
    return any(
        not part.is_strut and bool((forces[name][np.isin(part.cells, body.nodes).all(axis=1)] > 0).any())
        for name, part in structure.bars.items()
    )


def failed_mast(structure: Structure, motions: Motions, form: Form) -> str:
    """Tell of a mast that has fallen, or that a rigid body keeps in length in tension, in words; empty without one."""
    return fallen_mast(structure, form.points, motions.guided) or _pulled_mast(structure, motions, form)


def _pulled_mast(structure: Structure, motions: Motions, form: Form) -> str:
    least = BALANCED_FORCE * max((float(np.abs(force).max(initial=0.0)) for force in form.forces.values()), default=0.0)
    for body in (each for each in motions.bodies if each.is_line):
        for name, part in structure.parts.items():
            if part.is_strut:
                inside = np.isin(part.cells, body.nodes).all(axis=1) & (part.prestress_tensors().ravel() == 0)
                for cell in np.flatnonzero(inside & (form.forces[name] > least))[:1]:
                    where = format_point(form.points[part.cells[cell]].mean(axis=0))
                    return (
                        f"the mast in cell {cell} of part {name!r}, at {where}, is in tension, with the force "
                        f"{form.forces[name][cell]:.4g}: what meets at its ends pulls them apart. Make it a cable; or "
                        "change the forces that meet there or its place at the start, so that it is pressed."
                    )
    return ""


def _bars(
    structure: Structure, points: Array, body: Body, borne: Array, tolerance: float
) -> dict[str, tuple[NDArray[np.intp], Array]] | None:
    """Find forces of bars without prestress between nodes of a body that balance the forces of its constraint.

    Returns:
        By part, numbers of its cells and their forces [N]; None if they do not balance them, or press a cable.
    """
    if np.abs(borne).max(initial=0.0) <= tolerance:
        return {}
    inside = np.zeros(len(points), dtype=bool)
    inside[body.nodes] = True
    cells = {
        name: np.flatnonzero(inside[part.cells].all(axis=1) & (part.prestress_tensors().ravel() == 0))
        for name, part in structure.bars.items()
    }
    if not any(map(len, cells.values())):
        return None
    ends = np.concatenate([structure.parts[name].cells[numbers] for name, numbers in cells.items()])
    place = np.zeros(len(points), dtype=np.int64)
    place[body.nodes] = np.arange(len(body.nodes))
    pull, each = _pulls(points, ends), np.arange(len(ends))
    system = np.zeros((len(body.nodes), 3, len(ends)))
    system[place[ends[:, 0]], :, each] = pull
    system[place[ends[:, 1]], :, each] = -pull
    free = ~structure.supported[body.nodes]
    force = np.linalg.lstsq(system[free], -borne[free], rcond=None)[0]
    if np.abs(system[free] @ force + borne[free]).max() > tolerance:
        return None
    bounds = np.cumsum([len(numbers) for numbers in cells.values()])[:-1]
    found = dict(zip(cells, zip(cells.values(), np.split(force, bounds), strict=True), strict=True))
    slack = [name for name in found if not structure.parts[name].is_strut and found[name][1].min(initial=0.0) < 0]
    return None if slack else found


def _pulls(points: Array, ends: NDArray[np.int64]) -> Array:
    """Return the forces that bars of the force 1 ask for at their first end, shape (cells, 3) [-]."""
    way = points[ends[:, 0]] - points[ends[:, 1]]
    return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True))


def _add_ends(total: Array, ends: NDArray[np.int64], points: Array, force: Array) -> None:
    """Add what bars of some forces ask for at their ends."""
    pull = force[:, None] * _pulls(points, ends)
    np.add.at(total, ends[:, 0], pull)
    np.add.at(total, ends[:, 1], -pull)
