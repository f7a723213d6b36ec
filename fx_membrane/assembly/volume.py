"""Volume within a closed surface of triangles, and its derivatives by the positions of the nodes.

    V = sum of det[a, b, c] / 6,    dV/da = b x c / 6,    d2V/da db = -[c]x / 6

over triangles a, b, c whose normals point outwards, by the divergence theorem. It is exact for the polyhedron, and a
polynomial: the gradient is a third of the vector areas that meet at each node. The positions are relative to a point
nearby, which keeps digits. A rigid wall is a fan of triangles from a fixed point in its plane to the rim of a hole.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from .discretization import Discretization
from .node_values import NodeValues

Array = NDArray[np.float64]
Nodes = NDArray[np.int64]

PAIRS = ((0, 1, 2), (1, 2, 0), (2, 0, 1))  # of a triangle a, b, c in cyclic order


class Volume:
    """Volume of a chamber, as an integral of the shape; each process sums over triangles of its own.

    Args:
        discretization: The numbering.
        triangles: Cells of the surface, their normals outwards, shape (cells, 3).
        rims: Edges of rigid walls, in the sense of the walls, shape (edges, 2).
        centers: Fixed point in the plane of the wall of each edge, shape (edges, 3) [m].
    """

    def __init__(self, discretization: Discretization, triangles: Nodes, rims: Nodes, centers: Array):
        self.comm = discretization.comm
        points = discretization.structure.points
        self._origin = points[triangles].mean(axis=(0, 1))
        mine = np.zeros(len(points), dtype=bool)
        mine[discretization.owned_nodes] = True
        cells, edges = triangles[mine[triangles[:, 0]]], mine[rims[:, 0]]
        nodes, places = np.unique(np.concatenate([cells.ravel(), rims[edges].ravel()]), return_inverse=True)
        self._nodes = NodeValues(discretization, nodes)
        places = places.ravel()
        self._cells = places[: cells.size].reshape(-1, 3)
        self._rims = places[cells.size :].reshape(-1, 2)
        self._centers = centers[edges] - self._origin

    def value(self, x: PETSc.Vec) -> float:
        """Volume for a displacement [m3]."""
        a, b, c = self._corners(x)
        return float(self.comm.allreduce(float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)))

    def gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Set a vector to the derivative of the volume [m2]."""
        corners = self._corners(x)
        values = np.zeros_like(self._nodes.points)
        for i, j, k in PAIRS:
            share = np.cross(corners[j], corners[k]) / 6
            nodes, count = self._places(i)
            np.add.at(values, nodes, share[:count])
        b.set(0.0)
        self._nodes.add(values, b)

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat, factor: float) -> None:
        """Add the second derivative of the volume [m], times a factor, to a tangent."""
        corners = self._corners(x)
        rows, columns, axes = [], [], []
        for i, j, k in PAIRS:
            (left, some), (right, more) = self._places(i), self._places(j)
            count = min(some, more)
            rows += [left[:count], right[:count]]
            columns += [right[:count], left[:count]]
            axes += [-corners[k][:count], corners[k][:count]]
        blocks = _cross(np.concatenate(axes) * (factor / 6))
        self._nodes.add_blocks(A, np.concatenate(rows), np.concatenate(columns), blocks)

    def _corners(self, x: PETSc.Vec) -> tuple[Array, Array, Array]:
        """Corners of the cells, and behind them those of the walls, the fixed point last, shape (cells + edges, 3)."""
        positions = self._nodes.positions(x) - self._origin
        a, b = (np.vstack([positions[self._cells[:, i]], positions[self._rims[:, i]]]) for i in (0, 1))
        return a, b, np.vstack([positions[self._cells[:, 2]], self._centers])

    def _places(self, corner: int) -> tuple[Nodes, int]:
        """Positions of the nodes of a corner, and their number; the fixed points have none."""
        places = self._cells[:, corner]
        if corner < 2:
            places = np.concatenate([places, self._rims[:, corner]])
        return places, len(places)


def _cross(vectors: Array) -> Array:
    """Matrices of the cross products with vectors, shape (m, 3, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
