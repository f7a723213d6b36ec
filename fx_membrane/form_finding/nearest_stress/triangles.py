"""Triangles in a shape, with the wish where they are: strains of multipliers, stresses, forces and energies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.symmetric_tensors import sandwich, tensors
from ...geometry.vector_columns import cross, dot, lengths, over_copies
from ..wishes import Wish

Array = NDArray[np.float64]


class Triangle(NamedTuple):
    """Geometry and wish of triangles: areas, gradients along warp and weft (cells, 3, 2), frame (cells, 2, 3), wish."""

    areas: Array
    gradients: Array
    frame: Array
    wish: Array


class Triangles(NamedTuple):
    """Geometry and wish of triangles in columns, cells last; symmetric tensors by warp, shear and weft.

    Attributes:
        twice: Double areas, shape (..., cells) [m2].
        frame: Unit vectors of warp and weft, shape (2, 3, ..., cells) [-].
        second: Component along warp and weft of the side from the first corner to the second, (2, ..., cells) [m].
        third: The same of that to the third.
        wish: Stress wished for, shape (3, ..., cells), or the same for all copies, (3, 1, cells) [N/m].
    """

    twice: Array
    frame: tuple[Array, Array]
    second: tuple[Array, Array]
    third: tuple[Array, Array]
    wish: Array

    @classmethod
    def of(cls, corners: Array, wish: Wish) -> Triangles:
        """Make triangles of their corners, shape (3, 3, ..., cells) [m]."""
        second, third = corners[1] - corners[0], corners[2] - corners[0]
        normal = cross(second, third)
        twice = lengths(normal)
        normal /= twice
        warp, size = wish.in_columns(corners.mean(axis=0), second, normal)
        weft = cross(normal, warp)
        local = [(dot(side, warp), dot(side, weft)) for side in (second, third)]
        return cls(twice, (warp, weft), local[0], local[1], size)

    def by_cell(self) -> Triangle:
        """Geometry and wish with cells first, of triangles without copies."""
        (b, c), (d, e) = self.second, self.third
        gradients = np.stack([np.stack([c - e, d - b]), np.stack([e, -d]), np.stack([-c, b])]) / self.twice
        frame = np.stack([way.T for way in self.frame], axis=1)
        return Triangle(self.twice / 2, np.ascontiguousarray(np.moveaxis(gradients, -1, 0)), frame, tensors(self.wish))

    def strains(self, multipliers: Array) -> Array:
        """Strains of multipliers, shape (3, 3, cells), along warp and weft, shape (3, ..., cells)."""
        (warp, weft), (b, c), (d, e) = self.frame, self.second, self.third
        second, third = (over_copies(multipliers[k] - multipliers[0], warp) for k in (1, 2))
        along, other = (dot(second, warp), dot(third, warp)), (dot(second, weft), dot(third, weft))
        shear = (along[1] * b - along[0] * d + other[0] * e - other[1] * c) / 2
        return np.stack([along[0] * e - along[1] * c, shear, other[1] * b - other[0] * d]) / self.twice

    def corrected(self, multipliers: Array) -> Array:
        """Wish corrected by multipliers, shape (3, ..., cells) [N/m]."""
        return np.asarray(self.wish + sandwich(self.wish, self.strains(multipliers)))

    def pulls(self, stress: Array) -> Array:
        """Return the forces of a stress on the corners, shape (3, 3, ..., cells) [N]."""
        (warp, weft), (b, c), (d, e) = self.frame, self.second, self.third
        second = (e * stress[0] - d * stress[1]) / 2 * warp + (e * stress[1] - d * stress[2]) / 2 * weft
        third = (b * stress[1] - c * stress[0]) / 2 * warp + (b * stress[2] - c * stress[1]) / 2 * weft
        return np.stack([-second - third, second, third])

    def energies(self, multipliers: Array) -> Array:
        """Area integral of w : e + tr(w e w e) / 2 with the strain e of multipliers, shape (..., cells)."""
        strain, wish = self.strains(multipliers), self.wish
        first = wish[0] * strain[0] + wish[1] * strain[1]
        last = wish[1] * strain[1] + wish[2] * strain[2]
        mixed = (wish[0] * strain[1] + wish[1] * strain[2]) * (wish[1] * strain[0] + wish[2] * strain[1])
        return np.asarray(self.twice / 2 * (first + last + (first * first + last * last) / 2 + mixed))
