"""Cells of the nearest stress: forces and energies of a small motion that corrects the stress wished for.

Among the stresses in equilibrium in a shape, the nearest to the wish w is w + w e w. e is the strain of a vector l at
the nodes, the multiplier of equilibrium (in length over stress). The area integral of w : e + tr(w e w e) / 2, less the
work of the loads on l, is a function of l and of the shape. Its derivative by l is the unbalanced force; its minimum
over l is minus half the squared norm of the relative difference of stress and wish.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...geometry.symmetric_tensors import components, sandwich, square_root, tensors
from ...geometry.vector_columns import columns, dot, lengths, over_copies
from ..balance.membrane_balance import cell_loads
from ..wishes import Wish
from .triangles import Triangle, Triangles

Array = NDArray[np.float64]
Cells = NDArray[np.int64]


class Block(Protocol):
    """Cells of one kind.

    Corners have the shape (nodes of a cell, 3, ..., cells), with the cells last and copies of them, moved, in between:
    sums over short last axes are slow. Multipliers have the shape (nodes of a cell, 3, cells).
    """

    @property
    def cells(self) -> Cells:
        """Nodes of the cells, shape (cells, nodes of a cell)."""

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """Unbalanced forces on the nodes of the cells, shape of corners [N]."""

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """Values of the function whose derivative by the multipliers the forces are, shape (..., cells)."""

    def stiffnesses(self, corners: Array) -> Array:
        """Second derivatives by the multipliers, shape (cells, nodes, 3, nodes, 3); corners (cells, nodes, 3)."""


@dataclass(frozen=True)
class MembraneBlock:
    """Cells of a membrane.

    Args:
        cells: Nodes of the cells, shape (cells, 3).
        wish: The wish.
        ratio: Factor r of the wish on the way to it, w^1/2 r w^1/2 in its frame, shape (cells, 2, 2) [-]; one if None.
    """

    cells: Cells
    wish: Wish
    ratio: Array | None = None

    def triangles(self, corners: Array) -> Triangle:
        """Geometry of the cells, and the wish where they are; corners of the shape (cells, 3, 3)."""
        return self._triangles(columns(corners)).by_cell()

    def stresses(self, corners: Array, multipliers: Array) -> tuple[Triangle, Array]:
        """Geometry, and the corrected stress along warp and weft, shape (cells, 2, 2) [N/m]; by cell."""
        triangles = self._triangles(columns(corners))
        return triangles.by_cell(), tensors(triangles.corrected(columns(multipliers)))

    def _triangles(self, corners: Array) -> Triangles:
        found = Triangles.of(corners, self.wish)
        if self.ratio is None:
            return found
        return found._replace(wish=sandwich(square_root(found.wish), components(self.ratio)))

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        triangles = self._triangles(corners)
        return triangles.pulls(triangles.corrected(multipliers))

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        return self._triangles(corners).energies(multipliers)

    def stiffnesses(self, corners: Array) -> Array:
        """See `Block`."""
        areas, gradients, frame, wish = self.triangles(corners)
        flow = gradients @ wish
        inner = np.einsum("cia,cja->cij", flow, gradients)
        outer = np.einsum("cia,cax->cix", flow, frame)
        spread = frame.swapaxes(1, 2) @ wish @ frame
        both = np.einsum("cij,cxy->cixjy", inner, spread) + np.einsum("cjx,ciy->cixjy", outer, outer)
        return np.asarray(areas[:, None, None, None, None] / 2 * both)


@dataclass(frozen=True)
class BarBlock:
    """Cells of a cable or a mast with forces.

    Args:
        cells: Nodes of the cells, shape (cells, 2).
        force: Forces wished for, shape (cells,) [N].
        width: Width of the strip of membrane that counts as much as the bar, shape (cells,) [m].
        growth: Factor of the forces in a shape, of corners, as of given force densities; one if None.
    """

    cells: Cells
    force: Array
    width: Array
    growth: Callable[[Array], Array] | None = None

    def _given(self, corners: Array) -> Array:
        return self.force if self.growth is None else self.force * self.growth(corners)

    def tensions(self, corners: Array, multipliers: Array) -> Array:
        """Corrected forces, shape (cells,) [N]; corners and multipliers of the shape (cells, 2, 3)."""
        at = columns(corners)
        return self._corrected(at, _strained(at, columns(multipliers))[2])

    def _corrected(self, corners: Array, strain: Array) -> Array:
        force = self._given(corners)
        return np.asarray(force + force**2 / self.width * strain)

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        _, unit, strain = _strained(corners, multipliers)
        pull = self._corrected(corners, strain) * unit
        return np.stack([-pull, pull])

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        length, _, strain = _strained(corners, multipliers)
        force = self._given(corners)
        return np.asarray(length * (force * strain + (force * strain) ** 2 / (2 * self.width)))

    def stiffnesses(self, corners: Array) -> Array:
        """See `Block`."""
        at = columns(corners)
        length, unit, _ = _strained(at, np.zeros_like(at))
        along = self._given(at) ** 2 / self.width / length * unit[:, None] * unit
        return np.asarray(np.einsum("ij,xyc->cixjy", [[1.0, -1.0], [-1.0, 1.0]], along))


def _strained(corners: Array, multipliers: Array) -> tuple[Array, Array, Array]:
    """Lengths of bars, unit vectors along them, and their strains by the multipliers, with cells last."""
    way = corners[1] - corners[0]
    length = lengths(way)
    unit = way / length
    return length, unit, dot(unit, over_copies(multipliers[1] - multipliers[0], unit)) / length


@dataclass(frozen=True)
class LoadBlock:
    """Cells under a load that is spread on their nodes."""

    cells: Cells
    load: Any

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        count, cells = len(corners), corners[0, 0].size
        points = corners.reshape(count, 3, cells).swapaxes(1, 2).reshape(-1, 3)
        spread = cell_loads(self.load, points, np.arange(count * cells).reshape(count, cells).T) / count
        return np.broadcast_to(-spread.T.reshape(corners.shape[1:]), corners.shape)

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        return dot(self.forces(corners, multipliers)[0], over_copies(multipliers.sum(axis=0), corners[0]))

    def stiffnesses(self, corners: Array) -> Array:
        """See `Block`."""
        n = corners.shape[1]
        return np.zeros((len(corners), n, 3, n, 3))


def norm_of(
    membranes: Mapping[str, MembraneBlock], bars: Mapping[str, BarBlock], points: Array, ratios: Mapping[str, Array]
) -> tuple[float, float]:
    """Sum areas times squared differences of stress and wish [m2], and the area, or that of strips for bars alone [m2].

    Args:
        membranes: Membranes by name.
        bars: Bars by name.
        points: The shape, shape (n, 3) [m].
        ratios: Stress over wish, by part, as `State.ratios`.
    """
    norm = area = strips = 0.0
    for name, block in membranes.items():
        areas = measures(points, block.cells)
        norm += float(areas @ np.sum((ratios[name] - np.eye(2)) ** 2, axis=(1, 2)))
        area += float(areas.sum())
    for name, bar in bars.items():
        strip = measures(points, bar.cells) * np.where(np.isfinite(bar.width), bar.width, 0.0)
        norm += float(strip @ (ratios[name] - 1) ** 2)
        strips += float(strip.sum())
    return norm, area or strips or 1.0


def mean_stress(membranes: Mapping[str, MembraneBlock], points: Array) -> float:
    """Mean of the stress wished for over the area of a shape [N/m]; zero without a membrane."""
    total = area = 0.0
    for block in membranes.values():
        triangles = block.triangles(points[block.cells])
        total += float(np.sum(triangles.areas * np.trace(triangles.wish, axis1=1, axis2=2) / 2))
        area += float(triangles.areas.sum())
    return total / area if area else 0.0
