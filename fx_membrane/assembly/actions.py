"""Actions on a structure at one instant, and their combinations: supports, loads, prescribed displacements."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..model.energy_terms import Acting, Term
from ..model.structure import Structure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Actions:
    """Actions on a structure at one instant, in the user's order of nodes.

    Attributes:
        loads: Loads of fixed direction on the nodes, shape (n, 3) [N].
        held: Components with a given displacement, shape (n, 3).
        displacement: The given displacements, shape (n, 3) [m]; without meaning at free components.
        pressures: For membranes by name, pressure along `Structure.normals`, shape (cells,) [Pa].
        terms: Energy terms of the stages with their factors, each once; those of the structure always act.
    """

    loads: Array
    held: NDArray[np.bool_]
    displacement: Array
    pressures: Mapping[str, Array] = field(default_factory=dict)
    terms: tuple[Acting, ...] = ()

    @property
    def pressed(self) -> bool:
        """True if a pressure acts on a membrane."""
        return any(pressure.any() for pressure in self.pressures.values())

    def less(self, start: "Actions") -> "Actions":
        """Subtract the actions at a start: the rate of the actions, for a load factor of one from there to here."""
        return _combined(start, self, lambda a, b: b - a)


def unloaded(structure: Structure) -> Actions:
    """Actions of the supports alone."""
    zero = np.zeros(structure.points.shape)
    return Actions(loads=zero, held=structure.supported, displacement=zero)


def with_constraints_of(start: Actions, end: Actions, displacement: Array) -> Actions:
    """Actions at the start of a stage with the constraints of its end; new ones keep their displacement."""
    return replace(start, held=end.held, displacement=np.where(start.held, start.displacement, displacement))


def between(start: Actions, end: Actions, factor: float) -> Actions:
    """Actions at a load factor between start and end."""
    return _combined(start, end, lambda a, b: a + factor * (b - a))


def _combined(start: Actions, end: Actions, combine: Callable[[Any, Any], Any]) -> Actions:
    """Combine two actions; a pressure or a term that one of them lacks is zero there."""
    pressures = dict(start.pressures) | dict(end.pressures)
    terms = {id(acting.term): acting.term for acting in (*start.terms, *end.terms)}

    def pressure(actions: Actions, name: str) -> Array:
        return actions.pressures.get(name, np.zeros_like(pressures[name]))

    return Actions(
        loads=combine(start.loads, end.loads),
        held=end.held,
        displacement=combine(start.displacement, end.displacement),
        pressures={name: combine(pressure(start, name), pressure(end, name)) for name in pressures},
        terms=tuple(Acting(term, combine(factor_of(start, term), factor_of(end, term))) for term in terms.values()),
    )


def factor_of(actions: Actions, term: Term) -> float:
    """Factor of an energy term in actions; 0 if it does not act. Terms are told apart by identity, as loads are."""
    return sum(acting.factor for acting in actions.terms if acting.term is term)
