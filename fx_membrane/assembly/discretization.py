"""A structure as dolfinx meshes, one for each part, joined by one displacement vector.

Every process knows the whole structure (plain arrays) and makes meshes of its own cells only. The meshes share the
numbering of nodes. The row in the user's `points` identifies a node; `number` maps it to a 3-block of the PETSc vectors
and matrices. So cables, masts and membranes, also sheets that branch, meet in one system. A process may have no cell of
a part.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..geometry.topology import distinct, node_graph
from ..model.parts import Part
from ..model.structure import Structure
from ..runtime.freed_memory import count_mesh
from ..runtime.processes import gathered
from .partition import bisect, number_nodes

STRIP = 65536  # cells of a strip of a mesh
MatrixKind = Literal["aij", "baij", "sbaij"]


@dataclass(frozen=True, eq=False)
class PartMesh:
    """This process's share of one part.

    Attributes:
        name: Name of the part.
        part: The whole part.
        mesh: dolfinx mesh of the cells of this process.
        cell_rows: Row in `part.cells` of each cell of the mesh.
        node_rows: Position in `Discretization.local_nodes` of each node of the mesh, in the order of the displacement's
            dofs; nodes on a seam between strips of the mesh come several times.
        seam: Nodes of the mesh that come again later in `node_rows`.
        u: Displacement, P1 [m].
        lgmap: Position of each node of the mesh in the PETSc system, for `Mat.setLGMap`.
    """

    name: str
    part: Part
    mesh: Any
    cell_rows: NDArray[np.int64]
    node_rows: NDArray[np.int64]
    seam: NDArray[np.intp]
    u: fem.Function
    lgmap: PETSc.LGMap
    _spaces: dict[int, Any] = field(default_factory=dict, repr=False)

    def move(self, points: NDArray[np.float64]) -> None:
        """Set the reference positions of the nodes of this mesh, shape (nodes, 3) [m]."""
        self.mesh.geometry.x[_dolfinx.geometry_order(self.u.function_space)] = points

    def cell_field(self, values: NDArray[np.float64]) -> fem.Function:
        """Piecewise constant function from values for all cells of the part, shape (cells, ...), flattened per cell."""
        flat = np.reshape(values, (len(self.part.cells), -1))
        made = self.zero_field(flat.shape[1])
        made.x.array[:] = flat.take(self.cell_rows, axis=0).ravel()
        return made

    def zero_field(self, size: int) -> fem.Function:
        """Piecewise constant function of `size` components, zero."""
        if size not in self._spaces:
            self._spaces[size] = _dolfinx.functionspace(self.mesh, "DG", 0, size)
        return fem.Function(self._spaces[size])


class Discretization:
    """Meshes, numbering, and the transfer of nodal values between users, PETSc and the meshes.

    Args:
        structure: The structure.
        comm: The processes that share the work; each must give the same structure.

    Attributes:
        block_of_node: Block of each node in the PETSc system, shape (n,); -1 for a node that no part uses.
        first_block: First block that this process owns.
        owned_nodes: Nodes whose values this process holds, in the order of its part of a PETSc vector.
        rows: First row of each process in the PETSc system, and the number of all rows.
        local_nodes: Nodes that the meshes of this process touch, in the order of their blocks: on one process, that of
            a PETSc vector.
        parts: Meshes of the parts of which this process has cells.
        state: Number that changes with the displacement or the reference positions of a mesh of this process.
    """

    def __init__(self, structure: Structure, comm: MPI.Intracomm = MPI.COMM_WORLD):
        self.structure, self.comm = structure, comm
        used = np.flatnonzero(structure.used)
        compact = np.cumsum(structure.used) - 1  # row in `points` -> row in `used`
        graph = node_graph((compact[part.cells] for part in structure.parts.values()), len(used))
        owner = bisect(structure.points[used], comm.size)
        number = number_nodes(owner, graph)
        ordered = np.argsort(number)
        mine = ordered[owner[ordered] == comm.rank]
        self.block_of_node = np.full(len(structure.points), -1)
        self.block_of_node[used] = number
        self.owned_nodes = used[mine]
        self.first_block = int(comm.exscan(len(mine)) or 0)
        self._size = (3 * len(mine), 3 * len(used))
        rows = graph[mine][:, ordered]  # of the node graph, in the numbering of the system
        self._columns, self._pointers = rows.indices, rows.indptr

        shares = {
            name: np.flatnonzero(owner[compact[part.cells[:, 0]]] == comm.rank)
            for name, part in structure.parts.items()
        }
        touched = np.zeros(len(structure.points), dtype=bool)
        for name, share in shares.items():
            touched[structure.parts[name].cells[share]] = True
        self.local_nodes = used[ordered[touched[used[ordered]]]]
        self.parts = {name: self._part_mesh(name, share) for name, share in shares.items() if len(share)}

        self.state = 0
        self._displacement = np.zeros((len(self.local_nodes), 3))  # that of the meshes
        self._spare: list[PETSc.Vec] = []
        blocks = self.block_of_node[self.local_nodes].astype(PETSc.IntType)
        where = PETSc.IS().createBlock(3, blocks, comm=MPI.COMM_SELF)
        self._local_values = PETSc.Vec().createSeq(3 * len(self.local_nodes), comm=MPI.COMM_SELF)
        vector = self.create_vector()
        self.rows: list[int] = vector.getOwnershipRanges().tolist()
        self._scatter = PETSc.Scatter().create(vector, where, self._local_values, None)

    def _part_mesh(self, name: str, share: NDArray[np.int64]) -> PartMesh:
        part, count = self.structure.parts[name], len(self.structure.points)
        # dolfinx orders cells in a time that grows as the length of a mesh times the square of its width: strips of
        # cells, each with nodes of its own on its seams, keep it linear.
        number = self.block_of_node[part.cells[share, 0]]
        strips = -(-len(share) // STRIP)
        strip = (number - number.min()) * strips // (np.ptp(number) + 1)
        own_nodes, cells = distinct(strip[:, None] * count + part.cells[share], strips * count)
        nodes = own_nodes % count
        mesh = _dolfinx.create_mesh(self.structure.points[nodes], cells)
        V = _dolfinx.functionspace(mesh, "Lagrange", 1, 3)
        nodes = nodes[_dolfinx.node_order(V)]
        rows = np.asarray(np.searchsorted(self.block_of_node[self.local_nodes], self.block_of_node[nodes]))
        last = np.empty(len(self.local_nodes), dtype=np.intp)
        last[rows] = np.arange(len(rows))  # of a node that comes several times, the last place alone
        made = PartMesh(
            name=name,
            part=part,
            mesh=mesh,
            cell_rows=share[_dolfinx.cell_order(mesh)],
            node_rows=rows,
            seam=np.flatnonzero(last[rows] != np.arange(len(rows))),
            u=fem.Function(V),
            lgmap=PETSc.LGMap().create(self.block_of_node[nodes].astype(PETSc.IntType), bsize=3, comm=MPI.COMM_SELF),
        )
        count_mesh(made)
        return made

    # PETSc objects

    def create_vector(self) -> PETSc.Vec:
        """Vector of nodal values, three for each used node, zero."""
        return PETSc.Vec().createMPI(self._size, bsize=3, comm=self.comm)

    @contextmanager
    def work(self, count: int) -> Iterator[list[PETSc.Vec]]:
        """Temporary vectors with arbitrary entries, reused by the next block.

        PETSc keeps vectors that Python drops until all processes have been asked: a new vector for each use fills the
        memory.
        """
        taken = [self._spare.pop() if self._spare else self.create_vector() for _ in range(count)]
        try:
            yield taken
        finally:
            self._spare += taken

    def create_matrix(self, kind: MatrixKind = "aij") -> PETSc.Mat:
        """Matrix with the sparsity pattern of all parts together, exactly preallocated.

        Args:
            kind: "aij"; "baij", blocks of 3 x 3, filled in half the time; "sbaij", the upper triangle of these blocks,
                for a symmetric matrix in a third of the memory.
        """
        columns, pointers = self._columns, self._pointers
        first, count = self.first_block, len(self.owned_nodes)
        own = (columns >= first) & (columns < first + count)
        other = ~own
        if kind == "sbaij":
            upper = columns >= np.repeat(np.arange(first, first + count), np.diff(pointers))
            own, other = own & upper, other & upper
        counts = [np.diff(np.concatenate([[0], np.cumsum(mask)])[pointers]) for mask in (own, other)]
        if kind == "aij":
            counts = [np.repeat(3 * blocks, 3) for blocks in counts]
        A = PETSc.Mat().create(self.comm)
        A.setSizes((self._size, self._size), bsize=3)
        A.setType(kind)
        A.setPreallocationNNZ(tuple(blocks.astype(PETSc.IntType) for blocks in counts))
        A.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        if kind == "sbaij":
            A.setOption(PETSc.Mat.Option.IGNORE_LOWER_TRIANGULAR, True)
        # petsc4py derives it from the counts; a process without rows has none, and options must agree between
        # processes.
        A.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, True)
        return A

    def dofs(self, mask: NDArray[np.bool_]) -> NDArray[np.int32]:
        """System numbers of the components chosen by a mask (n, 3) that this process owns."""
        return np.asarray(3 * self.first_block + np.flatnonzero(mask[self.owned_nodes]), dtype=PETSc.IntType)

    def stiff_nodes(self, A: PETSc.Mat) -> NDArray[np.bool_]:
        """Nodes with an entry in a tangent, shape (n,): all except those where no cell has stiffness."""
        here = self.create_vector()
        pointers, _, values = A.getValuesCSR()
        entries = np.repeat(np.arange(len(pointers) - 1), np.diff(pointers))
        np.maximum.at(here.array, entries, np.abs(values))
        return np.any(self.to_numpy(here), axis=1)

    # Transfer of nodal values

    def to_petsc(self, values: NDArray[np.float64], vector: PETSc.Vec | None = None) -> PETSc.Vec:
        """PETSc vector of the user's nodal values, shape (n, 3): a new one, or the given one."""
        vector = self.create_vector() if vector is None else vector
        vector.array[:] = values[self.owned_nodes].ravel()
        return vector

    def to_numpy(self, vector: PETSc.Vec) -> NDArray[np.float64]:
        """Nodal values in the user's order on every process, shape (n, 3); zero at nodes that no part uses."""
        values: NDArray[np.float64] = gathered(self.comm, vector.array_r.reshape(-1, 3))[self.block_of_node]
        values[self.block_of_node < 0] = 0.0
        return values

    def gather_cells(self, name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Values of all cells of a part on every process, shape (cells, size), from those of each process's mesh.

        Args:
            name: Name of the part.
            values: Values in the order of this process's mesh, shape (its cells, size); (0, size) without a mesh.
        """
        result = np.empty((len(self.structure.parts[name].cells), values.shape[1]))
        rows = self.parts[name].cell_rows if name in self.parts else np.empty(0, dtype=np.int64)
        result[gathered(self.comm, rows)] = gathered(self.comm, values)
        return result

    def scatter(self, vector: PETSc.Vec) -> None:
        """Set the displacement `u` of every mesh from a PETSc vector."""
        values = self._of_local_nodes(vector)
        if np.array_equal(values, self._displacement):
            return
        self._displacement[:] = values
        self.state += 1
        for mesh in self.parts.values():
            values.take(mesh.node_rows, axis=0, out=mesh.u.x.array.reshape(-1, 3), mode="clip")

    def _of_local_nodes(self, vector: PETSc.Vec) -> NDArray[np.float64]:
        """Values at the nodes of the meshes of this process, shape (local nodes, 3)."""
        if self.comm.size == 1:  # nothing to send
            return np.asarray(vector.array_r.reshape(-1, 3))
        self._scatter.scatter(vector, self._local_values, PETSc.InsertMode.INSERT, PETSc.ScatterMode.FORWARD)
        return np.asarray(self._local_values.array_r.reshape(-1, 3))

    def move(self, points: NDArray[np.float64]) -> None:
        """Set the reference positions of all meshes from the user's nodes, shape (n, 3) [m]."""
        self.state += 1
        for mesh in self.parts.values():
            mesh.move(points[self.local_nodes[mesh.node_rows]])

    def scatter_add(self, shares: Iterator[tuple[PartMesh, NDArray[np.float64]]], vector: PETSc.Vec) -> None:
        """Add nodal vectors of meshes, in the order of their dofs, to a PETSc vector."""
        alone = self.comm.size == 1
        sums = (vector if alone else self._local_values).array.reshape(-1, 3)
        if not alone:
            sums[:] = 0
        for mesh, values in shares:
            here = values.reshape(-1, 3)
            seam = mesh.node_rows[mesh.seam]
            # Of a node that comes several times, the last value alone.
            sums[mesh.node_rows] = sums.take(mesh.node_rows, axis=0) + here
            if len(seam):  # only a mesh of several strips
                np.add.at(sums, seam, here[mesh.seam])
        if not alone:
            self._scatter.scatter(self._local_values, vector, PETSc.InsertMode.ADD, PETSc.ScatterMode.REVERSE)


def matrix_kind(A: PETSc.Mat) -> MatrixKind:
    """Return the kind of a matrix, on one process or several."""
    name = A.getType()
    return "sbaij" if name.endswith("sbaij") else "baij" if name.endswith("baij") else "aij"
