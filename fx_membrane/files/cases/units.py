"""Quantities of case files: numbers in the units of the file, or texts with a unit, by pint.

pint alone computes with texts, takes a comma for nothing and some powers for ever; so a number is read here, and pint
gets the name of a unit only.
"""

from __future__ import annotations

import math
import re
from functools import cache
from typing import Any

NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
UNIT = re.compile(r"(?:1\s*/)?[A-Za-zµ23*/^()·²³ ]{1,40}")
KNOWN = (
    *(
        "N",
        "daN",
        "kN",
        "MN",
        "GN",
        "kp",
        "lbf",
        "kip",
        "m",
        "cm",
        "mm",
        "km",
        "in",
        "ft",
        "s",
        "min",
        "h",
        "g",
        "kg",
        "t",
        "K",
    ),
    *("Pa", "hPa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "psf", "plf"),
)
SCALES = ("degC", "degF", "celsius", "fahrenheit")  # temperatures with a zero of their own
EXAMPLE = "give one as 'kN/m2'"
EXAMPLES = {
    "F": "12 kN",
    "L": "3.5 m",
    "T": "60 s",
    "L^2": "4 cm2",
    "L^3": "0.4 m3",
    "F/L": "2 kN/m",
    "F/L^2": "0.6 kN/m2",
    "F T^2/L^3": "1.1 kg/m2",
    "F T^2/L^2": "2.5 kg/m",
    "F/L^3": "10 kN/m3",
    "K": "30 K",
    "absolute K": "293.15 K' or '20 degC",
    "1/K": "1.2e-5 1/K",
    "1": "0.3",
}


class Units:
    """Units in which a structure is computed.

    Args:
        force: Unit of force, as "kN".
        length: Unit of length, as "m".

    Raises:
        ValueError: It is no unit of force or of length.
    """

    def __init__(self, force: str = "N", length: str = "m"):
        self.force, self.length = force, length
        for name, dimension in (("force", "newton"), ("length", "metre")):
            if not _unit(getattr(self, name)).is_compatible_with(dimension):
                raise ValueError(f"{getattr(self, name)!r} is no unit of {name}; give one, as {dimension!r}")

    def number(self, value: Any, dimension: str) -> float:
        """Read a quantity in these units.

        Args:
            value: A number, in these units, or a text with a unit: "2 kN/m".
            dimension: Dimension as a key of `EXAMPLES`, of F for force, L for length, T for time, K for a difference of
                temperatures; "absolute K" has the zero of its scale.

        Raises:
            ValueError: It is no finite number, or its unit is not known or of another dimension.
        """
        example = EXAMPLES[dimension]
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            other = "" if dimension == "1" else f", or a text with a unit as {example!r}"
            raise ValueError(f"give a number{other}")
        if not isinstance(value, str):
            return _finite(float(value))
        found = NUMBER.fullmatch(value)
        if not found:
            raise ValueError(f"it does not begin with a number; give one as {example!r}")
        number, name = _finite(float(found[1])), found[2]
        if name.startswith(","):
            raise ValueError(f"write a point for the comma, as {example!r}")
        if not name:
            return number
        if dimension == "1" and "%" not in name:
            raise ValueError("it has no unit; give the number alone")
        unit, target = _unit(name), _target(self.force, self.length, dimension)
        if not unit.is_compatible_with(target):
            raise ValueError(
                f"{name!r} is no unit of this quantity; {_spelled(name, target) or f'give one as {example!r}'}"
            )
        if "K" in dimension and dimension != "absolute K" and any(scale in name for scale in SCALES):
            raise ValueError(f"{name!r} is a temperature, not a difference; give one as {example!r}")
        return _finite(float(_registry().Quantity(number, unit).to(target).magnitude))


@cache
def _registry() -> Any:
    import pint  # noqa: PLC0415  (0.3 s, which only case files are to wait for)

    registry = pint.UnitRegistry(cache_folder=None, preprocessors=[_powers])
    registry.define("psf = pound_force / foot ** 2")
    registry.define("plf = pound_force / foot")
    return registry


def _powers(text: str) -> str:
    """Write powers and products as pint knows them: kN/m2, kN/m², kN·m."""
    text = text.replace("²", "**2").replace("³", "**3").replace("·", "*").replace("^", "**")
    return re.sub(r"(?<=[A-Za-zµ])([23])\b", r"**\1", text)


@cache  # a file names the same few units in all its numbers; pint takes a quarter of a millisecond for each name
def _unit(name: str) -> Any:
    if "%" in name:
        raise ValueError("it has no unit; give the number alone, as 0.8 for 80 %")
    if "°" in name:
        raise ValueError(f"{name[:40]!r} is a temperature with a zero of its own; give '30 K', or '1.2e-5 1/K'")
    if re.search(r"/\s*\d", name):
        raise ValueError(f"{name[:40]!r} has a number in it; for daN/5cm divide by 5 and give daN/cm")
    if not UNIT.fullmatch(name) or "**" in name:
        raise ValueError(f"{name[:40]!r} is no unit; give one as 'kN/m2', of letters and the powers 2 and 3")
    registry = _registry()
    try:
        return registry.parse_units(name)
    except Exception:  # pint's errors, and those of its tokenizer, which are others in each version
        raise ValueError(f"{name!r} is no known unit; {_spelled(name) or EXAMPLE}") from None


@cache
def _target(force: str, length: str, dimension: str) -> Any:
    """Return the unit of a dimension, a key of `EXAMPLES`, in units of force and length."""
    registry = _registry()
    base = {"F": _unit(force), "L": _unit(length), "T": registry.second, "K": registry.kelvin}
    above, _, below = dimension.removeprefix("absolute ").partition("/")
    unit = registry.dimensionless
    for factors, sign in ((above, 1), (below, -1)):
        for factor in factors.split():
            letter, _, power = factor.partition("^")
            if letter == "1":
                continue
            unit = unit * base[letter] ** (sign * int(power or 1))
    return unit


def _spelled(name: str, target: Any = None) -> str:
    """Clause that spells a unit rightly where its capital letters are wrong; empty if it is no unit then, either."""
    words = {unit.lower(): unit for unit in KNOWN}
    found = re.sub(r"[A-Za-zµ]+", lambda word: words.get(word[0].lower(), word[0]), name)
    if found == name:
        return ""
    try:
        unit = _registry().parse_units(found)
    except Exception:
        return ""
    return f"{found!r} may be meant" if target is None or unit.is_compatible_with(target) else ""


def _finite(number: float) -> float:
    if not math.isfinite(number):
        raise ValueError("it is not finite; give a number")
    return number
