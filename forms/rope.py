"""Length of a rope that slides over its nodes: its energy depends on the sum alone, and its tension is uniform."""

from __future__ import annotations

from ufl import sqrt
from ufl.core.expr import Expr


def current_length(E: Expr) -> Expr:
    """Ratio of current to reference length of a segment [-]; its integral is the length of the rope.

    With the tension T of the rope, T times its first derivative are the forces of the segments. T times its second is
    their geometric stiffness. The derivative of T by the length couples all nodes: that is no part of this form.

    Args:
        E: Green-Lagrange strain with respect to the reference shape, shape (1, 1) [-].

    Source:
        Chain rule for an energy of the length, phi(L(u)).
    """
    return sqrt(1 + 2 * E[0, 0])


def elongation(E: Expr) -> Expr:
    """Ratio of the elongation to the reference length of a segment [-], with all digits of small strains.

    Args:
        E: Green-Lagrange strain with respect to the reference shape, shape (1, 1) [-].
    """
    return 2 * E[0, 0] / (1 + current_length(E))
