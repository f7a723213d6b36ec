"""Schema of chambers, and of changes of their gas and of the air around, in case files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Tag

from .fields import AbsoluteTemperature, Number, Pressure, Truth, Volume
from .structure_schema import shape_of
from .table import Model

Senses = Annotated[
    Annotated[str, Tag("value")] | Annotated[list[str], Tag("list")] | Annotated[dict[str, int], Tag("table")],
    Discriminator(shape_of),
]


class ChamberModel(Model):
    """Gas enclosed by membranes, see `Chamber`; parts by name, or with 1 or -1 as { top = 1, bottom = -1 }."""

    parts: Senses
    exponent: Number | None = None
    rigid_walls: Truth | None = None


class AirModel(Model):
    """The air around, absolute, see `Ambient`."""

    kind: Literal["air"]
    pressure: Pressure | None = None
    temperature: AbsoluteTemperature | None = None


class GasPressureModel(Model):
    """A chamber open to a fan, see `GasPressure`."""

    kind: Literal["gas pressure"]
    chamber: str
    pressure: Pressure


class GasVolumeModel(Model):
    """A chamber of given volume, see `GasVolume`."""

    kind: Literal["gas volume"]
    chamber: str
    volume: Volume


class GasAmountModel(Model):
    """A closed chamber with a given amount of gas, see `GasAmount`."""

    kind: Literal["gas amount"]
    chamber: str
    pressure: Pressure
    volume: Volume


class SealModel(Model):
    """Closing of a chamber, see `Seal`."""

    kind: Literal["seal"]
    chamber: str


GasModel = AirModel | GasPressureModel | GasVolumeModel | GasAmountModel | SealModel
