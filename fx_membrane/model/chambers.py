"""Chambers: gas enclosed by membranes, as plain data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..checks import validation
from ..checks.read_only_data import ReadOnlyDict
from .by_value import ByValue
from .chamber_surfaces import surface


@dataclass(frozen=True, eq=False)
class Chamber(ByValue):
    """Gas enclosed by membranes: a cushion, an air hall, a cell of several. A membrane may bound two chambers.

    A stage sets its gas by `Stage(changes=[...])`: `GasPressure`, `GasVolume`, `GasAmount`, `Seal`, and the air around
    by `Ambient`. Until then it is open, without pressure.

    Args:
        parts: Names of the membranes that enclose it. Give a dictionary with 1 for a membrane whose normals
            (`Structure.normals`) point out of the chamber. -1 is one whose normals point into it. Without that the
            chamber is turned outwards by itself. It cannot be where all films lie flat on each other.
        exponent: Polytropic exponent n of closed gas, p V^n constant at one temperature of the air around: 1 for
            isothermal, 1.4 for adiabatic air [-].
        rigid_walls: True to close holes by rigid walls: the ground below an air hall, planes of symmetry, the ends of a
            strip. Their rims must be held by supports, in all components or across a plane x, y or z constant.

    Raises:
        ValueError: parts are not names, or none; a sense is neither 1 nor -1; the exponent is below 1.

    Example:
        >>> Chamber({"top": 1, "bottom": -1}).parts
        {'top': 1, 'bottom': -1}
    """

    parts: Mapping[str, int] | Sequence[str] | str
    exponent: float = 1.0
    rigid_walls: bool = False

    def __post_init__(self) -> None:
        given: Any = [self.parts] if isinstance(self.parts, str) else self.parts
        if not isinstance(given, Mapping | list | tuple) or not len(given):
            raise ValueError(
                f"Chamber parts is {validation.short_repr(self.parts)}; give names of membranes, as "
                '["top", "bottom"], or {"top": 1, "bottom": -1}.'
            )
        names = [validation.text("Chamber parts", name) for name in given]
        validation.unique("Chamber part", names)
        if isinstance(given, Mapping):
            for name, sense in given.items():
                if isinstance(sense, bool) or np.ndim(sense) or sense not in (1, -1):
                    raise ValueError(
                        f"Chamber part {name!r} has the sense {validation.short_repr(sense)}; give 1 if its normals "
                        "point out of the chamber, or -1."
                    )
            validation.keep(self, parts=ReadOnlyDict({name: int(sense) for name, sense in given.items()}))
        else:
            validation.keep(self, parts=tuple(names))
        exponent = validation.number("Chamber exponent", self.exponent)
        if exponent < 1:
            raise ValueError(f"Chamber exponent is {exponent:g}; give 1 (isothermal) up to 1.4 (adiabatic air).")
        validation.keep(self, exponent=exponent, rigid_walls=validation.truth("Chamber rigid_walls", self.rigid_walls))


def checked_chambers(structure: Any) -> dict[str, Chamber]:
    """Chambers of a structure by name.

    Raises:
        ValueError: They are no dictionary, or one is no `Chamber`; the surface of one is refused, see `surface`.
    """
    given = structure.chambers
    if not isinstance(given, Mapping):
        raise ValueError(f'chambers is {validation.short_repr(given)}; give a dictionary, {{"name": Chamber(...)}}.')
    found = {validation.name("chamber", name): chamber for name, chamber in given.items()}
    for name, chamber in found.items():
        validation.plain(f"Chamber {name!r}", chamber, Chamber)
        surface(structure, name)
    return found
