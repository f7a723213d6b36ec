"""Derivatives of the residual of a part by its parameters, compiled on first use."""

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

    def make(part: PartForms) -> DirectedForm:
        direction = fem.Function(part.prestress.function_space)
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return DirectedForm(_dolfinx.form(ufl.derivative(residual, part.prestress, direction)), direction)

    return part.compiled("by prestress", make)


def by_natural_shape(part: PartForms) -> DirectedForm:
    """Differentiate the residual by H of the natural shape."""

    def make(part: PartForms) -> DirectedForm:
        assert part.natural is not None
        direction = fem.Function(part.natural.function_space)
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return DirectedForm(_dolfinx.form(ufl.derivative(residual, part.natural, direction)), direction)

    return part.compiled("by natural shape", make)


def by_tensions(part: PartForms) -> DirectedForm:
    """Differentiate the residual by the share of the law and the force beside it."""

    def make(part: PartForms) -> DirectedForm:
        assert part.tensions is not None
        direction = fem.Function(part.tensions.function_space)
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return DirectedForm(_dolfinx.form(ufl.derivative(residual, part.tensions, direction)), direction)

    return part.compiled("by tensions", make)
