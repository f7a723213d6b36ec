"""Natural shape: a stress-free shape other than the reference shape.

A maps the reference tangent plane to the natural one, both in their warp/weft frames; for a bar it is the ratio of the
natural to the reference length. Energies are per natural area or length, of the elastic strain of F A^-1. With
A^-1 = I + H,

    E_e = (A^-T F^T F A^-1 - I) / 2 = A^-T E A^-1 + H_s + H^T H / 2,    H_s the symmetric part of H.

H is the input: small natural strains keep all their digits. With H = 0 these are the strain and the energy of Gil (17)
and (40).

Source: the multiplicative split of F, as in E. H. Lee, J. Appl. Mech. 36 (1969) 1-6; in temperature, R. Stojanovitch,
S. Djuric, L. Vujosevic, Arch. Mech. Stos. 16 (1964) 103-108.
"""

from __future__ import annotations

from ufl import Identity, det, sym
from ufl.core.expr import Expr


def elastic_strain(E: Expr, H: Expr) -> Expr:
    """Green-Lagrange strain with respect to the natural shape, in its warp/weft frame, shape (d, d) [-].

    Args:
        E: Green-Lagrange strain with respect to the reference shape, shape (d, d) [-].
        H: Inverse of A less the identity, shape (d, d) [-].
    """
    B = Identity(E.ufl_shape[0]) + H
    return B.T * E * B + sym(H) + H.T * H / 2


def measure_ratio(H: Expr) -> Expr:
    """Ratio of natural to reference area (d = 2) or length (d = 1), det A [-].

    Args:
        H: Inverse of A less the identity, shape (d, d) [-].
    """
    return 1 / det(Identity(H.ufl_shape[0]) + H)
