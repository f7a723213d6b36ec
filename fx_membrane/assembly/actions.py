"""Actions on a structure at one instant, and their combinations: supports, loads, prescribed displacements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks.read_only_data import ReadOnlyDict, read_only
from ..model.basins import StandingWater
from ..model.cable_changes import ELASTIC
from ..model.cell_tensors import once
from ..model.energy_terms import Acting, Term
from ..model.gas import Air, Gas
from ..model.ponds import Pond, together
from ..model.ropes import Rope
from ..model.structure import Structure

Array = NDArray[np.float64]


class ActingPond(NamedTuple):
    """A pond, its factor, the height of its rim when it came [m], and the water in its basins.

    Rain has basins, in the first pond on the same cells, whose rim moves. Others have one level, up to that height.
    """

    pond: Pond
    factor: float
    overflow: float
    water: StandingWater | None = None


def pond_of(waters: Sequence[ActingPond]) -> Pond:
    """Pond that stands for those on the same cells, with the drains and walls of all."""
    return together([entry.pond for entry in waters])


@dataclass(frozen=True, eq=False)
class Actions:
    """Actions on a structure at one instant, in the user's order of nodes.

    Attributes:
        loads: Loads of fixed direction on the nodes, shape (n, 3) [N].
        held: Components with a given displacement, shape (n, 3).
        displacement: The given displacements, shape (n, 3) [m]; without meaning at free components.
        pressures: For membranes by name, pressure along `Structure.normals`, shape (cells,) [Pa].
        terms: Energy terms of the stages with their factors, each once; those of the structure always act.
        natural: For parts with a natural shape by name, A of `forms.natural_shape` less the identity, shape (cells, d,
            d) [-]; other parts are without stress, but for the prestress, in the reference shape.
        prestress: Factors of the prestress of the cells, for parts by name, shape (cells,) [-]; 1 for others.
        tensions: By name of cables and ropes of given force: share of the elastic law [-] and force beside it [N],
            shape (cells, 2); (1, 0) for others.
        ponds: Water on membranes, with factors, each pond once.
        gas: Gas in the chambers, by name; others are open, without pressure.
        air: The air around; None if no stage has given it.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> actions = Problem(rope).actions_of(pull)
        >>> actions.loads[1].tolist(), actions.held[0].tolist(), actions.changes_stress
        ([0.0, 0.0, -10.0], [True, True, True], False)
    """

    loads: Array
    held: NDArray[np.bool_]
    displacement: Array
    pressures: Mapping[str, Array] = field(default_factory=dict)
    terms: tuple[Acting, ...] = ()
    natural: Mapping[str, Array] = field(default_factory=dict)
    prestress: Mapping[str, Array] = field(default_factory=dict)
    tensions: Mapping[str, Array] = field(default_factory=dict)
    ponds: tuple[ActingPond, ...] = ()
    gas: Mapping[str, Gas] = field(default_factory=dict)
    air: Air | None = None

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if isinstance(value, Mapping):
                value = ReadOnlyDict({key: read_only(each) for key, each in value.items()})
            object.__setattr__(self, entry.name, read_only(value))

    @property
    def pressed(self) -> bool:
        """True if a pressure acts on a membrane."""
        return any(pressure.any() for pressure in self.pressures.values())

    def less(self, start: Actions) -> Actions:
        """Subtract the actions at a start: the rate of the actions, for a load factor of one from there to here.

        Natural shapes, prestress factors and forces of ropes are those of these actions; gas is left out.
        """
        bare = replace(self, gas={}, air=None)
        rate = _combined(replace(start, gas={}, air=None), bare, lambda a, b: b - a)
        return replace(rate, natural=self.natural, prestress=self.prestress, tensions=self.tensions)

    def without_gas_pressures(self) -> Actions:
        """Return the same actions without pressure in open chambers."""
        gas = {name: replace(gas, value=0.0) if gas.kind == "pressure" else gas for name, gas in self.gas.items()}
        return replace(self, gas=gas)

    @property
    def changes_stress(self) -> bool:
        """True if a part has a natural shape of its own, a factor of its prestress, or a given force."""
        return bool(self.natural or self.prestress or self.tensions)


def unloaded(structure: Structure) -> Actions:
    """Actions of the supports alone."""
    zero = np.zeros(structure.points.shape)
    natural = {name: part.natural_tensors() for name, part in structure.parts.items()}
    return Actions(
        loads=zero,
        held=structure.supported,
        displacement=zero,
        natural={name: less_identity(A) for name, A in natural.items() if less_identity(once(A)).any()},
        tensions={
            name: np.tile([0.0, rope.force], (len(rope.cells), 1))
            for name, rope in structure.parts_of(Rope).items()
            if rope.force is not None
        },
    )


def less_identity(natural: Array) -> Array:
    """Natural shape A less the identity, shape (cells, d, d) [-]."""
    return np.asarray(natural - np.eye(natural.shape[1]))


def with_constraints_of(start: Actions, end: Actions, displacement: Array) -> Actions:
    """Actions at the start of a stage with the constraints of its end; new ones keep their displacement.

    Cables of given force take their natural shape at the end already: it does not matter before they are elastic.
    """
    natural = dict(start.natural)
    for name, tension in start.tensions.items():
        if name in end.natural:
            without = (tension[:, 0] == 0)[:, None, None]
            natural[name] = np.where(without, end.natural[name], start.natural.get(name, 0.0))
    displaced = np.where(start.held, start.displacement, displacement)
    if np.array_equal(displaced, start.displacement):
        displaced = start.displacement  # one array less: eight bytes for each unknown
    return replace(start, held=end.held, displacement=displaced, natural=natural)


def between(start: Actions, end: Actions, factor: float) -> Actions:
    """Actions at a load factor between start and end; arrays that are equal at both are those of the end."""
    return _combined(start, end, lambda a, b: b if np.array_equal(a, b) else a + factor * (b - a))


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
        natural=_joined(start.natural, end.natural, 0.0, combine),
        prestress=_joined(start.prestress, end.prestress, 1.0, combine),
        tensions=_joined(start.tensions, end.tensions, ELASTIC, combine),
        ponds=_joined_ponds(start, end, combine),
        gas=_gas(start.gas, end.gas, combine),
        air=_air(start.air, end.air, combine),
    )


def _joined_ponds(start: Actions, end: Actions, combine: Callable[[Any, Any], Any]) -> tuple[ActingPond, ...]:
    """Combine the ponds of two actions; one that is in one of them only has the factor zero in the other."""
    found = {id(acting.pond): acting for acting in (*start.ponds, *end.ponds)}

    def factor(actions: Actions, pond: Pond) -> float:
        return sum(acting.factor for acting in actions.ponds if acting.pond is pond)

    return tuple(
        acting._replace(factor=combine(factor(start, acting.pond), factor(end, acting.pond)))
        for acting in found.values()
    )


def _gas(start: Mapping[str, Gas], end: Mapping[str, Gas], combine: Callable[[Any, Any], Any]) -> dict[str, Gas]:
    """Combine gas of equal kinds; of other kinds, that at the end counts."""
    return {
        name: replace(gas, value=combine(start[name].value, gas.value))
        if name in start and start[name].kind == gas.kind
        else gas
        for name, gas in end.items()
    }


def _air(start: Air | None, end: Air | None, combine: Callable[[Any, Any], Any]) -> Air | None:
    """Combine the air around; where one is not known, that at the end counts."""
    if start is None or end is None:
        return end
    warm = start.temperature is not None and end.temperature is not None
    temperature = combine(start.temperature, end.temperature) if warm else end.temperature
    return Air(combine(start.pressure, end.pressure), temperature)


def _joined(
    start: Mapping[str, Array], end: Mapping[str, Array], none: float | Array, combine: Callable[[Any, Any], Any]
) -> dict[str, Array]:
    """Combine cell data of parts; those of a part that one of them lacks have the value `none` there."""
    names = dict.fromkeys((*start, *end))
    return {name: np.asarray(combine(start.get(name, none), end.get(name, none))) for name in names}


def factor_of(actions: Actions, term: Term) -> float:
    """Factor of an energy term in actions; 0 if it does not act. Terms are told apart by identity, as loads are."""
    return sum(acting.factor for acting in actions.terms if acting.term is term)
