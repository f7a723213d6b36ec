"""Incompressible rubber-like membranes in plane stress, for foils: neo-Hooke and Mooney-Rivlin.

The thickness follows from the volume: with C = I + 2 E in the tangent plane the stretch across is det(C)^(-1/2), and

    I1 - 3 = tr(C) + 1 / det(C) - 3,    I2 - 3 = tr(C) / det(C) + det(C) - 3.

Both are written in t = tr(E), d = det(E) and j = det(C) - 1 = 2 t + 4 d, in which small strains keep their digits.
Moduli are times the thickness. The prestress enters as sigma0 : E, so that it is the stress at E = 0.

Source: R. S. Rivlin, Phil. Trans. R. Soc. A 240 (1948) 459-490; M. Mooney, J. Appl. Phys. 11 (1940) 582-592;
G. A. Holzapfel, Nonlinear Solid Mechanics (2000), (6.127), (6.128).
"""

from __future__ import annotations

from ufl import det, inner, tr
from ufl.core.expr import Expr


def neo_hooke(E: Expr, sigma0: Expr, Gt: Expr) -> Expr:
    """Strain energy of a neo-Hookean membrane per reference area, a scalar [J/m2].

    Args:
        E: Green-Lagrange strain in any tangent frame, shape (2, 2) [-].
        sigma0: Cauchy prestress in that frame, shape (2, 2) [N/m].
        Gt: Shear modulus times thickness [N/m].

    Source:
        Holzapfel (6.128).
    """
    return inner(sigma0, E) + Gt / 2 * first_invariant(E)  # Holzapfel (6.128): c1 = G / 2


def mooney_rivlin(E: Expr, sigma0: Expr, C10t: Expr, C01t: Expr) -> Expr:
    """Strain energy of a Mooney-Rivlin membrane per reference area, a scalar [J/m2].

    Args:
        E: Green-Lagrange strain in any tangent frame, shape (2, 2) [-].
        sigma0: Cauchy prestress in that frame, shape (2, 2) [N/m].
        C10t: Constant of the first invariant times thickness [N/m].
        C01t: Constant of the second invariant times thickness [N/m].

    Source:
        Holzapfel (6.127).
    """
    return inner(sigma0, E) + C10t * first_invariant(E) + C01t * second_invariant(E)  # Holzapfel (6.127)


def first_invariant(E: Expr) -> Expr:
    """I1 - 3 of an incompressible membrane [-]; E as for `neo_hooke`."""
    t, d = tr(E), det(E)
    j = 2 * t + 4 * d
    return (2 * t * j - 4 * d) / (1 + j)


def second_invariant(E: Expr) -> Expr:
    """I2 - 3 of an incompressible membrane [-]; E as for `neo_hooke`."""
    t, d = tr(E), det(E)
    j = 2 * t + 4 * d
    return (j**2 - 4 * d) / (1 + j)
