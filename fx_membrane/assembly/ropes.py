"""Ropes: the tension of each from its length, its change with actions, and its parameters."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures
from ..model.cable_changes import stretch_of
from ..model.parts import Part
from ..model.ropes import Rope
from ..model.structure import Structure
from .actions import Actions

Array = NDArray[np.float64]


class RopeData(NamedTuple):
    """Numbers of a rope under actions.

    Attributes:
        reference: Length in the reference shape [m].
        natural: Unstressed length [m].
        prestress: Prestress [N].
        share: Share of the elastic law: 1, or 0 for a rope of given force [-].
        force: Given force beside it [N].
    """

    reference: float
    natural: float
    prestress: float
    share: float
    force: float


class RopeState(NamedTuple):
    """State of a rope.

    Attributes:
        data: Its numbers.
        length: Current length [m].
        strain: Green-Lagrange strain with respect to the unstressed length [-].
        energy: Energy [J].
        tension: Derivative of the energy by the length [N].
        stiffness: Derivative of the tension by the length [N/m].
        kept: Fraction of the elastic force in effect: 1, or the compression stiffness if it is slack [-].
    """

    data: RopeData
    length: float
    strain: float
    energy: float
    tension: float
    stiffness: float
    kept: float

    @property
    def slack(self) -> bool:
        """True if it has neither tension nor a given force."""
        return self.kept < 1 and self.data.force == 0


def rope_data(structure: Structure, actions: Actions, elastic: bool) -> dict[str, RopeData]:
    """Numbers of all ropes under actions, by part; without elasticity the prestress is their force."""
    found = {}
    for name, rope in structure.parts_of(Rope).items():
        lengths = measures(structure.points, rope.cells)
        factors = actions.prestress.get(name, np.ones(len(lengths)))
        prestress = rope.tension * float(factors @ lengths / lengths.sum())
        natural = float(lengths.sum() + lengths @ actions.natural[name][:, 0, 0]) if name in actions.natural else None
        share, force = actions.tensions[name][0] if name in actions.tensions else (1.0, 0.0)
        data = RopeData(float(lengths.sum()), natural or float(lengths.sum()), prestress, float(share), float(force))
        found[name] = data if elastic else data._replace(share=0.0, force=prestress)
    return found


def rope_state(rope: Rope, data: RopeData, elongation: float, kept: float) -> RopeState:
    """State of a rope of an elongation.

    The energy per unstressed length is that of Saint Venant-Kirchhoff, Gil (40), and relaxed as in `forms.wrinkling`.

    Args:
        rope: The rope.
        data: Its numbers.
        elongation: Current less reference length [m].
        kept: Fraction of the stiffness that it keeps when it is slack [-].
    """
    length = data.reference + elongation
    EA, stretch = rope.axial_stiffness, length / data.natural
    strain = (data.reference - data.natural + elongation) * (length + data.natural) / (2 * data.natural**2)
    S = data.prestress + EA * strain
    part = 1.0 if S >= 0 else kept
    stored = 0.0 if S >= 0 else -(1 - kept) * data.prestress**2 / (2 * EA)
    density = part * (data.prestress * strain + EA * strain**2 / 2) + stored
    return RopeState(
        data=data,
        length=length,
        strain=strain,
        energy=data.share * density * data.natural + data.force * elongation,
        tension=data.share * part * S * stretch + data.force,
        stiffness=data.share * part * (EA * stretch**2 + S) / data.natural,
        kept=part,
    )


def unstressed_length(rope: Rope, state: RopeState) -> float:
    """Length without stress that gives a rope the tension of a state at its length [m]."""
    stretch = stretch_of(np.array([state.tension]), np.array([state.data.prestress]), rope.axial_stiffness)
    return state.length / float(stretch[0])


def tension_rates(
    structure: Structure, states: Mapping[str, RopeState], start: Actions, end: Actions
) -> dict[str, float]:
    """Change of the tension of each rope with the load factor of a stage, at a fixed length [N]."""
    return {name: _tension_rate(structure, name, state, start, end) for name, state in states.items()}


def _tension_rate(structure: Structure, name: str, state: RopeState, start: Actions, end: Actions) -> float:
    """Change of the tension of a rope with the load factor of a stage, at a fixed length [N]."""
    first, last = rope_data(structure, start, True)[name], rope_data(structure, end, True)[name]
    data, stretch = state.data, state.length / state.data.natural
    elastic = state.kept * (data.prestress + structure.parts[name].material.stiffness * state.strain) * stretch
    return (
        -state.stiffness * stretch * (last.natural - first.natural)
        + data.share * state.kept * stretch * (last.prestress - first.prestress)
        + elastic * (last.share - first.share)
        + last.force
        - first.force
    )


def tension_by(rope: Part, state: RopeState, parameter: str, direction: float) -> float:
    """Change of the tension of a rope with one of its parameters, at a fixed length [N]."""
    assert rope.shares_tension
    stretch = state.length / state.data.natural
    if parameter == "natural_stretch":
        return -state.stiffness * stretch * direction
    per_unit = {"prestress": 1.0, "axial_stiffness": state.strain}[parameter]
    factor = state.data.prestress / rope.tension if parameter == "prestress" and rope.tension else 1.0
    return state.data.share * state.kept * stretch * per_unit * factor * direction
