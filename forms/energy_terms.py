"""Symbols of a part for energy terms of a user: loads, contact, elastic beds."""

from __future__ import annotations

from ufl import cross
from ufl.core.expr import Expr


class State:
    """A part in its current shape, as UFL symbols. All lengths and areas are those of the part, without thickness.

    Args:
        u: Displacement, shape (3,) [m].
        X: Reference position, shape (3,) [m].
        F: Deformation gradient from the tangent plane into space, shape (3, d) [-]: current vectors along warp and weft
            (d = 2) or along the axis of a bar (d = 1), for reference vectors of length one.

    Attributes:
        u, X, F: As given.
        x: Current position, X + u, shape (3,) [m].
    """

    def __init__(self, u: Expr, X: Expr, F: Expr):
        self.u, self.X, self.F = u, X, F
        self.x = X + u
        self.has_asked_for_n = False

    @property
    def n(self) -> Expr:
        """Area normal: current normal times current area per reference area, shape (3,) [-].

        A pressure p has the virtual work p dot(n, v). The unit normal is n / sqrt(dot(n, n)).

        Raises:
            ValueError: The part is a line.

        Source:
            Gil (55), Nanson's rule.
        """
        if self.F.ufl_shape[1] != 2:
            raise ValueError("state.n is the normal of a membrane; cables and masts have none")
        self.has_asked_for_n = True
        return cross(self.F[:, 0], self.F[:, 1])
