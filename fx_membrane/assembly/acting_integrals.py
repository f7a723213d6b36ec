"""Energies of integrals that act on a structure under actions: each kind of integral enters here."""

from __future__ import annotations

from ..model.ropes import Rope
from .actions import Actions
from .assembler import Assembler
from .integral_energies import IntegralEnergies
from .one_integral import IntegralEnergy
from .rope_border import RopeBorder
from .water import pond_energies


def integrals_of(assembler: Assembler, actions: Actions) -> IntegralEnergies:
    """Energies of integrals under actions."""
    ropes = assembler.discretization.structure.parts_of(Rope)
    found: list[IntegralEnergy] = [RopeBorder(name, assembler) for name in ropes]
    found += pond_energies(assembler.discretization, actions.ponds, actions.held)
    found += assembler.chambers.energies(actions)
    return IntegralEnergies(tuple(found), settled=False)
