"""Gas in the chambers of a structure under actions: its energies, and its state in a shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..model.chamber_surfaces import surface
from ..model.chambers import Chamber
from ..model.gas import Air, Gas
from .actions import Actions
from .discretization import Discretization
from .gas_laws import Enclosed, Fan
from .integral_energies import IntegralEnergies
from .one_integral import EnergyOfIntegral, GivenIntegral, Law
from .volume import Volume

Array = NDArray[np.float64]

OPEN, CLOSED, GIVEN = "open", "closed", "given volume"
KINDS = {"pressure": OPEN, "amount": CLOSED, "sealed": CLOSED, "volume": GIVEN}


class ChamberResult(NamedTuple):
    """State of the gas in a chamber.

    Attributes:
        pressure: Pressure above that around [Pa].
        volume: Volume [m3].
        dp_dV: Derivative of the pressure of the gas by the volume [Pa/m3]: 0 where open, minus infinity for a given
            volume.
        state: "open", "closed" or "given volume".

    Example:
        >>> points = [(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]
        >>> foil = Membrane([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], Fabric(4e5, 0.3), prestress=100.0)
        >>> bag = Structure(points, {"foil": foil}, [Support(range(4))], chambers={"bag": Chamber({"foil": 1})})
        >>> blown = Analysis(bag).run([Stage("blow", changes=[GasPressure(50.0, "bag")])])["blow"]
        >>> gas = blown.chambers["bag"]
        >>> gas.pressure, round(gas.volume, 6), gas.state
        (50.0, 2.666667, 'open')
    """

    pressure: float
    volume: float
    dp_dV: float
    state: str


class Chambers:
    """Volumes of the chambers of a structure, made on first use."""

    def __init__(self, discretization: Discretization):
        self.discretization = discretization
        self._volumes: dict[str, Volume] = {}

    def volume(self, name: str) -> Volume:
        """Volume of a chamber; collective when first asked for."""
        if name not in self._volumes:
            self._volumes[name] = Volume(self.discretization, *surface(self.discretization.structure, name))
        return self._volumes[name]

    def energies(self, actions: Actions) -> list[EnergyOfIntegral]:
        """Energies of the gas under actions."""
        return [self._energy(name, gas, actions.air) for name, gas in actions.gas.items()]

    def _energy(self, name: str, gas: Gas, air: Air | None) -> EnergyOfIntegral:
        common: dict[str, Any] = {
            "name": name,
            "discretization": self.discretization,
            "integral": self.volume(name),
        }
        if gas.kind == "volume":
            return GivenIntegral(**common, target=gas.value)
        return EnergyOfIntegral(**common, law=self._law(name, gas, air))

    def _law(self, name: str, gas: Gas, air: Air | None) -> Law:
        if gas.kind == "pressure":
            return Fan(gas.value)
        if gas.kind == "sealed" or air is None:
            raise ValueError(
                f"Actions seal chamber {name!r} with the gas that is in it at the start of their stage; join them with "
                "that state by Problem.with_gas_of_start, or run the stage by an Analysis."
            )
        exponent = self.discretization.structure.chambers[name].exponent
        return Enclosed(gas.value * (air.temperature or 1.0), gas.reference, exponent, air.pressure)

    def states(self, actions: Actions, integrals: IntegralEnergies, x: PETSc.Vec) -> dict[str, ChamberResult]:
        """State of the gas in each chamber, for a shape with known multipliers."""
        energies = {energy.name: energy for energy in integrals.all if isinstance(energy, EnergyOfIntegral)}
        found = {}
        for name in self.discretization.structure.chambers:
            volume = self.volume(name).value(x)
            gas = actions.gas.get(name)
            if gas is None:
                found[name] = ChamberResult(0.0, volume, 0.0, OPEN)
                continue
            law = energies[name].law
            slope = -np.inf if gas.kind == "volume" else 0.0 - law.stiffness(volume)
            found[name] = ChamberResult(-law.force(volume), volume, float(slope), KINDS[gas.kind])
        return found


def at_start(
    start: Actions,
    end: Actions,
    states: Callable[[], Mapping[str, ChamberResult]],
    chambers: Mapping[str, Chamber],
    stage: str,
) -> tuple[Actions, Actions]:
    """Actions at the start and the end of a stage with gas of equal kinds.

    Gas at the start is described as that of the end: the amount of sealed gas is that in the chamber then.

    Args:
        start: Actions at the start.
        end: Actions at the end.
        states: State of the gas at the start.
        chambers: The chambers.
        stage: Name of the stage.

    Raises:
        ValueError: A chamber is sealed that has no volume.
    """
    air = end.air if start.air is None else start.air
    start = replace(start, air=air)
    other = [name for name, gas in end.gas.items() if not gas.is_like(start.gas.get(name))]
    if not other:
        return start, end
    found, before, after = states(), dict(start.gas), dict(end.gas)
    for name in other:
        if end.gas[name].kind == "sealed":
            after[name] = before[name] = _sealed(name, found[name], air, stage)
        else:
            before[name] = _as_before(end.gas[name], found[name], air, chambers[name].exponent)
    return replace(start, gas=before), replace(end, gas=after)


def _sealed(name: str, found: ChamberResult, air: Air | None, stage: str) -> Gas:
    """Amount of the gas in a chamber."""
    assert air is not None
    absolute = found.pressure + air.pressure
    if not (found.volume > 0 and absolute > 0):
        raise ValueError(
            f"Stage {stage!r} closes chamber {name!r}, whose volume is {found.volume:.4g} at its start; inflate it in "
            "a stage before (GasPressure), or give the gas by GasAmount."
        )
    return Gas("amount", absolute * found.volume / (air.temperature or 1.0), found.volume)


def _as_before(gas: Gas, found: ChamberResult, air: Air | None, exponent: float) -> Gas:
    """Gas of the kind of another, with the pressure and volume found."""
    if gas.kind == "pressure":
        return replace(gas, value=found.pressure)
    if gas.kind == "volume":
        return replace(gas, value=found.volume)
    assert air is not None
    volume = max(found.volume, 0.0)
    amount = (found.pressure + air.pressure) * volume * (volume / gas.reference) ** (exponent - 1)
    return replace(gas, value=amount / (air.temperature or 1.0))
