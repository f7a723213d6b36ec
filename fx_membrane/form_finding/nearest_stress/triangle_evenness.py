"""Evenness of triangles: squared sides over area, least for equal sides, the same for any size, and its derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.vector_columns import cross, lengths

Array = NDArray[np.float64]

LAPLACE = 3 * np.eye(3) - 1  # of the squared sides of a triangle
ORDER = np.array([[0, 1, -1], [-1, 0, 1], [1, -1, 0]])  # senses of the corners about the normal


class Triangles(NamedTuple):
    """Triangles and the first derivatives of their squared sides over their area, in columns, cells last.

    Attributes:
        sides: Sides opposite to each corner, shape (3, 3, cells) [m].
        normal: Unit normals, shape (3, cells) [-].
        areas: Areas, shape (cells,) [m2].
        square: Sums of the squared sides, shape (cells,) [m2].
        by_square: Derivatives of these by the corners, shape (3, 3, cells) [m].
        gradients: Gradients of the shares of the corners, shape (3, 3, cells) [1/m].
    """

    sides: Array
    normal: Array
    areas: Array
    square: Array
    by_square: Array
    gradients: Array

    def slopes(self) -> Array:
        """Return the derivatives of the evenness by the corners, shape (3, 3, cells) [1/m]."""
        return np.asarray(self.by_square / self.areas - self.square / self.areas * self.gradients)


class Evenness(NamedTuple):
    """Derivatives of the squared sides of triangles over their area, by their corners.

    Attributes:
        slopes: First ones, shape (3, 3, cells) [1/m].
        convex: Second ones, for an area that is linear in the corners: never negative, (3, 3, 3, 3, cells) [1/m2].
        bent: The rest of them, from the curvature of the area.
        gradients: Gradients of the shares of the corners, shape (3, 3, cells) [1/m].
        normal: Unit normals, shape (3, cells) [-].
    """

    slopes: Array
    convex: Array
    bent: Array
    gradients: Array
    normal: Array


def triangles_of(corners: Array) -> Triangles:
    """Triangles and first derivatives of their evenness, from corners of the shape (3, 3, cells) [m]."""
    a, b, c = corners
    sides = np.stack([c - b, a - c, b - a])
    normal = cross(sides[0], sides[1])
    twice = lengths(normal)
    normal /= twice
    gradients = np.stack([cross(normal, side) for side in sides]) / twice
    by_square = 2 * np.stack([sides[1] - sides[2], sides[2] - sides[0], sides[0] - sides[1]])
    return Triangles(sides, normal, twice / 2, np.einsum("ixn,ixn->n", sides, sides), by_square, gradients)


def evenness_of(corners: Array) -> Evenness:
    """Compute the derivatives of the evenness of triangles, from corners of the shape (3, 3, cells) [m].

    Source:
        P. M. Knupp, Algebraic mesh quality metrics, SIAM Journal on Scientific Computing 23 (2001) 193-218: the inverse
        of the mean ratio.
    """
    triangles = triangles_of(corners)
    sides, normal, area, square, by_square, gradients = triangles
    mixed = by_square[:, :, None, None] * gradients
    convex = (2 * square * gradients)[:, :, None, None] * gradients - mixed - mixed.transpose(2, 3, 0, 1, 4)
    convex += 2 * np.einsum("ij,xy->ixjy", LAPLACE, np.eye(3))[..., None]
    turn = np.stack([cross(normal, axis[:, None]) for axis in np.eye(3)]) / 2  # quarter turns about the normals
    bent = ORDER[:, None, :, None, None] * turn[:, None]
    across = np.einsum("ixn,jxn->ijn", sides, sides) / (4 * area)
    bent = bent + across[:, None, :, None] * (normal[:, None] * normal)[:, None]
    return Evenness(triangles.slopes(), convex / area, -square / area**2 * bent, gradients, normal)
