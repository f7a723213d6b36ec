"""The contract of a material law, and its members. `law_check` refuses laws that break it.

A law is a frozen dataclass: its fields are its parameters, finite numbers. It has

    energy(E, sigma0, parameters)            strain energy per reference area or length, a scalar in UFL
    stiffness                                a typical stiffness [N/m], of bars [N]

and may have

    relaxed_energy(E, sigma0, parameters)    `forms.wrinkling.Relaxed`, or None: the law carries compression. Without
                                             this method the tension field is found cell by cell from the energy.
                                             Where nothing is compressed, its stress is that of the energy.
    strain(stress)                           Green-Lagrange strains of cells under stresses, both (n, d, d), or None
    strain_limit                             strain above which `LargeStrainWarning` warns, none by default [-]
    dimension                                2 for membranes alone, 1 for bars alone
    directed                                 True if the law has a warp and a weft; by default the energy tells

E is the Green-Lagrange strain and sigma0 the prestress, both of shape (d, d) in UFL; d is 2 in membranes (warp, weft)
and 1 in bars. `parameters` has the fields of the law by name, as constants in UFL: another number compiles nothing. The
stress at E = 0 is the prestress, as by the term inner(sigma0, E).

Members that a class inherits from one with another energy belong to that energy, and are not used.
"""

from __future__ import annotations

import dataclasses
from collections import namedtuple
from collections.abc import Callable
from functools import lru_cache
from typing import Any, Protocol, cast

import numpy as np
import ufl
from numpy.typing import NDArray
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering

from ..checks import validation
from . import own_formulas
from .own_classes import home

Array = NDArray[np.float64]

SAMPLES = (-0.2, -0.01, 0.003, 0.05, 0.4, 3.0)  # strains at which energies are compared
CALL = "energy(E, sigma0, parameters)"
EXAMPLE = "inner(sigma0, E) + parameters.k * inner(E, E) / 2"
REST_STRAIN = 1e-4  # strain of differences at rest
STRETCHES = np.geomspace(1e-3, 1e4, 36)  # strains at which a compressive prestress may be taken up


class Law(Protocol):
    """Material law: an energy in UFL and its parameters. The module says what else it may have.

    A law of your own is a frozen dataclass, derived from this class or from none.

    Take numbers from `parameters`: one from `self` is compiled into the form, and each value compiles another.

    Example:
        >>> from dataclasses import dataclass
        >>> from ufl import inner
        >>> @dataclass(frozen=True)
        ... class Stiffening:
        ...     EA: float  # [N]
        ...     k: float  # [N]
        ...     def energy(self, E, sigma0, parameters):
        ...         e = E[0, 0]
        ...         return inner(sigma0, E) + parameters.EA * e**2 / 2 + parameters.k * e**4 / 4
        ...     @property
        ...     def stiffness(self):
        ...         return self.EA
        ...
        >>> Cable([[0, 1]], material=Stiffening(1e6, 4e6)).axial_stiffness
        1000000.0
    """

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        """Strain energy per reference area [J/m2] or length [J/m] in UFL, a scalar."""
        ...

    @property
    def stiffness(self) -> float:
        """Typical stiffness [N/m], of bars [N]."""
        ...


def parameters(law: Law, make: Callable[[float], Any]) -> Any:
    """Parameters of a law by name, each made from its number."""
    values = {entry.name: make(float(getattr(law, entry.name))) for entry in dataclasses.fields(cast(Any, law))}
    return namedtuple("Parameters", values)(**values)


def member(law: Law, name: str) -> Any:
    """Look up an optional member of a law; None if the class has none, or one that belongs to another energy."""
    return getattr(law, name, None) if _has_own(type(law), name) else None


def strain(law: Law, stress: Array) -> Array | None:
    """Green-Lagrange strains of cells under stresses, both of shape (n, d, d); None if the law has no compliance."""
    found = member(law, "strain")
    return None if found is None else found(stress)


def strain_limit(law: Law) -> float:
    """Strain above which the law is not meant to be used [-]."""
    limit = member(law, "strain_limit")
    return np.inf if limit is None else float(limit)


def is_directed(law: Law) -> bool:
    """Return True if a membrane law has a warp and a weft."""
    directed = member(law, "directed")
    return _differs_by_direction(law) if directed is None else bool(directed)


def is_mirror_symmetric(law: Law) -> bool:
    """Return True if the energy of a membrane law is the same for the opposite shear: seen from the other side."""
    turned = np.diag([1.0, -1.0])
    sigma0 = float(law.stiffness) * np.array([[0.02, 0.006], [0.006, 0.01]])
    for size in (0.003, 0.05):
        E = size * np.array([[0.8, 0.5], [0.5, 0.3]])
        rest = value(law, 0 * E, sigma0)
        here, there = value(law, E, sigma0), value(law, turned @ E @ turned, turned @ sigma0 @ turned)
        if not abs(there - here) <= 1e-9 * abs(here - rest):
            return False
    return True


def carries_compression(law: Law, dimension: int) -> bool:
    """Return True if a law says that it has no relaxed energy."""
    if not _has_own(type(law), "relaxed_energy"):
        return False
    relaxed = member(law, "relaxed_energy")
    if relaxed is None:
        return True
    zero = ufl.as_matrix(np.zeros((dimension, dimension)).tolist())
    return relaxed(ufl.variable(zero), zero, parameters(law, ufl.as_ufl)) is None


