"""Values of some nodes on the processes that need them, for sums that are no forms of a part: volumes, rope lengths."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse

from .discretization import Discretization

Array = NDArray[np.float64]


class NodeValues:
    """Nodes that a process reads and adds to, owned by itself or by others.

    Args:
        discretization: The numbering.
        nodes: Different nodes of parts; another set on each process, shape (k,). It may be empty.

    Attributes:
        points: Their reference positions, shape (k, 3) [m].
    """

    def __init__(self, discretization: Discretization, nodes: NDArray[np.int64]):
        self.points = discretization.structure.points[nodes]
        self._blocks = discretization.block_of_node[nodes].astype(PETSc.IntType)
        where = PETSc.IS().createBlock(3, self._blocks, comm=MPI.COMM_SELF)
        self._values = PETSc.Vec().createSeq(3 * len(nodes), comm=MPI.COMM_SELF)
        self._scatter = PETSc.Scatter().create(discretization.create_vector(), where, self._values, None)

    def positions(self, x: PETSc.Vec) -> Array:
        """Return the current positions for a displacement, shape (k, 3) [m]; collective."""
        self._scatter.scatter(x, self._values, PETSc.InsertMode.INSERT, PETSc.ScatterMode.FORWARD)
        return self.points + self._values.array_r.reshape(-1, 3)

    def add(self, values: Array, b: PETSc.Vec) -> None:
        """Add values of the nodes, shape (k, 3), to a vector; collective."""
        self._values.array[:] = values.ravel()
        self._scatter.scatter(self._values, b, PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)

    def add_blocks(self, A: PETSc.Mat, rows: NDArray[np.int64], columns: NDArray[np.int64], blocks: Array) -> None:
        """Add blocks, shape (m, 3, 3), to a matrix; collective.

        Args:
            A: The matrix; two nodes of a block share a cell. Of an upper triangle the lower blocks are left out.
            rows: Positions of nodes in this set, shape (m,).
            columns: As the rows.
            blocks: Their blocks; those of equal rows and columns are summed.
        """
        count = len(self._blocks)
        places = rows * count + columns
        found, inverse = np.unique(places, return_inverse=True)
        entries = sparse.csr_matrix(
            (np.ones(len(places)), (inverse.ravel(), np.arange(len(places)))), shape=(len(found), len(places))
        )
        summed = entries @ blocks.reshape(-1, 9)
        here, first = np.unique(found // max(count, 1), return_index=True)
        pointers = np.append(first, len(found)).astype(PETSc.IntType)
        across = self._blocks[found % max(count, 1)]
        A.setValuesBlockedIJV(
            pointers, across, np.ascontiguousarray(summed), addv=PETSc.InsertMode.ADD, rowmap=self._blocks[here]
        )
        A.assemble()
