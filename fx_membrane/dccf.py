"""The hand-derived element kernel: Direct Core Congruential Formulation, Gil (56)-(67).

An independent check of the UFL forms, used by the tests only: 3-node membrane (d = 2) and 2-node cable (d = 1), for
many elements at once. The core equations know the displacement gradient `g`, and no finite element:

    e_i = h_i . g + g . H_i g / 2,   s = s0 + C e,   phi = s_i h_i + s_i H_i g,
    M_mat = (h_i + H_i g) C_ij (h_j + H_j g)^T,   M_geo = s_i H_i

and `B`, with g = B u, takes them to the nodes: f = V B^T phi, K = V B^T (M_mat + M_geo) B, V the area or the length.

Axes: u is in global axes at the nodes, g in the axes of the element (two tangents and the normal). So h and H are
numbers 0 and 1, the same for all elements. The vector g is ordered u1,1 u2,1 u3,1 u1,2 u2,2 u3,2. Strains and stresses
are Voigt vectors, (E11, E22, 2 E12) and (S11, S22, S12), or (E11) and (S11).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Elements(NamedTuple):
    """Geometry of n elements of dimension d with d + 1 nodes.

    Attributes:
        B: Displacement gradient from nodal displacements, shape (n, 3 d, 3 (d + 1)) [1/m], Gil (59).
        measure: Areas or lengths, shape (n,) [m2 or m].
        gradients: Derivatives of the shape functions along the tangents, shape (n, d + 1, d) [1/m].
    """

    B: Array
    measure: Array
    gradients: Array


class Core(NamedTuple):
    """The core equations at a state, shapes with g of length 3 d.

    Attributes:
        e: Strains, shape (n, strains) [-], Gil (62).
        s: Stresses, shape (n, strains) [N/m or N], Gil (67).
        phi: Core force, shape (n, 3 d) [N/m or N], Gil (64).
        M_mat: Material core tangent, shape (n, 3 d, 3 d) [N/m or N], Gil (66).
        M_geo: Geometric core tangent, shape (n, 3 d, 3 d) [N/m or N], Gil (66).
    """

    e: Array
    s: Array
    phi: Array
    M_mat: Array
    M_geo: Array


def core_operators(d: int) -> tuple[Array, Array]:
    """Constants h_i, shape (strains, 3 d), and H_i, shape (strains, 3 d, 3 d), of Gil (62)."""
    pairs = [(0, 0)] if d == 1 else [(0, 0), (1, 1), (0, 1)]
    h = np.zeros((len(pairs), 3 * d))
    H = np.zeros((len(pairs), 3 * d, 3 * d))
    block = [slice(3 * j, 3 * j + 3) for j in range(d)]
    for i, (a, b) in enumerate(pairs):
        h[i, 3 * b + a] = h[i, 3 * a + b] = 1.0
        H[i, block[a], block[b]] = H[i, block[b], block[a]] = np.eye(3)
    return h, H


def core(g: Array, s0: Array, C: Array) -> Core:
    """Evaluate the core equations, with strains and stresses as vectors, Gil (61), (63).

    Args:
        g: Displacement gradients in element axes, shape (n, 3 d) [-].
        s0: Prestress, shape (n, strains) [N/m or N].
        C: Elastic moduli, shape (strains, strains) [N/m or N].
    """
    h, H = core_operators(g.shape[1] // 3)
    Hg = np.einsum("iab,nb->nia", H, g)
    e = g @ h.T + np.einsum("na,nia->ni", g, Hg) / 2  # Gil (62)
    s = s0 + e @ C.T  # Gil (67)
    phi = np.einsum("ni,nia->na", s, h + Hg)  # Gil (64)
    M_mat = np.einsum("nia,ij,njb->nab", h + Hg, C, h + Hg)  # Gil (66)
    M_geo = np.einsum("ni,iab->nab", s, H)  # Gil (66)
    return Core(e, s, phi, M_mat, M_geo)


def elements(X: Array, warp: Array | None = None) -> Elements:
    """Geometry of elements in space.

    Args:
        X: Reference positions of their nodes, shape (n, d + 1, 3) [m].
        warp: Vectors whose projections on the elements are their first axes, shape (n, 3) [any]; by default, the first
            side.
    """
    d = X.shape[1] - 1
    side = X[:, 1:] - X[:, :1]
    axes = _axes(side, warp)
    D = np.einsum("nak,nbk->nab", side, axes[:, :d])
    inverse = np.linalg.inv(D).swapaxes(1, 2)
    gradients = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)
    B = np.einsum("nIj,nik->njiIk", gradients, axes).reshape(len(X), 3 * d, 3 * d + 3)  # Gil (59)
    return Elements(B, np.abs(np.linalg.det(D)) / math.factorial(d), gradients)


def gradient(element: Elements, u: Array) -> Array:
    """Gradient from nodal displacements, Gil (59), (60), in the axes of the elements, shape (n, 3 d) [-]."""
    return np.einsum("nab,nb->na", element.B, u.reshape(len(u), -1))


def energy(element: Elements, u: Array, s0: Array, C: Array) -> Array:
    """Strain energy of each element, shape (n,) [J], Gil (40); arguments as for `internal_force`."""
    e = core(gradient(element, u), s0, C).e
    return np.asarray(element.measure * np.einsum("ni,ni->n", s0 + e @ C.T / 2, e))


def internal_force(element: Elements, u: Array, s0: Array, C: Array) -> Array:
    """Nodal forces of each element, shape (n, d + 1, 3) [N], Gil (48), (64).

    Args:
        element: Geometry.
        u: Nodal displacements in global axes, shape (n, d + 1, 3) [m].
        s0: Prestress in element axes, shape (n, strains) [N/m or N].
        C: Elastic moduli in element axes, shape (strains, strains) [N/m or N].
    """
    phi = core(gradient(element, u), s0, C).phi
    return np.einsum("n,nab,na->nb", element.measure, element.B, phi).reshape(u.shape)


def tangent(element: Elements, u: Array, s0: Array, C: Array) -> Array:
    """Tangent stiffness of each element, shape (n, 3 d + 3, 3 d + 3) [N/m], Gil (52), (53), (65)."""
    state = core(gradient(element, u), s0, C)
    M = state.M_mat + state.M_geo
    return np.einsum("n,nai,nab,nbj->nij", element.measure, element.B, M, element.B, optimize=True)


def pressure_force(X: Array, u: Array, p: Array) -> Array:
    """Nodal forces of a follower pressure p (n,) [Pa] on triangles, shape (n, 3, 3) [N], Gil (56)."""
    element = elements(X)
    x1, x2 = np.einsum("nIj,nIk->jnk", element.gradients, X + u)
    force = (p * element.measure / 3)[:, None] * np.cross(x1, x2)  # Gil (56)
    return np.repeat(force[:, None], 3, axis=1)


def pressure_tangent(X: Array, u: Array, p: Array) -> Array:
    """Tangent of `pressure_force`, its derivative by the nodal displacements, shape (n, 9, 9) [N/m], Gil (57)."""
    element = elements(X)
    x1, x2 = np.einsum("nIj,nIk->jnk", element.gradients, X + u)
    epsilon = np.zeros((3, 3, 3))
    epsilon[[0, 1, 2], [1, 2, 0], [2, 0, 1]] = 1.0
    epsilon[[0, 2, 1], [2, 1, 0], [1, 0, 2]] = -1.0
    dN1, dN2 = element.gradients[..., 0], element.gradients[..., 1]
    K = np.einsum("ijm,nm,nJ->niJj", epsilon, x2, dN1) + np.einsum("ilj,nl,nJ->niJj", epsilon, x1, dN2)  # Gil (57)
    K *= (p * element.measure / 3)[:, None, None, None]
    return np.repeat(K[:, None], 3, axis=1).reshape(len(X), 9, 9)


def isotropic(Et: float, nu: float) -> Array:
    """Elastic moduli of an isotropic membrane in plane stress, shape (3, 3) [N/m]."""
    return Et / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


def orthotropic(Et_warp: float, Et_weft: float, nu: float, Gt: float) -> Array:
    """Elastic moduli of a fabric, the inverse of its compliance, shape (3, 3) [N/m]."""
    compliance = [[1 / Et_warp, -nu / Et_warp, 0], [-nu / Et_warp, 1 / Et_weft, 0], [0, 0, 1 / Gt]]
    return np.asarray(np.linalg.inv(np.array(compliance)))


def axial(EA: float) -> Array:
    """Elastic modulus of a cable, shape (1, 1) [N]."""
    return np.array([[EA]])


def _axes(side: Array, warp: Array | None) -> Array:
    """Axes of the elements as rows: the tangents first, then the normals; shape (n, 3, 3)."""
    if side.shape[1] == 2:
        normal = np.cross(side[:, 0], side[:, 1])
        first = side[:, 0] if warp is None else warp
        second = np.cross(normal, first)
        first = np.cross(second, normal)
    else:
        first = side[:, 0]
        second = np.cross(first, np.eye(3)[np.abs(first).argmin(axis=1)])
        normal = np.cross(first, second)
    axes = np.stack([first, second, normal], axis=1)
    return np.asarray(axes / np.linalg.norm(axes, axis=2, keepdims=True))