def energies(law: Law, dimension: int) -> list[str]:
    """Values of the energy at some strains, as texts, none beyond its range: another energy has others."""
    sigma0 = float(law.stiffness) * np.diag([0.02, 0.01])[:dimension, :dimension]
    shapes = [np.eye(1)] if dimension == 1 else [np.diag([1.0, 0.0]), np.array([[0.3, 0.4], [0.4, 1.0]])]
    return [_text(law, size * shape, sigma0) for shape in shapes for size in SAMPLES]


def check_prestress(what: str, law: Law, tensors: Array) -> None:
    """Refuse a compressive prestress that no stretch takes up, where the strain without stress must be found.

    Args:
        what: Name of the argument.
        law: A law that `check` has passed.
        tensors: Prestress of the cells, shape (n, d, d).
    """
    if member(law, "relaxed_energy") is not None:
        return
    values, directions = np.linalg.eigh(tensors)
    cell = int(values[:, 0].argmin())
    if values[cell, 0] >= 0:
        return
    along = np.outer(directions[cell, :, 0], directions[cell, :, 0])
    try:
        falls = np.diff([value(law, strain * along, tensors[cell]) for strain in (0.0, *STRETCHES)]) < 0
    except (ArithmeticError, ValueError):  # beyond a limited range
        return
    if falls.all():
        raise ValueError(
            f"{what} is {values[cell, 0]:g} in cell {cell}, an excess that no stretch of "
            f"{validation.short_repr(law)} takes up; give a smaller one."
        )


def _text(law: Law, E: Array, sigma0: Array) -> str:
    try:
        return f"{value(law, E, sigma0):.9e}"
    except (ArithmeticError, ValueError):  # as the logarithm of a negative number
        return "none"


def elasticity(law: Law, dimension: int) -> Array:
    """Differentiate the stress by the strain, at rest without prestress, shape (d, d, d, d) [N/m, of bars N].

    From differences of the energy, which are exact to rounding where it is quadratic. Strips of a roof share a law: it
    is asked once.
    """
    try:
        return _elasticity(cast("Any", law), dimension)
    except TypeError:  # its class has no hash
        return _elasticity.__wrapped__(law, dimension)


@lru_cache(maxsize=64)
def _elasticity(law: Law, dimension: int) -> Array:
    pairs = [(0, 0)] if dimension == 1 else [(0, 0), (1, 1), (0, 1)]
    basis = [np.zeros((dimension, dimension)) for _ in pairs]
    for unit, (i, j) in zip(basis, pairs, strict=True):
        unit[i, j] = unit[j, i] = 1.0 if i == j else 0.5
    none = np.zeros((dimension, dimension))
    rest = value(law, none, none)

    def curvature(E: Array) -> float:
        return (value(law, REST_STRAIN * E, none) + value(law, -REST_STRAIN * E, none) - 2 * rest) / REST_STRAIN**2

    found = np.zeros((dimension,) * 4)
    for row, (a, (i, j)) in enumerate(zip(basis, pairs, strict=True)):
        for b, (k, m) in list(zip(basis, pairs, strict=True))[row:]:
            entry = curvature(a) if a is b else (curvature(a + b) - curvature(a - b)) / 4
            for p, q in {(i, j), (j, i)}:
                for r, t in {(k, m), (m, k)}:
                    found[p, q, r, t] = found[r, t, p, q] = entry
    found.flags.writeable = False
    return found


def value(law: Law, E: Array, sigma0: Array) -> float:
    """Energy of a law at a strain under a prestress, both (d, d), by UFL's own evaluation."""
    return float(apply_algebra_lowering(energy(law, ufl.as_matrix(E.tolist()), sigma0))(()))


def energy(law: Law, E: Any, sigma0: Array) -> Any:
    """Energy of a law in UFL at a strain in UFL under a prestress, both (d, d).

    Raises:
        UnfitError: It is no scalar in UFL.
    """
    return formula(law, ufl.variable(E), ufl.as_matrix(sigma0.tolist()), parameters(law, ufl.as_ufl))


def formula(law: Law, E: Any, sigma0: Any, numbers: Any) -> Any:
    """Energy of a law in UFL of any symbols.

    Raises:
        UnfitError: It is no scalar in UFL.
    """
    return own_formulas.scalar(law.energy, CALL, (E, sigma0, numbers), symbols(law, E), EXAMPLE)


def symbols(law: Law, E: Any) -> str:
    """Sentence on the arguments of an energy, for messages."""
    names = ", ".join(entry.name for entry in dataclasses.fields(cast(Any, law)))
    return (
        f"E and sigma0 have the shape {E.ufl_shape}, parameters the numbers {names}"
        if names
        else (f"E and sigma0 have the shape {E.ufl_shape}, parameters is empty")
    )


def _differs_by_direction(law: Law) -> bool:
    """Return True if the energy of a membrane law differs for a strain that is turned in the plane."""
    c, s = np.cos(0.4), np.sin(0.4)
    Q, E, none = np.array([[c, -s], [s, c]]), np.diag([0.05, 0.01]), np.zeros((2, 2))
    rest, along, turned = (value(law, strain, none) for strain in (none, E, Q @ E @ Q.T))
    return not abs(turned - along) <= 1e-9 * abs(along - rest)


def _has_own(kind: type, name: str) -> bool:
    """Return True if a class has a member that does not belong to another energy."""
    found = home(kind, name)
    return found is not None and (found is kind or "energy" not in vars(found))
