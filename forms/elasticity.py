"""Prestressed Saint Venant-Kirchhoff elasticity: membrane (isotropic, orthotropic) and bar, Gil (40)."""

from __future__ import annotations

from ufl import Identity, as_matrix, inner, tr
from ufl.core.expr import Expr


def isotropic(E: Expr, Et: Expr, nu: Expr) -> Expr:
    """Stress increment C : E of an isotropic membrane in plane stress, shape (2, 2) [N/m].

    Args:
        E: Green-Lagrange strain in any tangent frame, shape (2, 2) [-].
        Et: Young's modulus times thickness [N/m].
        nu: Poisson's ratio [-].

    Source:
        Gil (31), (67) in plane stress.
    """
    return Et / (1 - nu**2) * ((1 - nu) * E + nu * tr(E) * Identity(2))


def orthotropic(E: Expr, Et_warp: Expr, Et_weft: Expr, nu: Expr, Gt: Expr) -> Expr:
    """Stress increment C : E of a woven fabric in plane stress, shape (2, 2) [N/m].

    Args:
        E: Green-Lagrange strain in the warp/weft frame, shape (2, 2) [-].
        Et_warp: Modulus times thickness along the warp [N/m].
        Et_weft: Modulus times thickness along the weft [N/m].
        nu: Poisson's ratio: contraction of the weft under tension in the warp [-].
        Gt: Shear modulus times thickness [N/m].

    Source:
        Gil (31) with the symmetric compliance [1/Et_warp, -nu/Et_warp; -nu/Et_warp, 1/Et_weft].
    """
    nu_weft = nu * Et_weft / Et_warp
    D = 1 - nu * nu_weft
    S11 = Et_warp / D * (E[0, 0] + nu_weft * E[1, 1])
    S22 = Et_weft / D * (E[1, 1] + nu * E[0, 0])
    S12 = Gt * (E[0, 1] + E[1, 0])
    return as_matrix([[S11, S12], [S12, S22]])


def isotropic_compliance(S: Expr, Et: Expr, nu: Expr) -> Expr:
    """Strain C^-1 : S of an isotropic membrane in plane stress, shape (2, 2) [-]; arguments as for `isotropic`."""
    return ((1 + nu) * S - nu * tr(S) * Identity(2)) / Et


def orthotropic_compliance(S: Expr, Et_warp: Expr, Et_weft: Expr, nu: Expr, Gt: Expr) -> Expr:
    """Strain C^-1 : S of a woven fabric in plane stress, shape (2, 2) [-]; arguments as for `orthotropic`."""
    E11 = (S[0, 0] - nu * S[1, 1]) / Et_warp
    E22 = S[1, 1] / Et_weft - nu * S[0, 0] / Et_warp
    E12 = S[0, 1] / (2 * Gt)
    return as_matrix([[E11, E12], [E12, E22]])


def axial(E: Expr, EA: Expr) -> Expr:
    """Stress increment C : E of a cable or a mast, shape (1, 1) [N].

    Args:
        E: Green-Lagrange strain, shape (1, 1) [-].
        EA: Young's modulus times cross-section [N].
    """
    return EA * E


def strain_energy(E: Expr, sigma0: Expr, CE: Expr) -> Expr:
    """Strain energy per prestressed area or length, a scalar [J/m2 or J/m].

    Args:
        E: Green-Lagrange strain in the tangent frame, shape (d, d) [-].
        sigma0: Cauchy prestress in the tangent frame, shape (d, d) [N/m or N].
        CE: Stress increment C : E, shape (d, d) [N/m or N].

    Source:
        Gil (40), (69).
    """
    return inner(sigma0, E) + inner(CE, E) / 2  # Gil (40)
