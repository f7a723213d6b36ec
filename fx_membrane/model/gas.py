"""Gas in chambers, and the air around, as stages change them; plain data."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..checks import validation
from .base_classes import AnyChange

GAUGE = 0.5  # absolute pressure of a gas, as a fraction of that around, below which it is taken for a gauge pressure
COLD = 100.0  # [K]
ATMOSPHERES = (101325.0, 101.325, 10.1325, 1.01325, 0.101325, 1.01325e-4, 2116.2, 2.1162, 14.696, 0.014696)
"""That at sea level in N, kN and MN per m2, cm2 and mm2, and in lbf and kip per ft2 and in2."""
THIN, DENSE = 0.3, 1.5  # least and most pressure of air around, as a fraction of that at sea level
REMEDY = "give absolute pressures, that of the atmosphere being about 101325 Pa"


@dataclass(frozen=True, eq=False)
class Ambient(AnyChange):
    """The air around the structure, at the end of a stage; later stages keep it.

    In the first stage that has it, it does not change in the stage: it holds from its start.

    Args:
        pressure: Absolute pressure, about 101325 Pa at sea level [Pa]; None to keep it.
        temperature: Absolute temperature of the air, which closed gas takes [K]; None to keep it.

    Raises:
        ValueError: Both are None; a value is not positive; the temperature is below 100 K.

    Warns:
        UserWarning: The pressure is below 101325 Pa, and no atmosphere in any other unit: a gauge pressure, perhaps.

    Example:
        >>> Stage("cold", changes=[Ambient(temperature=253.15)], after="sealed").changes[0].temperature
        253.15
    """

    pressure: float | None = None
    temperature: float | None = None

    def __post_init__(self) -> None:
        if self.pressure is None and self.temperature is None:
            raise ValueError("Ambient has neither pressure nor temperature; give one, or both.")
        if self.pressure is not None:
            validation.store(self, validation.positive, "pressure")
            usual = any(THIN * most <= self.pressure <= DENSE * most for most in ATMOSPHERES)
            if not usual and self.pressure < max(ATMOSPHERES):
                warnings.warn(
                    f"Ambient pressure is {self.pressure:g}, far from that of the atmosphere, which looks like a gauge "
                    f"pressure; {REMEDY} or 101.325 kN/m2.",
                    stacklevel=3,
                )
        if self.temperature is not None:
            validation.store(self, validation.positive, "temperature")
            if self.temperature < COLD:
                raise ValueError(
                    f"Ambient temperature is {self.temperature:g}, at which air is no gas; give kelvins, as 293.15 for "
                    "20 degrees Celsius."
                )


@dataclass(frozen=True, eq=False)
class GasPressure(AnyChange):
    """A chamber open to a fan that holds a pressure.

    Args:
        pressure: Pressure above that of the air around, at the end of the stage [Pa].
        chamber: Name of the chamber.

    Raises:
        ValueError: The pressure is not a finite number; chamber is not a text.

    Example:
        >>> Stage("inflate", changes=[GasPressure(300.0, "cushion")]).changes[0].pressure
        300.0
    """

    pressure: float
    chamber: str

    def __post_init__(self) -> None:
        validation.store(self, validation.number, "pressure")
        validation.store(self, validation.text, "chamber")


@dataclass(frozen=True, eq=False)
class GasVolume(AnyChange):
    """A chamber with a given volume, as of a liquid that fills it; its pressure follows.

    Args:
        volume: Volume at the end of the stage [m3].
        chamber: Name of the chamber.

    Raises:
        ValueError: The volume is not positive; chamber is not a text.

    Example:
        >>> Stage("fill", changes=[GasVolume(0.4, "bag")]).changes[0].volume
        0.4
    """

    volume: float
    chamber: str

    def __post_init__(self) -> None:
        validation.store(self, validation.positive, "volume")
        validation.store(self, validation.text, "chamber")


@dataclass(frozen=True, eq=False)
class GasAmount(AnyChange):
    """A closed chamber with an amount of gas, given by a state of it: pressure and volume.

    For an amount in a volume V, p V^n / T is constant. p is the absolute pressure, n the `exponent` of the chamber, and
    T the temperature of the air around, if one is given.

    Args:
        pressure: Absolute pressure of the amount in the volume, at the temperature of the air around [Pa].
        volume: The volume [m3].
        chamber: Name of the chamber.

    Raises:
        ValueError: Pressure or volume is not positive; chamber is not a text.

    Example:
        >>> filled = [Ambient(101_325.0), GasAmount(101_625.0, 0.36, "cushion")]
        >>> Stage("fill", changes=filled).changes[1].volume
        0.36
    """

    pressure: float
    volume: float
    chamber: str

    def __post_init__(self) -> None:
        validation.store(self, validation.positive, "pressure")
        validation.store(self, validation.positive, "volume")
        validation.store(self, validation.text, "chamber")


@dataclass(frozen=True, eq=False)
class Seal(AnyChange):
    """Closing of a chamber with the gas that is in it at the start of the stage; its pressure then follows.

    Args:
        chamber: Name of the chamber.

    Raises:
        ValueError: chamber is not a text.

    Example:
        >>> Stage("close", changes=[Ambient(101_325.0), Seal("cushion")], after="inflate").changes[1].chamber
        'cushion'
    """

    chamber: str

    def __post_init__(self) -> None:
        validation.store(self, validation.text, "chamber")


GasChange = GasPressure | GasVolume | GasAmount | Seal | Ambient


@dataclass(frozen=True)
class Gas:
    """Gas in a chamber.

    Attributes:
        kind: "pressure", "volume" or "amount"; "sealed" for an amount that the start of the stage decides.
        value: Pressure above that around [Pa]; volume [m3]; or amount, p V / T, or p V without a temperature.
        reference: Volume at which the amount has the temperature of the air around [m3].
    """

    kind: str
    value: float = 0.0
    reference: float = 1.0

    def is_like(self, other: Gas | None) -> bool:
        """Return True if a load factor can join the other gas and this one."""
        return other is not None and self.kind == other.kind and self.reference == other.reference


@dataclass(frozen=True)
class Air:
    """The air around.

    Attributes:
        pressure: Absolute pressure [Pa].
        temperature: Absolute temperature [K]; None if none is given.
    """

    pressure: float
    temperature: float | None = None


def check_gas_change(structure: Any, stage: str, change: GasChange) -> None:
    """Refuse a change of an unknown chamber."""
    name = getattr(change, "chamber", None)
    if name is not None and name not in structure.chambers:
        known = f"the chambers are {list(structure.chambers)}" if structure.chambers else "the structure has none"
        raise ValueError(f"{stage} has a {type(change).__name__} of chamber {name!r}, which does not exist; {known}.")


def refuse_two_gases(stage: str, changes: Sequence[Any]) -> None:
    """Refuse two changes of the gas in one chamber: only one can hold at the end of a stage."""
    seen: dict[str, Any] = {}
    for change in changes:
        chamber = getattr(change, "chamber", None)
        if chamber in seen:
            first, second = type(seen[chamber]).__name__, type(change).__name__
            raise ValueError(f"{stage} changes has {first} and {second} of chamber {chamber!r}; give one of them.")
        if chamber is not None:
            seen[chamber] = change


def refuse_among_loads(what: str, loads: Any, remedy: str) -> None:
    """Refuse changes of gas that are given as loads."""
    for load in loads if isinstance(loads, list | tuple) else ():
        if isinstance(load, GasChange):
            raise ValueError(f"{what} has {validation.short_repr(load)}, a change of gas; {remedy}.")


def air_after(stage: Any, before: Air | None) -> Air | None:
    """Air around at the end of a stage.

    Raises:
        ValueError: A temperature is given without a pressure.
    """
    air = before
    for change in stage.changes:
        if not isinstance(change, Ambient):
            continue
        pressure = change.pressure if change.pressure is not None else air and air.pressure
        if not pressure:
            raise ValueError(
                f"Stage {stage.name!r} has an Ambient temperature before a pressure; {REMEDY}: Ambient(101325.0, "
                f"{change.temperature:g})."
            )
        air = Air(pressure, air.temperature if air and change.temperature is None else change.temperature)
    if before and air and not GAUGE * before.pressure < air.pressure < before.pressure / GAUGE:
        raise ValueError(
            f"Stage {stage.name!r} changes the pressure around from {before.pressure:g} to {air.pressure:g}, which "
            f"looks like a gauge pressure; {REMEDY}."
        )
    return air


def gas_after(stage: Any, before: dict[str, Gas], start: Air | None, end: Air | None) -> dict[str, Gas]:
    """Gas in the chambers at the end of a stage.

    Raises:
        ValueError: An amount of gas has no air around it; its absolute pressure looks like a gauge pressure.
    """
    gas = dict(before)
    for change in stage.changes:
        if isinstance(change, GasPressure):
            gas[change.chamber] = Gas("pressure", change.pressure)
        elif isinstance(change, GasVolume):
            gas[change.chamber] = Gas("volume", change.volume)
        elif isinstance(change, Seal | GasAmount):
            what = f"Stage {stage.name!r} has a {type(change).__name__} of chamber {change.chamber!r}"
            if end is None:
                raise ValueError(f"{what}, but no pressure around it is given; add Ambient(101325.0), in pascals.")
            if isinstance(change, Seal):
                gas[change.chamber] = Gas("sealed")
            elif change.pressure < GAUGE * end.pressure:
                raise ValueError(
                    f"{what} at the absolute pressure {change.pressure:g} in air of {end.pressure:g}, which looks like "
                    f"a gauge pressure; add that around: {change.pressure + end.pressure:g}."
                )
            else:
                warmth = end.temperature or 1.0
                amount = change.pressure * change.volume / warmth
                gas[change.chamber] = Gas("amount", amount, change.volume)
    if start and end and (start.temperature is None) != (end.temperature is None):
        closed = [name for name, content in before.items() if content.kind in ("amount", "sealed")]
        if closed:
            raise ValueError(
                f"Stage {stage.name!r} gives the air around a temperature, but chamber {closed[0]!r} was closed "
                "without one; give it by Ambient in the stage that closes the chamber, or before."
            )
    return gas
