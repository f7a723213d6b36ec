"""Derivatives of the residual of a part by its parameters, compiled on first use."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem

from .. import _dolfinx
from .forms_of_parts import PartForms


class DirectedForm(NamedTuple):
    """Compiled derivative of the residual by a parameter, and its direction: a change of the parameter."""

    form: Any
    direction: fem.Function | fem.Constant


def rope_pull(part: PartForms) -> DirectedForm | None:
    """Differentiate the length of a rope, times a number; None for other parts."""

    def make(part: PartForms) -> DirectedForm:
        assert part.rope
        factor = fem.Constant(part.mesh.mesh, np.float64(1.0))
        return DirectedForm(_dolfinx.form(factor * part.rope.length), factor)

    return part.compiled("pull", make) if part.rope else None


def by_modulus(part: PartForms, name: str) -> DirectedForm:
    """Differentiate the residual by a number of the material."""

    def make(part: PartForms) -> DirectedForm:
        direction = fem.Constant(part.mesh.mesh, np.float64(1.0))
        modulus = ufl.variable(part.moduli[name])
        potential = ufl.diff(ufl.replace(part.potential, {part.moduli[name]: modulus}), modulus)
        v = ufl.TestFunction(part.mesh.u.function_space)
        return DirectedForm(_dolfinx.form(direction * ufl.derivative(potential, part.mesh.u, v)), direction)

    return part.compiled(f"by {name}", make)


def by_prestress(part: PartForms) -> DirectedForm:
    """Differentiate the residual by the prestress."""
    return _by_field(part, "prestress")


def by_natural_shape(part: PartForms) -> DirectedForm:
    """Differentiate the residual by H of the natural shape."""
    return _by_field(part, "natural")


def by_tensions(part: PartForms) -> DirectedForm:
    """Differentiate the residual by the share of the law and the force beside it."""
    return _by_field(part, "tensions")


def _by_field(part: PartForms, name: str) -> DirectedForm:
    """Differentiate the residual by a field of the forms, that of the attribute of this name."""

    def make(part: PartForms) -> DirectedForm:
        field = getattr(part, name)
        direction = fem.Function(field.function_space)
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return DirectedForm(_dolfinx.form(ufl.derivative(residual, field, direction)), direction)

    return part.compiled(f"by the field {name}", make)
