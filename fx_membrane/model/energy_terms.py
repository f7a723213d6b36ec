"""The contract of energy terms, and their check on entry: loads, contact and elastic beds of a user's own.

A term is a frozen dataclass. It has

    part                                 name of the part on which it acts

and one of

    energy(state, parameters)            energy per reference area or length, a scalar in UFL [J/m2 or J/m]
    virtual_work(state, v, parameters)   virtual work of its forces on v, per reference area or length, linear in v:
                                         for forces without a potential. The tangent is then unsymmetric, and the work
                                         is not in the recorded energy.

and may have

    cells                                numbers of the cells on which it acts; all of them without it, or if None
    quadrature_degree                    degree of polynomials that are integrated exactly; 2 without it

`state` has the symbols u, X, x, F and n, see `forms.energy_terms.State`. All other fields are parameters: numbers,
vectors (3,), or one of these per cell of `cells` (or of the part), shape (cells,), (cells, 1) or (cells, 3); shape (3,)
is always one vector. `parameters` has them by name, as constants or coefficients in UFL: another number, another load
factor compiles nothing. A number from `self` is compiled into the form, and each value compiles another.

A term acts in two places. In `Stage(loads=[...])` it is a load: the load factor scales it, and later stages keep it. In
`Structure(..., terms=[...])` it always acts in full. Its forces count as loads in all results.

The density is integrated over the whole part, with a weight of zero outside `cells`: it must be finite there, too.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from ..checks import validation
from ..checks.values import expected, with_article
from . import own_classes, term_trial
from .term_parameters import described, kinds, names, values

METHODS = ("energy", "virtual_work")
MAX_DEGREE = 30  # quadrature degree


class EnergyTerm(Protocol):
    """Energy term of your own: a frozen dataclass with a part, parameters and an energy in UFL.

    It need not be derived from this class. The module `fx_membrane.model.energy_terms` says what else it may have.

    Example:
        >>> from dataclasses import dataclass
        >>> @dataclass(frozen=True)
        ... class ElasticBed:
        ...     part: str
        ...     k: float  # [N/m3]
        ...     def energy(self, state, parameters):
        ...         return parameters.k * state.u[2] ** 2 / 2
        ...
        >>> Stage("lowered", [ElasticBed("roof", k=2e4)]).loads[0]
        ElasticBed(part='roof', k=20000.0)
    """

    if TYPE_CHECKING:  # a property of this class would take the place of a derived dataclass's field

        @property
        def part(self) -> str:
            """Name of the part."""
            ...

    @abstractmethod
    def energy(self, state: Any, parameters: Any) -> Any:
        """Energy per reference area [J/m2] or length [J/m] in UFL, a scalar."""
        ...


class ForceTerm(Protocol):
    """Term of your own that has no potential: like `EnergyTerm`, with the virtual work of its forces.

    Example:
        A pressure that grows with depth, on a surface with a free edge:

        >>> from dataclasses import dataclass
        >>> from ufl import conditional, dot, gt
        >>> @dataclass(frozen=True)
        ... class Water:
        ...     part: str
        ...     weight: float  # [N/m3]
        ...     level: float  # [m]
        ...     def virtual_work(self, state, v, parameters):
        ...         depth = parameters.level - state.x[2]
        ...         # It stands on the side of the normals, and presses against them.
        ...         return -parameters.weight * conditional(gt(depth, 0), depth, 0) * dot(state.n, v)
        ...
        >>> Stage("flood", [Water("dam", weight=9810.0, level=0.5)]).loads[0]
        Water(part='dam', weight=9810.0, level=0.5)
    """

    if TYPE_CHECKING:  # a property of this class would take the place of a derived dataclass's field

        @property
        def part(self) -> str:
            """Name of the part."""
            ...

    @abstractmethod
    def virtual_work(self, state: Any, v: Any, parameters: Any) -> Any:
        """Virtual work per reference area or length in UFL, a scalar, linear in v."""
        ...


Term = EnergyTerm | ForceTerm


class Acting(NamedTuple):
    """A term and its factor."""

    term: Any
    factor: float


def is_term(value: Any) -> bool:
    """Return True if an object is meant as an energy term: an instance with one of the two methods."""
    return not isinstance(value, type) and any(callable(getattr(value, name, None)) for name in METHODS)


def checked(what: str, values: Any, others: Any = None) -> tuple[Any, ...]:
    """Make a tuple of terms, and of objects of other classes, from any sequence of them.

    Args:
        what: Name of the sequence.
        values: The sequence.
        others: A class, or several joined by |, of objects that are no terms; None for terms alone.

    Raises:
        ValueError: It is no sequence; an object is neither a term nor of these classes; a term does not keep to its
            contract.
    """
    words, example = "energy terms", ""
    if others is not None:
        words, example = f"{expected(others)}, or of energy terms", others.__args__[0].__name__
    alone = is_term(values) or (others is not None and isinstance(values, others))
    validation.listed(what, values, words, example, alone)
    for value in values:
        if is_term(value):
            check(what, value)
        elif isinstance(value, type) and any(hasattr(value, name) for name in METHODS):
            raise ValueError(f"{what} has the class {value.__name__}; give an object, with brackets behind its name.")
        elif others is None or (hasattr(value, "part") and not isinstance(value, others)):
            raise ValueError(
                f"{what} has {validation.short_repr(value)}; give energy terms, objects of classes with the method "
                "energy(state, parameters) or virtual_work(state, v, parameters)."
            )
        else:
            validation.instances(what, [value], others)
    return tuple(values)


def is_conservative(term: Any) -> bool:
    """Return True if a term has an energy."""
    return callable(getattr(term, "energy", None))


def check(what: str, term: Any) -> None:
    """Check the fields of a term, and keep them as numbers, texts and read-only arrays.

    Raises:
        ValueError: It does not keep to the contract in the docstring of the module.
    """
    kind = type(term)
    named = f"{what} has {with_article(kind.__name__)}"
    if all(callable(getattr(term, name, None)) for name in METHODS):
        raise ValueError(f"{named} with energy and virtual_work; define one of the two: the energy, if there is one.")
    own_classes.check(named, kind, METHODS, "term")
    if not hasattr(term, "part"):
        raise ValueError(f"{named} without a part; add the field part, the name of the part on which it acts.")
    name = f"{what}: {kind.__name__}"
    validation.text(f"{name} part", term.part)
    degree = getattr(term, "quadrature_degree", 1)
    validation.positive_integer(f"{name} quadrature_degree", degree, most=MAX_DEGREE)
    if getattr(term, "cells", None) is not None:
        validation.keep(term, cells=validation.unique_indices(f"{name} cells", term.cells, "cell"))
    for entry in names(term):
        if entry.startswith("_"):
            raise ValueError(f"{name} has a parameter {entry}; give it a name without an underscore before it.")
        given = getattr(term, entry)
        if np.ndim(given) == 0:  # a text or None has no other shape either
            value: Any = validation.number(f"{name} {entry}", given)
        else:
            value = validation.finite(f"{name} {entry}", given)
        validation.keep(term, **{entry: value})


def check_on(structure: Any, what: str, term: Any) -> None:
    """Refuse a term that does not fit a structure, or whose energy is no energy.

    Args:
        structure: The structure.
        what: Where the term is given, "Stage 'snow'".
        term: The term.

    Raises:
        ValueError: The part or a cell does not exist; an array has another length; the method fails, returns no scalar
            in UFL, or one that does not depend on the displacement; it asks for a normal of a surface that has none.
    """
    if term.part not in structure.parts:
        raise ValueError(
            f"{what} has {with_article(type(term).__name__)} on part {term.part!r}, which does not exist; the parts "
            f"are {list(structure.parts)}."
        )
    part, named = structure.parts[term.part], f"{what}: {described(term)}"
    if getattr(term, "cells", None) is not None:
        validation.in_range(named, np.asarray(term.cells), len(part.cells), "cell")
    values(term, len(part.cells), named)
    fault = term_trial.fault(term, part.dimension, kinds(term))
    if fault:
        raise ValueError(f"{named} {fault}.")
    if term_trial.trial(term, part.dimension, kinds(term)).oriented:
        structure.check_sides(term.part)
