"""Schema of changes of natural shape and prestress in case files."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from .fields import Expansions, Force, Length, Number, Shares, Temperature
from .gas_schema import GasModel
from .load_schema import CellChoice
from .table import Kept


class TemperatureModel(CellChoice):
    """Warming or cooling of a part, see `TemperatureChange`."""

    kind: Literal["temperature"]
    difference: Temperature
    expansion: Expansions


class LengthModel(CellChoice):
    """Change of the unstressed length of cables or masts, see `LengthChange`."""

    kind: Literal["length"]
    change: Length


class StretchModel(CellChoice):
    """Natural shape times a stretch, one number or [warp, weft], see `NaturalStretch`."""

    kind: Literal["stretch"]
    stretch: Shares


class PrestressModel(CellChoice):
    """Prestress times a factor, see `PrestressFactor`."""

    kind: Literal["prestress factor"]
    factor: Number


class ForceModel(CellChoice):
    """Cables or a rope of given force, see `GivenForce`."""

    kind: Literal["given force"]
    force: Force


class UnstressedModel(CellChoice):
    """Cables, masts or a rope of given unstressed length, see `UnstressedLength`."""

    kind: Literal["unstressed length"]
    length: Length


class FixedModel(CellChoice):
    """Cables or a rope of given force, fixed with the length that they have, see `FixedLength`."""

    kind: Literal["fixed length"]


Change = Annotated[
    TemperatureModel
    | LengthModel
    | StretchModel
    | PrestressModel
    | ForceModel
    | UnstressedModel
    | FixedModel
    | GasModel,
    Field(discriminator="kind"),
    Kept,
]
