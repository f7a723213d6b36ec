"""Conversion of a stage to nodal and cell actions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..model.basins import dry, has_basins
from ..model.cable_changes import FixedLength, GivenForce, UnstressedLength, fixed, tensions_after
from ..model.changes import Change, PrestressFactor, natural_after
from ..model.energy_terms import Acting, is_term
from ..model.gas import GasChange, air_after, gas_after
from ..model.loads import PointLoad, Pressure, per_size
from ..model.ponds import Pond, check_together, rim_height
from ..model.stages import Stage
from ..model.structure import Structure
from .acting_ponds import pond_groups, water_of
from .actions import ActingPond, Actions, factor_of, less_identity, pond_of

Array = NDArray[np.float64]


def at_end(
    structure: Structure,
    nodal_loads: Callable[[dict[str, Array]], Array],
    stage: Stage,
    start: Actions,
    shape: Array | None = None,
) -> Actions:
    """Actions at the end of a stage: those at its start plus its own.

    Args:
        structure: The structure.
        nodal_loads: Conversion of loads on cells to forces on nodes.
        stage: The stage.
        start: Actions at its start.
        shape: Displacement at its start, shape (n, 3) [m], in which a `FixedLength` fixes cables; None if it is not
            known yet, so that their length is open.
    """
    loads: list[Any] = [load for load in stage.loads if not (is_term(load) or isinstance(load, Pond))]
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
        on_part = distributed_loads.setdefault(load.part, np.zeros((len(cells), 3)))
        on_part[chosen] += per_size(load, structure.points, cells[chosen])
    held, displacement = prescribed(stage, structure)
    stress = _changed(structure, stage, start, shape)
    return Actions(
        loads=start.loads + point_loads + nodal_loads(distributed_loads),
        held=start.held | held,
        displacement=np.where(held, displacement, start.displacement) if stage.displacements else start.displacement,
        pressures=pressures,
        terms=_with(start, terms),
        **stress._asdict(),
        ponds=_ponds(structure, stage, start, shape),
        **gas_at_end(stage, start),
    )


def gas_at_end(stage: Stage, start: Actions) -> dict[str, Any]:
    """Gas and the air around at the end of a stage, as fields of actions."""
    air = air_after(stage, start.air)
    return {"gas": gas_after(stage, dict(start.gas), start.air, air), "air": air}


class _Stress(NamedTuple):
    """Natural shapes less the identity, prestress factors, and given forces, by part, as in `Actions`."""

    natural: dict[str, Array]
    prestress: dict[str, Array]
    tensions: dict[str, Array]


def _changed(structure: Structure, stage: Stage, start: Actions, shape: Array | None) -> _Stress:
    """Natural shapes, prestress and given forces at the end of a stage."""
    found = _Stress(dict(start.natural), dict(start.prestress), dict(start.tensions))
    for change in stage.changes:
        if isinstance(change, GasChange):
            continue
        name, part = change.part, structure.parts[change.part]
        count, d = len(part.cells), part.dimension
        less, held = found.natural.get(name, np.zeros((count, d, d))), found.tensions.get(name)
        factors = found.prestress.get(name, np.ones(count))
        if isinstance(change, PrestressFactor):
            found.prestress[name] = factors = factors.copy()
            factors[slice(None) if change.cells is None else np.asarray(change.cells)] *= change.factor
            continue
        if isinstance(change, FixedLength) and held is not None and shape is not None:
            after = fixed(structure, change, np.eye(1) + less, held, factors, shape)
            found.natural[name] = less_identity(after)
        found.natural.update(with_change(structure, found.natural, change))
        if isinstance(change, GivenForce) or (held is not None and isinstance(change, FixedLength | UnstressedLength)):
            found.tensions[name] = tensions_after(change, count, held)
    return found


def with_change(structure: Structure, less: Mapping[str, Array], change: Change | GasChange) -> Mapping[str, Array]:
    """Natural shapes after a change, less the identity, by part, shape (cells, d, d) [-].

    Raises:
        ValueError: A cell is inverted by it, or half or twice as large as in the reference shape.
    """
    if isinstance(change, PrestressFactor | GivenForce | FixedLength | GasChange):
        return less
    part = structure.parts[change.part]
    now = np.eye(part.dimension) + less.get(change.part, np.zeros((len(part.cells), part.dimension, part.dimension)))
    return {**less, change.part: less_identity(natural_after(structure, change, now))}


def _ponds(structure: Structure, stage: Stage, start: Actions, shape: Array | None) -> tuple[ActingPond, ...]:
    """Ponds of actions, and those that a stage adds; rain finds its basins in the shape at the start."""
    found = {id(acting.pond): acting for acting in start.ponds}
    for load in stage.loads:
        if isinstance(load, Pond):
            for other in found.values():
                check_together(f"Stage {stage.name!r}", structure, load, other.pond)
            known = found.get(id(load), ActingPond(load, 0.0, rim_height(structure, load, shape)))
            found[id(load)] = known._replace(factor=known.factor + 1.0)
    groups = [
        group
        if water_of(group) or not has_basins([entry.pond for entry in group])
        else (group[0]._replace(water=dry(structure, pond_of(group), shape)), *group[1:])
        for group in pond_groups([*found.values()])
    ]
    return tuple(entry for group in groups for entry in group)


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
