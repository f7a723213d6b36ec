"""Differences between dolfinx 0.5, 0.9 and 0.11, and nothing else.

Each difference is detected by name, in one place; a comment gives the versions.
"""

from __future__ import annotations

import inspect
import logging
import os
import sys
import warnings
from collections.abc import Callable, Hashable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from typing import Any

from .runtime import petsc as _petsc  # noqa: F401  (before dolfinx is imported)

with warnings.catch_warnings():
    warnings.simplefilter("ignore", ImportWarning)  # 0.9 has one where numba is missing
    _shown = warnings.showwarning
    import dolfinx
    import ffcx

    if warnings.showwarning is not _shown:  # ffcx 0.5 sends the warnings of all modules to the log
        logging.captureWarnings(False)

# isort: split
import basix
import ffcx.codegeneration.jit
import numpy as np
import ufl
from dolfinx import cpp, fem, log, mesh
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from ufl.corealg.map_dag import map_expr_dag

from .runtime import jit_cache
from .runtime.number_locale import decimal_point

CELL = {1: "interval", 2: "triangle"}

# -O3 takes seconds to compile on some gcc and gains little. FFCx 0.5 writes "a || b && c" for Or(a, And(b, c)): that is
# right, and gcc warns of it. A process waits 300 s for another that compiles.
JIT = {"cffi_extra_compile_args": ["-O2", "-g0", "-Wno-parentheses"], "timeout": 300}


def _element(family: str, cell: str, degree: int, size: int | tuple[int, ...]) -> Any:
    """Make an element of vectors with `size` components, or of tensors of a shape; () is a scalar."""
    shape = size if isinstance(size, tuple) else (size,)
    if hasattr(basix, "ufl"):  # 0.9, 0.11: dolfinx has imported it
        return basix.ufl.element(family, cell, degree, **({"shape": shape} if shape else {}))
    if len(shape) != 1:
        kind = ufl.TensorElement if shape else ufl.FiniteElement
        return kind(family, ufl.Cell(cell, geometric_dimension=3), degree, **({"shape": shape} if shape else {}))
    # 0.5; FFCx would add this variant to the element of the mesh, and change the next form's name.
    variant = {"variant": "equispaced"} if family == "Lagrange" else {}
    return ufl.VectorElement(family, ufl.Cell(cell, geometric_dimension=3), degree, dim=shape[0], **variant)


@decimal_point()
def create_mesh(points: NDArray[np.float64], cells: NDArray[np.int64], comm: MPI.Intracomm = MPI.COMM_SELF) -> Any:
    """Make a mesh of intervals, cells (n, 2), or triangles, cells (n, 3), in space; points (m, 3) [m].

    Several processes share it, without ghost cells; each gives some of the points and of the cells.
    """
    domain = ufl.Mesh(_element("Lagrange", CELL[cells.shape[1] - 1], 1, 3))
    if "e" in inspect.signature(mesh.create_mesh).parameters:  # 0.9, 0.11
        return mesh.create_mesh(comm, cells=cells, x=points, e=domain)
    alone = {"partitioner": _undivided} if comm.size == 1 else {}  # 0.5 would divide it by SCOTCH
    return mesh.create_mesh(comm, cells=cells, x=points, domain=domain, ghost_mode=mesh.GhostMode.none, **alone)  # 0.5


def _undivided(comm: Any, parts: int, dimension: int, cells: Any, ghost_mode: Any) -> Any:
    """Leave all cells to a process that has its mesh alone."""
    return cpp.graph.AdjacencyList_int32(np.zeros((cells.num_nodes, 1), dtype=np.int32))


def functionspace(msh: Any, family: str, degree: int, size: int | tuple[int, ...]) -> Any:
    """Make a space of vectors with `size` components, tensors of a shape, () for a scalar. Degree one: Gil (45)."""
    create = getattr(fem, "functionspace", None) or fem.FunctionSpace  # 0.9, 0.11: function; 0.5: class
    alone = msh.comm.size == 1  # or else a process that finds the code would not wait for one that compiles
    kind = ("space", family, msh.topology.dim, degree, size) if alone else ()
    return _compile(create, msh, _element(family, CELL[msh.topology.dim], degree, size), kind=kind)


@cache
def abstract_mesh(dimension: int) -> Any:
    """Make a mesh of intervals or triangles in space for UFL alone, without cells; the same each time."""
    return ufl.Mesh(_element("Lagrange", CELL[dimension], 1, 3))


