"""Kinematics of a body of dimension d embedded in space, Gil (17), (41), (58)."""

from __future__ import annotations

from ufl import as_matrix, as_vector, cross, det, dot, grad, sqrt, sym
from ufl.core.expr import Expr


def bar_frame(J: Expr) -> Expr:
    """Tangent of a cable or a mast, of unit length, as a frame with one column.

    Args:
        J: Jacobian of the reference geometry, `ufl.Jacobian(mesh)`, shape (3, 1) [m].

    Returns:
        T, shape (3, 1) [-].
    """
    t = unit(as_vector([J[i, 0] for i in range(3)]))
    return as_matrix([[t[i]] for i in range(3)])


def membrane_frame(J: Expr, warp: Expr) -> Expr:
    """Warp and weft direction of a membrane: two orthonormal tangent vectors.

    Args:
        J: Jacobian of the reference geometry, `ufl.Jacobian(mesh)`, shape (3, 2) [m].
        warp: A vector whose projection on the tangent plane is the warp direction, shape (3,) [any].

    Returns:
        T, shape (3, 2) [-]: columns warp and weft; warp x weft is the normal of the cell.
    """
    n = unit(cross(J[:, 0], J[:, 1]))
    t1 = unit(warp - dot(warp, n) * n)
    t2 = cross(n, t1)
    return as_matrix([[t1[i], t2[i]] for i in range(3)])


def displacement_gradient(u: Expr, T: Expr) -> Expr:
    """Displacement gradient: derivatives of the displacement along the frame, shape (3, d) [-].

    Args:
        u: Displacement, shape (3,) [m].
        T: Tangent frame, shape (3, d) [-].

    Source:
        Gil (58).
    """
    return grad(u) * T


def deformation_gradient(G: Expr, T: Expr) -> Expr:
    """Deformation gradient from the tangent plane into space, shape (3, d) [-].

    Args:
        G: Displacement gradient, shape (3, d) [-].
        T: Tangent frame, shape (3, d) [-].

    Source:
        Gil (12), (41): F = I + grad u, applied to the frame.
    """
    return T + G


def green_lagrange(G: Expr, T: Expr) -> Expr:
    """Green-Lagrange strain (F^T F - I) / 2 in the tangent frame, shape (d, d) [-].

    It is written in the displacement gradient, as in the paper: small strains keep all their digits, which the
    difference F^T F - I would lose.

    Args:
        G: Displacement gradient, shape (3, d) [-].
        T: Tangent frame, shape (3, d) [-].

    Source:
        Gil (15), (17).
    """
    return sym(T.T * G) + G.T * G / 2  # Gil (17)


def stretch_ratio(F: Expr) -> Expr:
    """Ratio of current to reference area (d = 2) or length (d = 1) [-].

    Args:
        F: Deformation gradient, shape (3, d) [-].
    """
    return sqrt(det(F.T * F))


def projected_ratio(F: Expr, T: Expr) -> Expr:
    """Ratio J, the determinant of I + grad u in space, which reproduces the paper's Table 2 [-].

    It is the current area projected on the reference tangent plane, over the reference area. It equals `stretch_ratio`
    if the tangent plane does not rotate.

    Args:
        F: Deformation gradient, shape (3, d) [-].
        T: Tangent frame, shape (3, d) [-].

    Source:
        Gil (19) with the out-of-plane column of grad u equal to zero.
    """
    return det(T.T * F)


def unit(a: Expr) -> Expr:
    """Scale a vector to length one; shape of a [-]."""
    return a / sqrt(dot(a, a))
