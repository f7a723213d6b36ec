"""Work of the loads: those of fixed direction have a potential, a follower pressure has a virtual work.

Gil (54)-(57), (68).
"""

from __future__ import annotations

from ufl import cross, dot
from ufl.core.expr import Expr


def distributed_load(q: Expr, v: Expr) -> Expr:
    """Virtual work of a load of fixed direction, per reference area or length, a scalar [J/m2 or J/m].

    Linear in v: with u for v it is minus the external potential energy.

    Args:
        q: Load per reference area [N/m2] (d = 2) or per reference length [N/m] (d = 1), shape (3,).
        v: Virtual displacement, shape (3,) [m].

    Source:
        Gil (44), (47), (68).
    """
    return dot(q, v)


def follower_pressure(p: Expr, F: Expr, v: Expr) -> Expr:
    """Virtual work of a pressure along the current normal, per reference area, a scalar [J/m2].

    Args:
        p: Pressure, positive along warp x weft [Pa].
        F: Deformation gradient, shape (3, 2) [-].
        v: Virtual displacement, shape (3,) [m].

    Source:
        Gil (54)-(56); its derivative is (57).
    """
    return p * dot(cross(F[:, 0], F[:, 1]), v)  # Gil (55): J F^-T n is the current area vector
