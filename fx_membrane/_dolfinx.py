"""Everything that differs between versions of dolfinx, and nothing else.

Meshes and forms live on one process each (`MPI.COMM_SELF`); the parallel system is built from them in
`discretization`.
"""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import basix
import numpy as np
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from numpy.typing import NDArray

CELL = {1: "interval", 2: "triangle"}

# -O2: insertion into the matrix dominates, and -O3 takes seconds to compile on some gcc; 300 s is how long a process
# waits for another one that compiles the same form.
JIT = {"cffi_extra_compile_args": ["-O2", "-g0"], "timeout": 300}


def create_mesh(points: NDArray[np.float64], cells: NDArray[np.int64]) -> Any:
    """Mesh of intervals, cells (n, 2), or triangles, cells (n, 3), in space; points (m, 3) [m]."""
    cell = ufl.Cell(CELL[cells.shape[1] - 1], geometric_dimension=3)
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1))
    return mesh.create_mesh(MPI.COMM_SELF, cells, points, domain, ghost_mode=mesh.GhostMode.none)


def functionspace(msh: Any, family: str, degree: int, size: int) -> Any:
    """Space of vectors with `size` components."""
    return fem.FunctionSpace(msh, ufl.VectorElement(family, msh.ufl_cell(), degree, dim=size))


def cell_order(msh: Any) -> NDArray[np.int64]:
    """Row in the `cells` given to `create_mesh` of each cell of the mesh."""
    return np.asarray(msh.topology.original_cell_index, dtype=np.int64)


def node_order(V: Any) -> NDArray[np.int64]:
    """Row in the `points` given to `create_mesh` of each node of a linear Lagrange space."""
    msh = V.mesh
    node = np.empty(V.dofmap.index_map.size_local, dtype=np.int64)
    geometry = np.asarray(msh.geometry.input_global_indices)[msh.geometry.dofmap.array]
    node[V.dofmap.list.array] = geometry
    return node


@contextmanager
def _quiet_compiler() -> Iterator[None]:
    """Keeps the gcc commands that FFCx logs at INFO to the root logger to itself, and undoes its change of level."""
    disabled, level = logging.root.manager.disable, logging.root.level
    logging.disable(logging.INFO)
    try:
        yield
    finally:
        logging.disable(disabled)
        logging.root.setLevel(level)


def form(a: Any) -> Any:
    """Compiled form; from the cache on disk where it was compiled before."""
    with _quiet_compiler():
        return fem.form(a, jit_params=dict(JIT))


class CellExpression:
    """A vector-valued UFL expression, compiled, evaluated at the midpoint of every cell."""

    def __init__(self, expression: Any, msh: Any):
        kind = getattr(basix.CellType, CELL[msh.topology.dim])
        midpoint = basix.geometry(kind).mean(axis=0, keepdims=True)
        self._cells = np.arange(msh.topology.index_map(msh.topology.dim).size_local, dtype=np.int32)
        with _quiet_compiler():
            self._expression = fem.Expression(expression, midpoint, jit_params=dict(JIT))

    def __call__(self) -> NDArray[np.float64]:
        """Values, shape (cells of the mesh, size)."""
        return self._expression.eval(self._cells).reshape(len(self._cells), -1)
