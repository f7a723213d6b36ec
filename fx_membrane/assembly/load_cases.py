"""Conversion of a stage to nodal and cell actions."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.measures import normals
from ..model.energy_terms import Acting, is_term
from ..model.loads import PlanLoad, PointLoad, Pressure
from ..model.stages import Stage
from ..model.structure import Structure
from .actions import Actions, factor_of

Array = NDArray[np.float64]


def at_end(
    structure: Structure, nodal_loads: Callable[[dict[str, Array]], Array], stage: Stage, start: Actions
) -> Actions:
    """Actions at the end of a stage: those at its start plus its own.

    Args:
        structure: The structure.
        nodal_loads: Conversion of loads on cells to forces on nodes.
        stage: The stage.
        start: Actions at its start.
    """
    loads: list[Any] = [load for load in stage.loads if not is_term(load)]
    terms = [load for load in stage.loads if is_term(load)]
    point_loads = np.zeros(structure.points.shape)
    distributed_loads: dict[str, Array] = {}
    pressures = {name: pressure.copy() for name, pressure in start.pressures.items()}
    for load in loads:
        if isinstance(load, PointLoad):
            point_loads[np.asarray(load.nodes)] += np.asarray(load.force)
            continue
        cells = structure.parts[load.part].cells
        chosen = np.arange(len(cells)) if load.cells is None else np.asarray(load.cells)
        if isinstance(load, Pressure):
            on_cells = pressures.setdefault(load.part, np.zeros(len(cells)))
            on_cells[chosen] += load.pressure
            continue
        per_area = np.broadcast_to(np.asarray(load.load), (len(chosen), 3))
        if isinstance(load, PlanLoad):
            per_area = per_area * np.abs(normals(structure.points, cells)[chosen, 2:])
        distributed_loads.setdefault(load.part, np.zeros((len(cells), 3)))[chosen] += per_area
    held, displacement = prescribed(stage, structure)
    return Actions(
        loads=start.loads + point_loads + nodal_loads(distributed_loads),
        held=start.held | held,
        displacement=np.where(held, displacement, start.displacement),
        pressures=pressures,
        terms=_with(start, terms),
    )


def _with(start: Actions, terms: Sequence[Any]) -> tuple[Acting, ...]:
    """Energy terms of actions, and those that a stage adds; one that is there already acts twice."""
    factors = {id(term): Acting(term, factor_of(start, term)) for term in [*(a.term for a in start.terms), *terms]}
    for term in terms:
        factors[id(term)] = Acting(term, factors[id(term)].factor + 1.0)
    return tuple(factors.values())


def prescribed(stage: Stage, structure: Structure) -> tuple[NDArray[np.bool_], Array]:
    """Components that a stage prescribes, shape (n, 3), and their displacements, shape (n, 3) [m].

    Raises:
        ValueError: A component is held by a support or prescribed twice, with another value.
    """
    held = structure.supported
    mine = np.zeros_like(held)
    displacement = np.zeros(structure.points.shape)
    for entry in stage.displacements:
        nodes, value = np.asarray(entry.nodes), np.asarray(entry.displacement)
        for component in validation.components("PrescribedDisplacement components", entry.components):
            wanted = np.broadcast_to(value[..., component], nodes.shape)
            free = ~(held | mine)[nodes, component]
            displacement[nodes[free], component] = wanted[free]
            clash = np.flatnonzero(displacement[nodes, component] != wanted)
            if len(clash):
                raise ValueError(
                    f"Stage {stage.name!r} moves node {nodes[clash[0]]} by {wanted[clash[0]]:g} along "
                    f"{'xyz'[component]}, where it is already held at {displacement[nodes[clash[0]], component]:g}; "
                    "remove the support or the prescribed displacement."
                )
            mine[nodes, component] = True
    return mine, displacement
