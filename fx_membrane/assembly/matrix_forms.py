"""Forms of matrices that are the same in every state: the mass matrix, and the stabilization matrix."""

from __future__ import annotations

from typing import Any

import numpy as np
import ufl
from dolfinx import fem

from .. import _dolfinx
from ..forms import kinematics, mass
from .forms_of_parts import PartForms, stiffness
from .kinds_of_forms import named


def mass_form(part: PartForms) -> Any:
    """Compiled work of the inertia forces of a part, its consistent mass matrix; the same in every state."""
    return part.compiled("mass", _mass_form)


def _mass_form(part: PartForms) -> Any:
    V = part.mesh.u.function_space
    m = fem.Constant(part.mesh.mesh, np.float64(part.mesh.part.mass))
    dx = ufl.Measure("dx", domain=part.mesh.mesh, metadata={"quadrature_degree": 2})  # exact: a product of linear ones
    return _dolfinx.form(mass.inertia(m, ufl.TrialFunction(V), ufl.TestFunction(V)) * dx, named("mass", part.kind))


def tension_form(part: PartForms) -> Any:
    """Compiled stiffness against displacement gradients of a tension that equals the part's own stiffness."""
    V = part.mesh.u.function_space
    k = fem.Constant(part.mesh.mesh, np.float64(stiffness(part.mesh.part)))
    dx = ufl.Measure("dx", domain=part.mesh.mesh, metadata={"quadrature_degree": 1})  # exact: constant per cell
    gradients = [kinematics.displacement_gradient(v, part.T) for v in (ufl.TrialFunction(V), ufl.TestFunction(V))]
    return _dolfinx.form(k * ufl.inner(*gradients) * dx, named("tension", part.kind))
