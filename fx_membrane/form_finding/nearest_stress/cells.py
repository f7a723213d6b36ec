"""Cells of the nearest stress: forces and energies of a small motion that corrects the stress wished for.

The stress nearest to the wish w, among those in equilibrium in a shape, is w + w e w, with the strain e of a vector l
at the nodes, the multiplier of equilibrium (in length over stress). The area integral of w : e + tr(w e w e) / 2, less
the work of the loads on l, is a function of l and of the shape. Its derivative by l is the unbalanced force; the
negative of its minimum over l is half the square of the norm of the relative difference of stress and wish.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ..balance.membrane_balance import cell_loads
from ..wishes import Wish

Array = NDArray[np.float64]
Cells = NDArray[np.int64]


class Block(Protocol):
    """Cells of one kind; corners and multipliers have the shape (cells, nodes of a cell, 3)."""

    @property
    def cells(self) -> Cells:
        """Nodes of the cells, shape (cells, nodes of a cell)."""

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """Unbalanced forces on the nodes of the cells, shape of corners [N]."""

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """Values of the function whose derivative by the multipliers the forces are, shape (cells,)."""

    def stiffnesses(self, corners: Array) -> Array:
        """Second derivatives by the multipliers, shape (cells, nodes, 3, nodes, 3)."""


class Triangle(NamedTuple):
    """Geometry and wish of triangles: areas, gradients along warp and weft (cells, 3, 2), frame (cells, 2, 3), wish."""

    areas: Array
    gradients: Array
    frame: Array
    wish: Array


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
        """Geometry of the cells, and the wish where they are."""
        a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
        normal = np.cross(b - a, c - a)
        twice = np.sqrt(np.einsum("ij,ij->i", normal, normal))
        normal /= twice[:, None]
        warp, size = self.wish.at(corners, normal)
        if self.ratio is not None:
            root = square_root(size)
            size = root @ self.ratio @ root
        weft = np.cross(normal, warp)
        frame = np.stack([warp, weft], axis=1)
        sides = np.stack([c - b, a - c, b - a], axis=1)
        along = np.einsum("cix,cax->cia", sides, frame)
        gradients = np.stack([-along[:, :, 1], along[:, :, 0]], axis=2) / twice[:, None, None]
        return Triangle(twice / 2, gradients, frame, size)

    def strains(self, triangles: Triangle, multipliers: Array) -> Array:
        """Strains of the multipliers along warp and weft, shape (cells, 2, 2)."""
        local = np.einsum("cix,cax->cia", multipliers, triangles.frame)
        gradient = np.einsum("cia,cib->cab", local, triangles.gradients)
        return np.asarray((gradient + gradient.swapaxes(1, 2)) / 2)

    def stresses(self, corners: Array, multipliers: Array) -> tuple[Triangle, Array]:
        """Geometry, and the corrected stress along warp and weft, shape (cells, 2, 2) [N/m]."""
        triangles = self.triangles(corners)
        wish = triangles.wish
        return triangles, wish + wish @ self.strains(triangles, multipliers) @ wish

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        triangles, stress = self.stresses(corners, multipliers)
        local = triangles.areas[:, None, None] * (triangles.gradients @ stress)
        return np.asarray(local @ triangles.frame)

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        triangles = self.triangles(corners)
        strain = triangles.wish @ self.strains(triangles, multipliers)
        trace = strain[:, 0, 0] + strain[:, 1, 1]
        square = strain[:, 0, 0] ** 2 + strain[:, 1, 1] ** 2 + 2 * strain[:, 0, 1] * strain[:, 1, 0]
        return np.asarray(triangles.areas * (trace + square / 2))

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

    def _strained(self, corners: Array, multipliers: Array) -> tuple[Array, Array, Array]:
        way = corners[:, 1] - corners[:, 0]
        length = np.sqrt(np.einsum("ij,ij->i", way, way))
        unit = way / length[:, None]
        return length, unit, np.einsum("ij,ij->i", unit, multipliers[:, 1] - multipliers[:, 0]) / length

    def tensions(self, corners: Array, multipliers: Array) -> Array:
        """Corrected forces, shape (cells,) [N]."""
        force = self._given(corners)
        return np.asarray(force + force**2 / self.width * self._strained(corners, multipliers)[2])

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        pull = self.tensions(corners, multipliers)[:, None] * self._strained(corners, multipliers)[1]
        return np.stack([-pull, pull], axis=1)

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        length, _, strain = self._strained(corners, multipliers)
        force = self._given(corners)
        return np.asarray(length * (force * strain + (force * strain) ** 2 / (2 * self.width)))

    def stiffnesses(self, corners: Array) -> Array:
        """See `Block`."""
        length, unit, _ = self._strained(corners, np.zeros_like(corners))
        along = (self._given(corners) ** 2 / self.width / length)[:, None, None] * unit[:, :, None] * unit[:, None, :]
        return np.asarray(np.einsum("ij,cxy->cixjy", [[1.0, -1.0], [-1.0, 1.0]], along))


@dataclass(frozen=True)
class LoadBlock:
    """Cells under a load that is spread on their nodes."""

    cells: Cells
    load: Any

    def forces(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        numbers = np.arange(corners.shape[0] * corners.shape[1]).reshape(corners.shape[:2])
        spread = cell_loads(self.load, corners.reshape(-1, 3), numbers) / corners.shape[1]
        return np.broadcast_to(-spread[:, None], corners.shape)

    def energies(self, corners: Array, multipliers: Array) -> Array:
        """See `Block`."""
        return np.asarray(np.einsum("cix,cix->c", self.forces(corners, multipliers), multipliers))

    def stiffnesses(self, corners: Array) -> Array:
        """See `Block`."""
        n = corners.shape[1]
        return np.zeros((len(corners), n, 3, n, 3))


def square_root(tensors: Array) -> Array:
    """Square roots of symmetric positive tensors, shape (cells, 2, 2); NaN of others, which later checks refuse."""
    with np.errstate(invalid="ignore"):
        root = np.sqrt(np.linalg.det(tensors))
        scale = np.sqrt(np.trace(tensors, axis1=1, axis2=2) + 2 * root)
    return np.asarray((tensors + root[:, None, None] * np.eye(2)) / scale[:, None, None])
