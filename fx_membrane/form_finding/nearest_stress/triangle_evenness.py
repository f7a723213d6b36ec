"""Evenness of triangles: squared sides over area, least for equal sides, the same for any size, and its derivatives."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

LAPLACE = 3 * np.eye(3) - 1  # of the squared sides of a triangle
ORDER = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])  # senses of the corners about the normal


class Evenness(NamedTuple):
    """Derivatives of the squared sides of triangles over their area, by their corners.

    Attributes:
        slopes: First ones, shape (cells, 3, 3) [1/m].
        convex: Second ones, for an area that is linear in the corners: never negative, (cells, 3, 3, 3, 3) [1/m2].
        bent: The rest of them, from the curvature of the area.
        gradients: Gradients of the shares of the corners, shape (cells, 3, 3) [1/m].
        normal: Unit normals, shape (cells, 3) [-].
    """

    slopes: Array
    convex: Array
    bent: Array
    gradients: Array
    normal: Array


def evenness_of(corners: Array) -> Evenness:
    """Take the derivatives for triangles, shape (cells, 3, 3) [m].

    Source:
        P. M. Knupp, Algebraic mesh quality metrics, SIAM Journal on Scientific Computing 23 (2001) 193-218: the inverse
        of the mean ratio.
    """
    sides = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)  # opposite to each corner
    normal = np.cross(sides[:, 0], sides[:, 1])
    twice = np.linalg.norm(normal, axis=1)
    normal /= twice[:, None]
    area, square = twice / 2, np.sum(sides**2, axis=(1, 2))
    gradients = np.cross(normal[:, None], sides) / twice[:, None, None]
    by_square = 2 * np.einsum("ij,cjx->cix", LAPLACE, corners)
    mixed = np.einsum("cix,cjy->cixjy", by_square, gradients)
    convex = 2 * np.einsum("ij,xy->ixjy", LAPLACE, np.eye(3)) - mixed - mixed.transpose(0, 3, 4, 1, 2)
    convex += np.einsum("c,cix,cjy->cixjy", 2 * square, gradients, gradients)
    turn = np.cross(normal[:, None], np.eye(3)) / 2  # quarter turns about the normals
    bent = np.einsum("ij,cxy->cixjy", ORDER, turn)
    bent += np.einsum("cij,cx,cy->cixjy", sides @ sides.swapaxes(1, 2) / (4 * area[:, None, None]), normal, normal)
    each = (slice(None), *[None] * 4)
    slopes = by_square / area[:, None, None] - (square / area)[:, None, None] * gradients
    return Evenness(slopes, convex / area[each], -(square / area**2)[each] * bent, gradients, normal)
