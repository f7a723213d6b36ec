"""Derivatives of the residual by parameters of gas, at a fixed displacement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from petsc4py import PETSc

from ..checks import validation
from ..model.digests import of_settings
from ..runtime.processes import refuse_differences, together
from .gas_laws import Enclosed, Fan
from .one_integral import EnergyOfIntegral

if TYPE_CHECKING:
    from .problem_under_actions import LoadedProblem

OPEN = ("pressure",)
CLOSED = ("amount", "air pressure", "air temperature")


def by_gas(
    loaded: LoadedProblem, x: PETSc.Vec, chamber: str, parameter: str, direction: Any, b: PETSc.Vec
) -> PETSc.Vec:
    """Set a vector to the derivative by a parameter of the gas in a chamber.

    Args:
        loaded: The problem.
        x: Displacement [m].
        chamber: Name of the chamber.
        parameter: Name of the parameter.
        direction: Its change.
        b: The vector [N per unit of the parameter].

    Raises:
        ValueError: The gas in the chamber has no parameter of that name; the direction is no number; they are not the
            same on all processes.
    """
    with together(loaded.comm):
        number = _checked(loaded, chamber, parameter, direction)
    refuse_differences(loaded.comm, lambda: of_settings({"gas": (chamber, parameter, number)}))
    energy = next(entry for entry in loaded.integrals.all if entry.name == chamber and entry.is_load)
    assert isinstance(energy, EnergyOfIntegral)
    rate = number * _rate(loaded, energy, parameter, energy.integral.value(x))
    energy.integral.gradient(x, b)
    b.scale(rate)
    return b


def _checked(loaded: LoadedProblem, chamber: str, parameter: str, direction: Any) -> float:
    """Change of a parameter that the gas in a chamber has."""
    gas = loaded.actions.gas.get(chamber)
    kind = None if gas is None else gas.kind
    air = loaded.actions.air
    known = {"pressure": OPEN, "amount": CLOSED if air and air.temperature else CLOSED[:2]}.get(kind or "", ())
    if not isinstance(parameter, str) or parameter not in known:
        state = {None: "without gas here", "pressure": "open", "amount": "closed", "volume": "of a given volume"}
        raise ValueError(
            f"Chamber {chamber!r} is {state.get(kind, kind)} and has no parameter {validation.short_repr(parameter)}; "
            f"those with a derivative are {list(known)}."
        )
    return validation.number(f"direction of {parameter!r}", direction)


def _rate(loaded: LoadedProblem, energy: EnergyOfIntegral, parameter: str, volume: float) -> float:
    """Differentiate phi' by a parameter."""
    law, air = energy.law, loaded.actions.air
    if isinstance(law, Fan):
        return -1.0
    assert isinstance(law, Enclosed)
    assert air is not None
    if parameter == "air pressure":
        return law.by_air_pressure(volume)
    warmth = air.temperature or 1.0
    return law.by_amount(volume) * (warmth if parameter == "amount" else law.amount / warmth)
