"""Water above triangles, up to a level: volume, potential and their derivatives, exact where the water line cuts.

With depths d = h - z at the corners, the areal coordinates l and the area A in plan, over the wet part of a triangle

    V = A int l . d,    W = A int (l . d)^2 / 2,    G1 = int l,    G2 = int l l^T,

V = A G1 . d, W = A d . G2 d / 2. The line cuts off a triangle at one corner, wet or dry, on which these integrals are
polynomials. V is the derivative of W by the level, G1 and G2 d those of V / A and W / A by the depths, G2 the second of
W / A. W has continuous first derivatives. Its second ones change at the water line only.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MOMENTS = (np.eye(3) + 1) / 12  # mean of l l^T over a triangle
SIDE = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]]) / 2  # A = x . SIDE y


class Wet(NamedTuple):
    """Integrals over the wet parts of triangles, per area in plan.

    Attributes:
        area: Share of the area that is wet, shape (cells,) [-].
        first: G1, shape (cells, 3) [-].
        second: G2, shape (cells, 3, 3) [-].
    """

    area: Array
    first: Array
    second: Array


def wet_parts(depths: Array) -> Wet:
    """Integrals over the wet part of each triangle, from the depths at its corners, shape (cells, 3) [m].

    A corner at the level counts as wet: a level sheet that is just full carries water.
    """
    count, above = len(depths), depths < 0
    whole = ~above.any(axis=1)
    area, first, second = whole.astype(np.float64), np.zeros((count, 3)), np.zeros((count, 3, 3))
    first[whole], second[whole] = 1 / 3, MOMENTS
    cut, is_dry, corner = _cut(above)
    if len(cut):
        share, one, two = _tip(depths[cut], corner)
        sign = np.where(is_dry, -1.0, 1.0)
        area[cut] = is_dry + sign * share
        first[cut] = is_dry[:, None] / 3 + sign[:, None] * one
        second[cut] = is_dry[:, None, None] * MOMENTS + sign[:, None, None] * two
    return Wet(area, first, second)


def _cut(above: NDArray[np.bool_]) -> tuple[NDArray[np.intp], NDArray[np.bool_], NDArray[np.intp]]:
    """Triangles that the water line cuts, whether the corner that it cuts off is dry, and that corner."""
    dry = above.sum(axis=1)
    cut = np.flatnonzero((dry == 1) | (dry == 2))
    is_dry = dry[cut] == 1
    return cut, is_dry, (above[cut] == is_dry[:, None]).argmax(axis=1)


def _tip(depths: Array, corner: NDArray[np.intp]) -> tuple[Array, Array, Array]:
    """Area, G1 and G2 of the triangles that the water line cuts off at a corner of each, per whole area."""
    rows = np.arange(len(depths))
    at = depths[rows, corner]
    P = np.zeros((len(depths), 3, 3))  # corners of the tip in areal coordinates
    P[:, :, :] = np.eye(3)[corner][:, None, :]
    share = np.ones(len(depths))
    for k in (1, 2):
        other = (corner + k) % 3
        ratio = at / (at - depths[rows, other])
        P[rows, k, corner] = 1 - ratio
        P[rows, k, other] = ratio
        share *= ratio
    first = share[:, None] * P.mean(axis=1)
    second = share[:, None, None] * np.einsum("nki,kl,nlj->nij", P, MOMENTS, P)
    return share, first, second


def plan_areas(corners: Array) -> Array:
    """Signed areas in plan of triangles, shape (cells, 3, 3) to (cells,) [m2]."""
    return np.asarray(np.einsum("ni,ij,nj->n", corners[:, :, 0], SIDE, corners[:, :, 1]))


def _plan_gradients(corners: Array) -> Array:
    """Differentiate the areas in plan by the corners, shape (cells, 3, 3) [m]."""
    found = np.zeros_like(corners)
    found[:, :, 0] = corners[:, :, 1] @ SIDE.T
    found[:, :, 1] = corners[:, :, 0] @ SIDE
    return found


def volumes(corners: Array, level: float) -> tuple[Array, Array]:
    """Volume of the water above each triangle [m3], and its wet area in plan [m2], both of shape (cells,)."""
    area, depths = plan_areas(corners), level - corners[:, :, 2]
    above = depths < 0
    wet = (~above.any(axis=1)).astype(np.float64)
    mean = wet * depths.sum(axis=1) / 3
    cut, is_dry, corner = _cut(above)
    at, share = depths[cut, corner], np.ones(len(cut))
    for k in (1, 2):
        share *= at / (at - depths[cut, (corner + k) % 3])
    sign = np.where(is_dry, -1.0, 1.0)
    wet[cut] = is_dry + sign * share
    mean[cut] = is_dry * depths[cut].sum(axis=1) / 3 + sign * share * at / 3  # on the water line there is no depth
    return area * mean, area * wet


def volume_gradients(corners: Array, level: float) -> Array:
    """Differentiate the volumes by the corners at a fixed level, shape (cells, 3, 3) [m2]."""
    depths = level - corners[:, :, 2]
    wet = wet_parts(depths)
    found = np.einsum("ni,ni->n", wet.first, depths)[:, None, None] * _plan_gradients(corners)
    found[:, :, 2] -= plan_areas(corners)[:, None] * wet.first
    return np.asarray(found)


def potentials(corners: Array, level: float) -> Array:
    """Integrals W of half the square of the depth over each triangle, shape (cells,) [m4]."""
    depths = level - corners[:, :, 2]
    return plan_areas(corners) * np.einsum("ni,nij,nj->n", depths, wet_parts(depths).second, depths) / 2


def potential_gradients(corners: Array, level: float) -> Array:
    """Differentiate W by the corners at a fixed level, shape (cells, 3, 3) [m3]."""
    depths = level - corners[:, :, 2]
    moment = np.einsum("nij,nj->ni", wet_parts(depths).second, depths)
    found = np.einsum("ni,ni->n", depths, moment)[:, None, None] / 2 * _plan_gradients(corners)
    found[:, :, 2] -= plan_areas(corners)[:, None] * moment
    return np.asarray(found)


def potential_hessians(corners: Array, level: float) -> Array:
    """Second derivatives of W by the corners at a fixed level, shape (cells, 3, 3, 3, 3) [m2]: corner, axis, twice."""
    depths = level - corners[:, :, 2]
    wet, slope = wet_parts(depths), _plan_gradients(corners)
    moment = np.einsum("nij,nj->ni", wet.second, depths)
    half = np.einsum("ni,ni->n", depths, moment) / 2
    found = np.zeros((len(corners), 3, 3, 3, 3))
    found[:, :, 0, :, 1] = half[:, None, None] * SIDE
    found[:, :, 1, :, 0] = half[:, None, None] * SIDE.T
    found[:, :, 2, :, 2] = plan_areas(corners)[:, None, None] * wet.second
    for axis in (0, 1):
        across = np.einsum("ni,nj->nij", slope[:, :, axis], moment)
        found[:, :, axis, :, 2] = -across
        found[:, :, 2, :, axis] = -across.transpose(0, 2, 1)
    return found
