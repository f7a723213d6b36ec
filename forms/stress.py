"""Stress measures: 2nd Piola-Kirchhoff, Cauchy and its principal values, Gil (19), (32)."""

from __future__ import annotations

from ufl import Identity, as_vector, cross, diff, dot, inner, outer, sqrt, sym, tr
from ufl.core.expr import Expr

from .kinematics import unit


def second_piola_kirchhoff(w: Expr, E: Expr) -> Expr:
    """Second Piola-Kirchhoff stress with respect to the prestressed configuration, shape (d, d) [N/m or N].

    Args:
        w: Strain energy per prestressed area or length, a scalar [J/m2 or J/m].
        E: Green-Lagrange strain, a `ufl.variable` of shape (d, d) [-].

    Source:
        Gil (32): of the energy (40) it is sigma0 + C : E.
    """
    return sym(diff(w, E))  # Gil (32); an energy in E12 alone has all of the shear in one place


def cauchy(F: Expr, S: Expr, J: Expr) -> Expr:
    """Cauchy stress in global axes, shape (3, 3): force per current length [N/m] (d = 2) or force [N] (d = 1).

    Args:
        F: Deformation gradient, shape (3, d) [-].
        S: Second Piola-Kirchhoff stress, shape (d, d) [N/m or N].
        J: Ratio of current to reference measure [-]: `kinematics.stretch_ratio` for the physical stress,
            `kinematics.projected_ratio` for the one in the paper's Table 2.

    Source:
        Gil (19).
    """
    return F * S * F.T / J  # Gil (19)


def principal(sigma: Expr, F: Expr) -> Expr:
    """Principal values of a membrane's Cauchy stress, the larger first, shape (2,) [N/m].

    Args:
        sigma: Cauchy stress in global axes, shape (3, 3) [N/m].
        F: Deformation gradient, shape (3, 2) [-].
    """
    n = unit(cross(F[:, 0], F[:, 1]))
    mean = tr(sigma) / 2
    deviator = sigma - mean * (Identity(3) - outer(n, n))  # its own norm: no digits lost for equal values
    radius = sqrt(inner(deviator, deviator) / 2)  # radius of Mohr's circle
    return as_vector([mean + radius, mean - radius])


def warp_weft_stress(sigma: Expr, F: Expr) -> Expr:
    """Warp and weft stress, normal components of a membrane's Cauchy stress along both yarns, shape (2,) [N/m].

    Args:
        sigma: Cauchy stress in global axes, shape (3, 3) [N/m].
        F: Deformation gradient, shape (3, 2) [-].
    """
    threads = [unit(F[:, 0]), unit(F[:, 1])]
    return as_vector([dot(thread, sigma * thread) for thread in threads])
