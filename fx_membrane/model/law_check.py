"""Refusal of laws that break the contract in `laws`."""

from __future__ import annotations

import dataclasses
from functools import cache, lru_cache, partial
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering
from ufl.algorithms.apply_derivatives import apply_derivatives

from ..checks import validation
from ..checks.values import with_article
from . import laws, own_classes, own_formulas, relaxed_check
from .own_formulas import UnfitError

Array = NDArray[np.float64]

DIFFERENCE_STRAIN = 1e-4  # strain of difference quotients
STIFFNESS = "give a typical stiffness [N/m], of bars [N], as a property or an attribute"
KINDS = {1: "bars", 2: "membranes"}


def check(what: str, law: Any, dimension: int, own: bool) -> None:
    """Refuse what is no law.

    Args:
        what: Name of the argument.
        law: The law.
        dimension: Dimension of the cells.
        own: True for a law that the package does not bring; its energy is tried.

    Raises:
        ValueError: It is a class, or breaks the contract in `laws`.
    """
    if isinstance(law, type) or not callable(getattr(law, "energy", None)):
        kind = "Fabric, OrthotropicFabric, NeoHooke or MooneyRivlin" if dimension == 2 else "Axial"
        hint = ", with brackets behind its name" if isinstance(law, type) else ""
        raise ValueError(
            f"{what} is {validation.short_repr(law)}; give {with_article(kind)}{hint}, or a law of your own, an object "
            "with energy(E, sigma0, parameters) and stiffness."
        )
    for name in ("prestress", "pressure"):
        if own and name in getattr(law, "__dataclass_fields__", ()):
            raise ValueError(
                f"{what} {type(law).__name__} has a field {name!r}, which is the name of a parameter of its part; name "
                "it otherwise."
            )
    for name in getattr(law, "__dataclass_fields__", ()) if own else ():
        if name.startswith("_"):
            raise ValueError(
                f"{what} {type(law).__name__} has a field {name!r}; give it a name without an underscore before it."
            )
    wanted = getattr(law, "dimension", dimension)
    if not isinstance(wanted, int) or wanted not in KINDS:
        raise ValueError(f"{what} is {validation.short_repr(law)}, whose dimension is {validation.short_repr(wanted)}; "
                         "give 2 for a law of membranes, 1 for one of cables and masts.")  # fmt: skip
    if wanted != dimension:
        raise ValueError(f"{what} is {validation.short_repr(law)}, a law of {KINDS[wanted]}; give one of "
                         f"{KINDS[dimension]}.")  # fmt: skip
    own_classes.check(f"{what} is {with_article(type(law).__name__)}", type(law), ["energy"], "law")
    if own:
        _check_members(what, law)
        try:
            fault = _fault(law, dimension)
        except TypeError:  # its class has no hash
            fault = _fault.__wrapped__(law, dimension)
        if fault:
            raise ValueError(f"{what} is {validation.short_repr(law)}, whose {fault}.")


def _check_members(what: str, law: Any) -> None:
    """Refuse members of a law of a user's own that are not of their kind."""
    named = f"{what}: {type(law).__name__}"
    for entry in dataclasses.fields(law):
        validation.number(f"{named} {entry.name}", getattr(law, entry.name))
    try:
        stiffness = law.stiffness
    except Exception as error:
        missing = own_classes.home(type(law), "stiffness") is None
        fault = "is missing" if missing else f"raises {type(error).__name__}: {error}"
        raise ValueError(f"{named} stiffness {fault}; {STIFFNESS}.") from None
    if callable(stiffness):
        raise ValueError(f"{named} stiffness is a method; write @property before it.")
    validation.positive(f"{named} stiffness", stiffness)
    limit, directed, relaxed = (laws.member(law, name) for name in ("strain_limit", "directed", "relaxed_energy"))
    if limit is not None:
        validation.positive(f"{named} strain_limit", limit)
    if directed is not None:
        validation.truth(f"{named} directed", directed)
    if relaxed is not None and not callable(relaxed):
        raise ValueError(f"{named} relaxed_energy is {validation.short_repr(relaxed)}; give a method, or None.")


@lru_cache(maxsize=64)
def _fault(law: laws.Law, dimension: int) -> str:
    """Sentence on a fault in the energy of a law or in what belongs to it; empty if there is none."""
    sigma0 = float(law.stiffness) * np.array([[0.02, 0.006], [0.006, 0.01]])[:dimension, :dimension]
    try:
        fault = _energy_fault(law, sigma0) or relaxed_check.fault(law, sigma0, _symbols(law, dimension))
        return fault or _strain_fault(law, dimension)
    except UnfitError as error:
        return str(error)
    except Exception as error:
        return f"{laws.CALL} has no value at E = 0, as UFL tells by {type(error).__name__}: {error}; mend it"


