"""Work of the inertia forces: mass moves with the material and is given per reference area or length."""

from __future__ import annotations

from ufl import dot
from ufl.core.expr import Expr


def inertia(m: Expr, a: Expr, v: Expr) -> Expr:
    """Virtual work against the inertia forces, per reference area or length, a scalar [J/m2 or J/m].

    Bilinear in a and v: with the displacement's shape functions for both it is the consistent mass matrix.

    Args:
        m: Mass per reference area [kg/m2] (d = 2) or per reference length [kg/m] (d = 1).
        a: Acceleration, shape (3,) [m/s2].
        v: Virtual displacement, shape (3,) [m].

    Source:
        d'Alembert's principle.
    """
    return m * dot(a, v)
