"""Refusal of relaxed energies that contradict the energy of their law."""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray
from ufl.algorithms.apply_algebra_lowering import apply_algebra_lowering

from ..forms.wrinkling import SLACK, TAUT, WRINKLED, Relaxed
from . import laws, own_formulas

Array = NDArray[np.float64]

CALL = "relaxed_energy(E, sigma0, parameters)"
DIFFERENCE_STRAIN = 1e-4  # strain of difference quotients
ERROR = 1e-3  # error of a slope, over the largest
EXTENDED = np.array([[0.01, 0.002], [0.002, 0.008]])  # strain, taut under a prestress without compression
COMPRESSED = (np.diag([0.05, -0.2]), np.diag([-0.2, 0.05]), np.diag([-0.2, -0.1]))
STATES = "fx_membrane.forms.wrinkling.TAUT, WRINKLED or SLACK (0, 1 or 2)"


def fault(law: laws.Law, sigma0: Array, symbols: tuple[Any, Any, Any]) -> str:
    """Sentence on a fault in the relaxed energy of a law; empty if there is none, or no relaxed energy.

    Args:
        law: A law, whose energy has no fault.
        sigma0: Prestress of the trial without compression, shape (d, d) [N/m or N].
        symbols: Strain, prestress and parameters without values.
    """
    formula = laws.member(law, "relaxed_energy")
    if formula is None:
        return ""
    for E, given, numbers in (symbols, _numbers(law, 0 * sigma0, sigma0)):
        found = own_formulas.called(formula, CALL, (E, given, numbers), laws.symbols(law, E))
        if found is None:
            continue
        if not isinstance(found, Relaxed):
            return (
                f"{CALL} returns {own_formulas.described(found)}; return a fx_membrane.forms.wrinkling.Relaxed("
                "energy, state), or None for a law that carries compression"
            )
        for name, entry in found._asdict().items():
            if not _is_scalar(entry):
                return f"{CALL} returns a Relaxed whose {name} is {own_formulas.described(entry)}; give a scalar in UFL"
    if found is None:
        return ""
    return _energy_fault(law, sigma0) or _state_fault(law, sigma0)


def _energy_fault(law: laws.Law, sigma0: Array) -> str:
    """Sentence on another stress than that of the energy where both principal stresses are tensions."""
    for E in _taut(law, sigma0):
        wanted = _stress(lambda at: laws.value(law, at, sigma0), E)
        try:
            stress = _stress(lambda at: _value(law, at, sigma0, "energy"), E)
        except (ArithmeticError, ValueError):
            stress = np.full(E.shape, np.nan)
        error = np.abs(stress - wanted)
        if not (error <= ERROR * np.abs(wanted).max()).all():
            at = np.unravel_index(np.argmax(error), error.shape)
            return (
                f"{CALL} has the stress {stress[at]:.3g} in component {at[0] + 1}{at[1] + 1} at the taut strain "
                f"{E.tolist()} under the prestress {sigma0.tolist()} of a trial, but its energy has {wanted[at]:.3g}; "
                "without compression both must be equal: take the same moduli and sigma0 in both, or leave "
                "relaxed_energy out"
            )
    return ""


def _state_fault(law: laws.Law, sigma0: Array) -> str:
    """Sentence on a state that is none."""
    d = len(sigma0)
    for E in (*_taut(law, sigma0), *(strain[:d, :d] for strain in COMPRESSED)):
        try:
            state = _value(law, E, sigma0, "state")
        except (ArithmeticError, ValueError):  # beyond a limited range
            continue
        if state not in (TAUT, WRINKLED, SLACK):
            return f"{CALL} has the state {state:g} at the strain {E.tolist()}; give {STATES}"
    return ""


def _taut(law: laws.Law, sigma0: Array) -> list[Array]:
    """Strains at which the stress of the energy has no compression."""
    d, found = len(sigma0), []
    for E in (0 * sigma0, EXTENDED[:d, :d]):
        try:
            stress = _stress(lambda at: laws.value(law, at, sigma0), E)
        except (ArithmeticError, ValueError):  # beyond a limited range
            continue
        if np.isfinite(stress).all() and np.linalg.eigvalsh(stress)[0] > 0:
            found.append(E)
    return found


def _stress(energy: Any, E: Array) -> Array:
    """Differentiate an energy by the strain, by central differences, shape (d, d)."""
    stress = np.zeros(E.shape)
    for i, j in zip(*np.triu_indices(len(E)), strict=True):
        along = np.zeros(E.shape)
        along[i, j] += 0.5
        along[j, i] += 0.5
        stress[i, j] = stress[j, i] = (
            energy(E + DIFFERENCE_STRAIN * along) - energy(E - DIFFERENCE_STRAIN * along)
        ) / (2 * DIFFERENCE_STRAIN)
    return stress


def _value(law: laws.Law, E: Array, sigma0: Array, entry: str) -> float:
    """Entry of the relaxed energy at a strain under a prestress, by UFL's own evaluation."""
    relaxed = laws.member(law, "relaxed_energy")(*_numbers(law, E, sigma0))
    return float(apply_algebra_lowering(ufl.as_ufl(getattr(relaxed, entry)))(()))


def _numbers(law: laws.Law, E: Array, sigma0: Array) -> tuple[Any, Any, Any]:
    strain, stress = (ufl.as_matrix(values.tolist()) for values in (E, sigma0))
    return ufl.variable(strain), stress, laws.parameters(law, ufl.as_ufl)


def _is_scalar(entry: Any) -> bool:
    return isinstance(entry, int | float) or (
        isinstance(entry, ufl.core.expr.Expr) and not (entry.ufl_shape or entry.ufl_free_indices)
    )