def abstract_space(family: str, degree: int, dimension: int, size: int) -> Any:
    """Make a space of vectors with `size` components on an abstract mesh."""
    return ufl.FunctionSpace(abstract_mesh(dimension), _element(family, CELL[dimension], degree, size))


def _table(dofmap: Any) -> NDArray[np.int32]:
    return np.asarray(getattr(dofmap, "array", dofmap)).ravel()  # 0.5: adjacency list; 0.9, 0.11: array


def geometry_table(geometry: Any) -> NDArray[np.int32]:
    """Rows of the cells in the coordinates, `geometry.x`, one cell after the other."""
    several = hasattr(geometry, "dofmaps") and not callable(geometry.dofmaps)  # 0.11: one for each cell type
    return _table(geometry.dofmaps[0] if several else geometry.dofmap)


def geometry_degree(msh: Any) -> int:
    """Degree of the shape functions of the cells: 1 for straight ones."""
    several = hasattr(msh.geometry, "cmaps") and not callable(msh.geometry.cmaps)  # 0.11: one for each cell type
    return int((msh.geometry.cmaps[0] if several else msh.geometry.cmap).degree)


def cell_name(msh: Any) -> str:
    """Name of the cells, as "triangle"."""
    name = msh.ufl_domain().ufl_cell().cellname
    return str(name() if callable(name) else name)  # 0.5, 0.9: method; 0.11: property


def is_tags(value: Any) -> bool:
    """Return True for MeshTags."""
    classes = [
        getattr(module, name) for module in (mesh, cpp.mesh) for name in dir(module) if name.startswith("MeshTags")
    ]
    return isinstance(value, tuple(kind for kind in classes if isinstance(kind, type)))  # 0.5: several; 0.9, 0.11: one


def are_tags_of(tags: Any, msh: Any) -> bool:
    """Return True if MeshTags belong to a mesh."""
    topology = tags.topology if hasattr(tags, "topology") else tags.mesh.topology  # 0.9, 0.11: topology; 0.5: mesh
    return bool(topology is getattr(msh.topology, "_cpp_object", msh.topology))


def original_cells(msh: Any) -> NDArray[np.int64] | None:
    """Input number of each cell of this process, ghosts included; None for a sub-mesh, which has none."""
    count = msh.topology.index_map(msh.topology.dim)
    try:
        numbers = cell_order(msh)
    except RuntimeError:  # 0.11
        return None
    return numbers if len(numbers) == count.size_local + count.num_ghosts else None  # 0.5: empty


def cell_order(msh: Any) -> NDArray[np.int64]:
    """Row of each cell of the mesh in the `cells` given to `create_mesh`."""
    return np.asarray(msh.topology.original_cell_index, dtype=np.int64)


def input_nodes(msh: Any) -> NDArray[np.int64]:
    """Row of each node of this process, in the order of `geometry.x`, in the `points` given to `create_mesh`."""
    return np.asarray(msh.geometry.input_global_indices, dtype=np.int64)  # 0.5: a list, empty without cells


def node_order(V: Any) -> NDArray[np.int64]:
    """Row of each node of a linear Lagrange space in the `points` given to `create_mesh`."""
    return input_nodes(V.mesh)[geometry_order(V)]


def geometry_order(V: Any) -> NDArray[np.int64]:
    """Row of each node of a linear Lagrange space in the coordinates of the mesh, `geometry.x`."""
    row = np.empty(V.dofmap.index_map.size_local + V.dofmap.index_map.num_ghosts, dtype=np.int64)
    row[_table(V.dofmap.list)] = geometry_table(V.mesh.geometry)
    return row


@contextmanager
def _quiet_compiler() -> Iterator[None]:
    """Silence warnings of FFCx and setuptools, and the gcc commands that FFCx 0.5 logs at INFO.

    FFCx 0.5 also changes the root logger's level.
    """
    with warnings.catch_warnings(), ExitStack() as restore:
        warnings.simplefilter("ignore")  # errors, if the user turns warnings into errors
        restore.callback(logging.disable, logging.root.manager.disable)
        restore.callback(logging.root.setLevel, logging.root.level)
        logging.disable(logging.INFO)
        yield


def _compile(function: Any, *args: Any, kind: tuple[Hashable, ...] = ()) -> Any:
    with ExitStack() as held:
        held.enter_context(jit_cache.guard(ffcx.codegeneration.jit))  # it lets threads in one by one
        if kind:
            held.enter_context(jit_cache.by_kind(dolfinx.jit, kind))
        if not jit_cache.is_kept(kind):
            held.enter_context(_quiet_compiler())
        return function(*args, **{keyword: dict(JIT) for keyword in _keywords(function)})  # fresh: dolfinx writes there


