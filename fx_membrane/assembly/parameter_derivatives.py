"""Derivatives of the residual by parameters of parts, energy terms and gas, at a fixed displacement."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, cast

from numpy.typing import ArrayLike
from petsc4py import PETSc

from ..model import energy_terms
from ..model.energy_terms import Term
from . import parameters
from .fitting import check_vector
from .gas_derivatives import by_gas

if TYPE_CHECKING:
    from .problem_under_actions import LoadedProblem


def by_parameter(
    loaded: LoadedProblem, x: PETSc.Vec, part: str | Term, parameter: str, direction: ArrayLike, b: PETSc.Vec
) -> PETSc.Vec:
    """Set a vector to the derivative by a parameter, see `LoadedProblem.derivative` [N per unit of the parameter]."""
    check_vector("x", x, loaded.discretization.rows)
    assembler, structure = loaded.assembler, loaded.structure
    if energy_terms.is_term(part):
        change = parameters.agreed_term_change(loaded.comm, structure, loaded.terms.all, part, parameter, direction)
        assembler.update(x, loaded.cells)
        return loaded.terms.derivative(change, b)
    if isinstance(part, str) and part in structure.chambers and part not in structure.parts:
        return by_gas(loaded, x, part, parameter, direction, b)
    given = parameters.agreed_change(loaded.comm, structure, loaded.actions, cast(str, part), parameter, direction)
    if given.parameter == "natural_stretch":
        assembler.allow_changes([given.part], ())
    if given.parameter == "pressure":
        assembler.update(x, replace(loaded.cells, pressures=given.on_cells(assembler.parts)))
        assembler.vector(lambda part: part.pressure, b).scale(-1.0)
        return b
    assembler.update(x, loaded.cells)
    return assembler.vector(lambda part: given.form(part, assembler.ropes), b)
