"""Motion of flat outlines: inner points follow as those of an elastic sheet, seams stay as long on both sides.

Inner points alone would change nothing but the mesh: the outlines are the cut. A strip keeps three components of its
outline, which would move it as a whole.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from .cloth import Cloth
from .compensated_cloth import bound_sides
from .energy_minimum import _free, _gap_curvature, _gap_gradients, _gaps, lengths
from .pieces import Pieces
from .plane_cells import sides
from .strips import Strips

Array = NDArray[np.float64]

ROUNDS = 20  # Newton steps towards equal seams
EQUAL_LENGTHS = 1e-14  # difference over length that counts as none


class OutlineMotion:
    """Flat points as a function of the free components of the outlines.

    Args:
        strips: The strips.
        pieces: The strips, apart from each other.
        places: First flat points, shape (n, 2) [m].
        kept: Names of edges that keep their length.

    Attributes:
        start: First flat points, shape (n, 2) [m].
        count: Number of free components.
        bound: True if lengths are bound.
    """

    def __init__(self, strips: Strips, pieces: Pieces, places: Array, kept: Sequence[str]):
        self.start = places
        outline = np.unique(pieces.border)
        of_outline = (2 * outline[:, None] + np.arange(2)).ravel()
        self._moved = np.intersect1d(of_outline, _free(places, pieces.strip_of_point))
        self._inner = np.setdiff1d(np.arange(places.size), of_outline)
        self.count = len(self._moved)
        laws = [strips.membrane(name).material for name in pieces.names]
        cloth = Cloth(places, pieces.triangles, pieces.strip_of_cell, laws)
        self._stiffness = cloth.with_shapes(sides(places, pieces.triangles)).stiffness(places).tocsc()
        inner = self._stiffness[self._inner][:, self._inner]
        self._factors = splu(inner) if len(self._inner) else None
        self._coupling = self._stiffness[self._inner][:, self._moved].tocsr()
        self._links = bound_sides(strips, pieces, pieces.seam_pairs(), kept, places)
        self._lengths = lengths(places, self._links.here)
        self.bound = len(self._lengths) > 0
        self._first_gaps = _gaps(places, self._links)

    def places(self, z: Array) -> Array:
        """Flat points, shape (n, 2) [m]."""
        return self.start + self.spread(z).reshape(-1, 2)

    def spread(self, z: Array) -> Array:
        """Motion of all points with that of the outline, shape (2 n,)."""
        found = np.zeros(self.start.size)
        found[self._moved] = z
        if self._factors is not None:
            found[self._inner] = -self._factors.solve(self._coupling @ z)
        return found

    def gathered(self, forces: Array) -> Array:
        """Transpose of `spread`: from (2 n,) to the outline."""
        found = forces[self._moved].copy()
        if self._factors is not None:
            found -= self._coupling.T @ self._factors.solve(forces[self._inner], "T")
        return found

    def resistance(self, spread: Array) -> Array:
        """Take the forces of an elastic sheet, free of stress at first, against a motion of all points, (2 n,) [N]."""
        return np.asarray(self._stiffness @ spread)

    def differences(self, z: Array) -> Array:
        """Growth of the differences of lengths that are bound, over the lengths, shape (links,) [-]."""
        return np.asarray(_gaps(self.places(z), self._links) - self._first_gaps) / self._lengths

    def slopes(self, z: Array) -> sparse.csr_matrix:
        """Differentiate `differences`, shape (links, count) [1/m]."""
        by_places = _gap_gradients(self.places(z), self._links).tocsr()[:, self._moved]
        return sparse.csr_matrix(sparse.diags(1 / self._lengths) @ by_places)

    def curvature(self, z: Array, multipliers: Array) -> sparse.csr_matrix:
        """Second derivative of `differences` times multipliers, shape (count, count)."""
        whole = _gap_curvature(self.places(z), self._links, multipliers / self._lengths).tocsr()
        return sparse.csr_matrix(whole[self._moved][:, self._moved])

    def with_equal_seams(self, z: Array) -> Array:
        """Nearest motion with lengths that are bound to rounding."""
        for _ in range(ROUNDS):
            off = self.differences(z)
            if np.abs(off).max(initial=0.0) <= EQUAL_LENGTHS:
                break
            C = self.slopes(z)
            z = z - C.T @ splu((C @ C.T).tocsc()).solve(off)
        return z