@cache
def _keywords(function: Any) -> frozenset[str]:
    """Names of the options of compilation; 0.9, 0.11: options; 0.5: params; 0.11 compiles nothing for a space."""
    return frozenset(inspect.signature(function).parameters.keys() & {"jit_options", "jit_params"})


def form(a: Any, kind: tuple[Hashable, ...] = ()) -> Any:
    """Compile a form, or load it from the cache on disk; forms of a kind share their code, see `jit_cache.by_kind`."""
    return _compile(fem.form, a, kind=kind)


def coefficients(compiled: Any) -> list[Any]:
    """List the functions in a compiled form, in the order of the columns of `packed`."""
    return list(getattr(compiled, "_cpp_object", compiled).coefficients)  # 0.9, 0.11: wrapped; 0.5: of C++


def packed(compiled: Any) -> Any:
    """Values of the functions in a compiled form, cell by cell, as assembly takes them.

    Forms whose functions are the first of this form take them, too: each column belongs to one function.
    """
    return cpp.fem.pack_coefficients(getattr(compiled, "_cpp_object", compiled))  # as in `coefficients`


def cell_expression(expression: Any, msh: Any, kind: tuple[Hashable, ...] = ()) -> Callable[..., NDArray[np.float64]]:
    """Compile a vector-valued UFL expression; a call gives its values at the midpoints of all or given cells.

    They have the shape (cells, size). Expressions of a kind share their code.
    """
    dimension = msh.topology.dim
    midpoint = np.full((1, dimension), 1 / (dimension + 1))
    numbered = expression if jit_cache.is_kept(kind) else _numbered_variables(expression)
    compiled = _compile(fem.Expression, numbered, midpoint, kind=kind)
    every = np.arange(msh.topology.index_map(dimension).size_local, dtype=np.int32)
    meshes = (msh,) if "mesh" in inspect.signature(compiled.eval).parameters else ()  # 0.9, 0.11; not 0.5

    def values(cells: NDArray[np.integer[Any]] = every) -> NDArray[np.float64]:
        found = compiled.eval(*meshes, np.asarray(cells, dtype=np.int32))
        return np.asarray(found).reshape(len(cells), expression.ufl_shape[0])

    return values


def _numbered_variables(expression: Any) -> Any:
    """Renumber variables from 0; UFL counts them globally, and 0.9, 0.11 name the compiled expression by the count."""
    labels: dict[Any, Any] = {}

    def visit(o: Any, *operands: Any) -> Any:
        if isinstance(o, ufl.classes.Label):
            return labels.setdefault(o, ufl.classes.Label(len(labels)))
        return o._ufl_expr_reconstruct_(*operands) if operands else o

    return map_expr_dag(visit, expression)


@decimal_point()
def newton_solver(comm: MPI.Intracomm) -> Any:
    """Make the NewtonSolver of C++, which takes callbacks; None after 0.11, where upstream removes it."""
    with _quiet_stderr():
        return cpp.nls.petsc.NewtonSolver(comm) if hasattr(cpp.nls.petsc, "NewtonSolver") else None


@contextmanager
def _quiet_stderr() -> Iterator[None]:
    """Silence C++: 0.11 warns in each NewtonSolver that it is deprecated, past log and warnings."""
    with suppress(AttributeError, OSError, ValueError):  # no stderr, or a closed one
        sys.stderr.flush()
    try:
        kept = os.dup(2)
    except OSError:  # closed
        yield
        return
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


@contextmanager
def quiet_log() -> Iterator[None]:
    """Silence dolfinx's warnings; our own messages cover the important ones."""
    with ExitStack() as restore:
        restore.callback(log.set_log_level, log.get_log_level())
        log.set_log_level(log.LogLevel.ERROR)
        yield


def free_dropped(comm: MPI.Intracomm) -> None:
    """Free the PETSc objects that Python has dropped on all processes; collective.

    petsc4py 3.18 and later keep them until asked: freeing one is collective, and Python's garbage collector drops it at
    a different time on each process. Earlier versions free them at once.
    """
    if hasattr(PETSc, "garbage_cleanup"):
        PETSc.garbage_cleanup(comm)
        PETSc.garbage_cleanup(MPI.COMM_SELF)
