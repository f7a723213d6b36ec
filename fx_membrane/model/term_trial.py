"""Integral of an energy term in UFL, and its trial on symbols without a mesh."""

from __future__ import annotations

from collections import namedtuple
from collections.abc import Mapping
from functools import lru_cache
from typing import Any, NamedTuple

import ufl
from ufl.algorithms import expand_derivatives
from ufl.algorithms.check_arities import ArityMismatch, check_form_arity

from ..forms.energy_terms import State
from . import own_formulas
from .own_formulas import UnfitError

DEGREE = 2  # quadrature
Kinds = tuple[tuple[str, str, int], ...]  # of each parameter: its name, "constant" or "cells", number of components


def integral(term: Any, state: State, parameters: Any, weight: Any, v: Any, domain: Any) -> ufl.Form:
    """Integral of the energy or the virtual work of a term over its part.

    Args:
        term: The term.
        state: Symbols of the part.
        parameters: Symbols of its parameters, by name.
        weight: Factor of each cell.
        v: Virtual displacement.
        domain: Mesh of the part.

    Raises:
        UnfitError: The method of the term fails, or returns no scalar in UFL.
    """
    energy = callable(getattr(term, "energy", None))
    symbols = _described(parameters)
    if energy:
        call, example = "energy(state, parameters)", "parameters.k * state.u[2]**2 / 2"
        density = own_formulas.scalar(term.energy, call, (state, parameters), symbols, example)
    else:
        call, example = "virtual_work(state, v, parameters)", "parameters.p * dot(state.n, v)"
        density = own_formulas.scalar(term.virtual_work, call, (state, v, parameters), symbols, example)
    degree = getattr(term, "quadrature_degree", DEGREE)
    return weight * density * ufl.Measure("dx", metadata={"quadrature_degree": degree}, domain=domain)


def _described(parameters: Any) -> str:
    """Sentence on the symbols of a term, for messages."""
    kinds = [f"{name}{' (3,)' if value.ufl_shape else ''}" for name, value in parameters._asdict().items()]
    return f"state has u, X, x, F and n, parameters {'the fields ' + ', '.join(kinds) if kinds else 'is empty'}"


def fault(term: Any, dimension: int, kinds: Kinds) -> str:
    """Sentence on a fault in the energy or virtual work of a term; empty if there is none.

    Args:
        term: The term.
        dimension: Dimension of its part.
        kinds: Kinds of its parameters.
    """
    try:
        return _fault(trial(term, dimension, kinds).form, callable(getattr(term, "energy", None)), dimension)
    except UnfitError as error:
        vectors = [name for name, kind, size in kinds if (kind, size) == ("constant", 3)]
        shapes = f" ({', '.join(vectors)}: shape (3,) is one vector; numbers of cells have the shape (cells, 1))"
        return f"has {error.call} that {error.words}{shapes if vectors else ''}"


class Trial(NamedTuple):
    """Integral of a term on symbols without a mesh.

    Attributes:
        form: The integral.
        oriented: True if it asks for the normal of its part.
    """

    form: ufl.Form
    oriented: bool


def trial(term: Any, dimension: int, kinds: Kinds) -> Trial:
    """Try the method of a term.

    Raises:
        UnfitError: It fails, or returns no scalar in UFL.
    """
    u, v, weight, T, domain = _symbols(dimension)
    state = State(u, ufl.SpatialCoordinate(domain), T + ufl.grad(u) * T)
    form = integral(term, state, _parameters(dimension, kinds), weight, v, domain)
    return Trial(form, state.has_asked_for_n)


def signature(term: Any, kinds: Kinds) -> str:
    """Digest of the energy or virtual work of a term, which is another for another formula."""
    found = []
    for dimension in (2, 1):
        try:
            form = trial(term, dimension, kinds).form
        except UnfitError:
            found.append("")
            continue
        weight, domain = _symbols(dimension)[2], _symbols(dimension)[4]
        numbers = [p if p.ufl_shape == () else p[0] for p in _parameters(dimension, kinds)]
        every = sum(numbers, ufl.as_ufl(0.0)) if numbers else 1.0
        found.append((form + weight * every * ufl.dx(domain)).signature())  # it numbers those in use
    return " ".join(found)


@lru_cache(maxsize=256)
def _fault(form: ufl.Form, energy: bool, dimension: int) -> str:
    u, v, *_ = _symbols(dimension)
    if not energy:
        try:
            check_form_arity(expand_derivatives(form), (v,))
            linear = form.arguments() == (v,)
        except (ArityMismatch, ValueError):  # some UFLs fail while they word the first
            linear = False
        return "" if linear else "has a virtual work that is not linear in v; each of its terms must have v once"
    if expand_derivatives(ufl.derivative(form, u, v)).empty():
        return (
            "has an energy that does not depend on the displacement; write it in state.u, state.x, state.F or state.n"
        )
    return ""


@lru_cache
def _symbols(dimension: int) -> tuple[Any, Any, Any, Any, Any]:
    """Displacement, virtual displacement, weight, frame and domain, without a mesh."""
    from .. import _dolfinx  # noqa: PLC0415  (plain data without terms needs no dolfinx)

    V, W = _dolfinx.abstract_space("Lagrange", 1, dimension, 3), _dolfinx.abstract_space("DG", 0, dimension, 1)
    frame = own_formulas.Coefficient(_dolfinx.abstract_space("DG", 0, dimension, 3 * dimension))
    T = ufl.as_matrix([[frame[i * dimension + j] for j in range(dimension)] for i in range(3)])
    return (
        own_formulas.Coefficient(V),
        own_formulas.TestFunction(V),
        own_formulas.Coefficient(W)[0],
        T,
        _dolfinx.abstract_mesh(dimension),
    )


@lru_cache
def _parameters(dimension: int, kinds: Kinds) -> Any:
    from .. import _dolfinx  # noqa: PLC0415  (plain data without terms needs no dolfinx)

    domain = _symbols(dimension)[-1]
    found: dict[str, Any] = {}
    for name, kind, size in kinds:
        if kind == "constant":
            found[name] = own_formulas.Constant(domain, shape=(size,) if size > 1 else ())
        else:
            field = own_formulas.Coefficient(_dolfinx.abstract_space("DG", 0, dimension, size))
            found[name] = field if size > 1 else field[0]
    return named(found)


def named(symbols: Mapping[str, Any]) -> Any:
    """Parameters by name, in the order of the fields."""
    return namedtuple("Parameters", symbols)(**symbols)