def _energy_fault(law: laws.Law, sigma0: Array) -> str:
    """Sentence on a fault in the energy and its derivatives at E = 0; empty if there is none."""
    laws.formula(law, *_symbols(law, len(sigma0)))  # as it will be compiled
    if _looks_at_numbers(law, sigma0):
        return (
            "energy depends on values of its parameters by Python's own comparison (as if parameters.k == 0), which a "
            "compiled energy cannot; take ufl.conditional"
        )
    directions = _directions(len(sigma0))
    rest = laws.value(law, 0 * sigma0, sigma0)
    values = [
        (laws.value(law, DIFFERENCE_STRAIN * D, sigma0), laws.value(law, -DIFFERENCE_STRAIN * D, sigma0))
        for D in directions
    ]
    if not np.isfinite([rest, *np.ravel(values)]).all():
        return "energy is not a finite number at E = 0; give one that is, in the reference shape"
    derivatives = [_derivatives(law, D, sigma0) for D in directions]
    if not np.isfinite(derivatives).all():
        return (
            "energy has derivatives at E = 0, at equal stretches, that are not numbers, as of a root of zero; "
            "write it in the invariants tr(C) and det(C) without roots, or add a small number, as 1e-12, under the root"
        )
    faults = map(partial(_fault_along, sigma0, rest), directions, values, derivatives)
    return next(filter(None, faults), "")


def _fault_along(
    sigma0: Array, rest: float, D: Array, values: tuple[float, float], derivatives: tuple[float, float]
) -> str:
    """Sentence on a fault in the stress and the stiffness at E = 0 along a direction; empty if there is none."""
    (above, below), (slope, curvature) = values, derivatives
    wanted = float(np.sum(sigma0 * D))
    for stress in ((above - below) / (2 * DIFFERENCE_STRAIN), slope):
        if not abs(stress - wanted) <= 0.01 * np.abs(sigma0).max():
            return (
                f"stress at E = 0 is {stress:.3g} under the prestress {wanted:.3g} of a trial; they must be equal: "
                "add inner(sigma0, E) to an energy that has no stress of its own at E = 0"
            )
    if curvature > 0 and not above + below - 2 * rest > 0:
        return (
            f"energy does not grow from E = 0 under strains of {DIFFERENCE_STRAIN:g} in the direction {D.tolist()}, "
            f"where its second derivative {curvature:.3g} is positive: it has a kink, or loses small strains in "
            "rounding; write it without either"
        )
    if not curvature > 0:
        return (
            f"energy has the second derivative {curvature:.3g} at E = 0 in the direction {D.tolist()}, so that its "
            "stiffness there is not positive; give an energy that grows in all directions from there, as by "
            "parameters.k * inner(E, E) / 2"
        )
    return ""


def _looks_at_numbers(law: laws.Law, sigma0: Array) -> bool:
    """Return True if the energy is another for parameters that are numbers than for symbols of their values."""
    values: dict[Any, float] = {}

    def symbol(number: float) -> Any:
        made = own_formulas.Constant(_mesh(len(sigma0)))
        values[made] = number
        return made

    E = 0.01 * np.eye(len(sigma0))
    w = laws.formula(
        law, ufl.variable(ufl.as_matrix(E.tolist())), ufl.as_matrix(sigma0.tolist()), laws.parameters(law, symbol)
    )
    known, found = laws.value(law, E, sigma0), float(apply_algebra_lowering(w)((), values))
    return bool(abs(found - known) > 1e-9 * abs(known))


def _derivatives(law: laws.Law, direction: Array, sigma0: Array) -> tuple[float, float]:
    """First and second derivative of the energy at E = 0 along a direction, by UFL; not numbers where undefined.

    The compiled forms take the same derivatives; difference quotients pass over a root of zero.
    """
    s = ufl.variable(ufl.as_ufl(0.0))
    first = ufl.diff(laws.energy(law, s * ufl.as_matrix(direction.tolist()), sigma0), s)
    try:
        return _number(first), _number(ufl.diff(first, s))
    except (ArithmeticError, ValueError):  # as the division by a root of zero
        return np.nan, np.nan


def _number(derivative: Any) -> float:
    return float(apply_derivatives(apply_algebra_lowering(derivative))(()))


def _strain_fault(law: laws.Law, dimension: int) -> str:
    """Sentence on a fault in the strains under stresses; empty if there is none."""
    stress = float(law.stiffness) * np.broadcast_to(0.01 * np.eye(dimension), (3, dimension, dimension))
    try:
        found = laws.strain(law, stress)
    except Exception as error:
        return f"strain(stress) raises {type(error).__name__}: {error}; mend it"
    if found is None or np.shape(found) == stress.shape:
        return ""
    return (
        f"strain(stress) has the shape {np.shape(found)} for stresses of the shape {stress.shape}; return an "
        "array of the same shape"
    )


def _directions(dimension: int) -> list[Array]:
    if dimension == 1:
        return [np.eye(1)]
    return [np.diag([1.0, 0.0]), np.diag([0.0, 1.0]), np.array([[0.0, 0.5], [0.5, 0.0]]), np.eye(2)]


def _symbols(law: laws.Law, dimension: int) -> tuple[Any, Any, Any]:
    """Strain, prestress and parameters without values, as the compiled forms have them."""
    from .. import _dolfinx  # noqa: PLC0415  (the laws of the package need no dolfinx)

    space = _dolfinx.abstract_space("DG", 0, dimension, dimension**2)
    mesh, d = _mesh(dimension), range(dimension)
    strain, stress = own_formulas.Coefficient(space), own_formulas.Coefficient(space)
    E, sigma0 = (ufl.as_matrix([[field[dimension * i + j] for j in d] for i in d]) for field in (strain, stress))
    return ufl.variable(E), sigma0, laws.parameters(law, lambda _: own_formulas.Constant(mesh))


@cache
def _mesh(dimension: int) -> Any:
    from .. import _dolfinx  # noqa: PLC0415  (the laws of the package need no dolfinx)

    return _dolfinx.abstract_mesh(dimension)
