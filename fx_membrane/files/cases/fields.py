"""Types of the values of case files: quantities, numbers in the units of the file or texts with a unit.

Validation needs `context={"units": Units(...)}`, or None for a file that names none.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from pydantic import BeforeValidator, StrictBool, ValidationInfo, WithJsonSchema

from .units import EXAMPLES, NUMBER, Units

TESTS = {"stress": "F/L", "elongation": "1"}  # dimensions of biaxial tests
MAX_NODE = 2**53  # whole number of a node


def _number(dimension: str, value: Any, info: ValidationInfo) -> float:
    units = info.context["units"] if info.context else None
    if units is None and isinstance(value, str):
        raise ValueError('the file has no units; add units = { force = "kN", length = "m" } at its top')
    return (units or Units()).number(value, dimension)


def _range(value: Any, info: ValidationInfo) -> tuple[float, float]:
    ends = value if isinstance(value, list) else [value, value]
    if len(ends) != 2:
        raise ValueError("give a place, or a range as [0, 3]")
    return _number("L", ends[0], info), _number("L", ends[1], info)


def _node(value: Any) -> int | str:
    if isinstance(value, bool) or not isinstance(value, int | str) or value == "":
        raise ValueError("give the number of a node (an integer), or its name in quotes")
    if isinstance(value, int) and abs(value) > MAX_NODE:
        raise ValueError("no node has that number")
    return value


def _nested(dimension: str, value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, list):
        return [_nested(dimension, entry, info) for entry in value]
    if isinstance(value, dict):
        return {name: _nested(dimension, entry, info) for name, entry in value.items()}
    return _number(dimension, value, info)


def _drawn(value: Any, info: ValidationInfo) -> Any:
    """Point of a line of a sail: a name, a name and a share of its length, or a place."""
    if isinstance(value, str):
        return value
    if isinstance(value, list) and len(value) == 2 and isinstance(value[0], str) and not NUMBER.fullmatch(value[0]):
        return value[0], _number("1", value[1], info)
    if isinstance(value, list) and len(value) in (2, 3):
        return _nested("L", value, info)
    raise ValueError('give a name, a share of an edge as ["A-B", 0.5], or a place as [4, 2, 5]')


def _surface_point(value: Any, info: ValidationInfo) -> Any:
    if not isinstance(value, list):
        return _node(value)
    if len(value) != 3:
        raise ValueError("give a node, or a place as [4, 2, 5]")
    return _nested("L", value, info)


def _compensation(value: Any, info: ValidationInfo) -> Any:
    if value == "prestress":
        return value
    if isinstance(value, str) and not NUMBER.fullmatch(value):
        raise ValueError('give "prestress", a ratio, or a pair for warp and weft as [0.99, 0.98]')
    if isinstance(value, dict) and value.keys() & TESTS.keys():
        if value.keys() != TESTS.keys():
            raise ValueError("biaxial tests have stress and elongation; give a list of (warp, weft) pairs for each")
        return {key: _nested(TESTS[key], entry, info) for key, entry in value.items()}
    if isinstance(value, dict):
        return {name: _compensation(entry, info) for name, entry in value.items()}
    found = _nested("1", value, info)
    return tuple(found) if isinstance(found, list) else found


def _quantity(dimension: str) -> Any:
    schema = {"type": ["number", "string"], "examples": [EXAMPLES[dimension]]}
    return Annotated[float, BeforeValidator(partial(_number, dimension)), WithJsonSchema(schema)]


def _quantities(dimension: str) -> Any:
    schema = {"type": ["number", "string", "array"], "examples": [EXAMPLES[dimension]]}
    return Annotated[Any, BeforeValidator(partial(_nested, dimension)), WithJsonSchema(schema)]


def _nested_quantities(dimension: str) -> Any:
    """Quantities in lists and tables of any depth."""
    schema = {"type": ["number", "string", "array", "object"], "examples": [EXAMPLES[dimension]]}
    return Annotated[Any, BeforeValidator(partial(_nested, dimension)), WithJsonSchema(schema)]


def _vector(dimension: str) -> Any:
    entry = _quantity(dimension)
    return tuple[entry, entry, entry]  # type: ignore[valid-type]  # made for pydantic, not for mypy


if TYPE_CHECKING:
    Number: TypeAlias = float
    Truth: TypeAlias = bool
    Length: TypeAlias = float
    Area: TypeAlias = float
    Time: TypeAlias = float
    Volume: TypeAlias = float
    SpecificWeight: TypeAlias = float
    Force: TypeAlias = float
    ForcePerLength: TypeAlias = float
    Pressure: TypeAlias = float
    AreaMass: TypeAlias = float
    LineMass: TypeAlias = float
    Stress: TypeAlias = Any
    Forces: TypeAlias = Any
    Directions: TypeAlias = Any
    Range: TypeAlias = Any
    Vector: TypeAlias = tuple[float, float, float]
    Point: TypeAlias = Vector
    Displacement: TypeAlias = Vector
    ForceVector: TypeAlias = Vector
    LineLoad: TypeAlias = Vector
    AreaLoad: TypeAlias = Vector
    Direction: TypeAlias = Vector
    Densities: TypeAlias = Any
    Places: TypeAlias = Any
    PlaceRows: TypeAlias = Any
    Shares: TypeAlias = Any
    Temperature: TypeAlias = float
    AbsoluteTemperature: TypeAlias = float
    Expansions: TypeAlias = Any
    LinePoint: TypeAlias = Any
    Node: TypeAlias = int | str
    SurfacePoint: TypeAlias = Any
    Compensation: TypeAlias = Any
else:
    Truth = StrictBool  # not "yes", "false" or 1
    Number, Length, Force, ForcePerLength = _quantity("1"), _quantity("L"), _quantity("F"), _quantity("F/L")
    Area, Time = _quantity("L^2"), _quantity("T")
    Volume, SpecificWeight = _quantity("L^3"), _quantity("F/L^3")
    Temperature, Expansions = _quantity("K"), _quantities("1/K")
    AbsoluteTemperature = _quantity("absolute K")
    Pressure, AreaMass, LineMass = _quantity("F/L^2"), _quantity("F T^2/L^3"), _quantity("F T^2/L^2")
    Stress, Forces, Directions = _quantities("F/L"), _quantities("F"), _quantities("1")
    Point, Displacement, ForceVector = _vector("L"), _vector("L"), _vector("F")
    LineLoad, AreaLoad, Direction = _vector("F/L"), _vector("F/L^2"), _vector("1")
    PlaceRows = _quantities("L")
    Densities, Places, Shares = _quantities("F/L"), _nested_quantities("L"), _nested_quantities("1")
    Node = Annotated[Any, BeforeValidator(_node), WithJsonSchema({"type": ["integer", "string"]})]
    SurfacePoint = Annotated[
        Any, BeforeValidator(_surface_point), WithJsonSchema({"type": ["integer", "string", "array"]})
    ]
    Compensation = Annotated[
        Any, BeforeValidator(_compensation), WithJsonSchema({"type": ["number", "string", "array", "object"]})
    ]
    LinePoint = Annotated[Any, BeforeValidator(_drawn), WithJsonSchema({"type": ["string", "array"]})]
    Range = Annotated[Any, BeforeValidator(_range), WithJsonSchema({"type": ["number", "string", "array"]})]
