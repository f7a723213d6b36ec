"""Results of a state as dolfinx functions, on a mesh of a whole part."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from dolfinx.fem import Function
from dolfinx.mesh import Mesh
from mpi4py import MPI
from numpy.typing import NDArray

from .. import _dolfinx
from ..checks import validation
from ..model.digests import of_settings
from ..results.evaluation import STATES
from ..results.part_results import quantities
from ..results.states import StageResult
from ..runtime.processes import refuse_differences, together


@dataclasses.dataclass(frozen=True, eq=False)
class PartFunctions:
    """State of a part as dolfinx functions, distributed over the processes.

    The mesh has the reference shape. Rows lead back to the user's order: `displacement.x.array.reshape(-1, 3)` is
    `result.displacement[node_rows]` and `cells["strain"].x.array` is `result.membrane(name).strain[cell_rows]`,
    flattened.

    Attributes:
        mesh: Mesh of all cells of the part, without ghost cells.
        displacement: Displacement, P1, shape (3,) [m].
        cells: Piecewise constant functions (DG0) by name: the attributes of `MembraneResult` or `BarResult`, with their
            shapes and units. "state" is 0 taut, 1 wrinkled, 2 slack, as in `forms.wrinkling`; "slack" is 0 or 1. For
            membranes also "warp", the unit vectors of `Structure.warp`, shape (3,) [-].
        node_rows: Row in `Structure.points` of each node of this process, in the order of the dofs, ghosts included.
        cell_rows: Row in the `cells` of the part of each cell of this process.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> rim = Support(np.unique(boundary_edges(triangles)))
        >>> sheet = Structure(points, {"sheet": Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)}, [rim])
        >>> state = Analysis(sheet).run([Stage("rest")])["rest"]
        >>> functions = to_dolfinx(state, "sheet")
        >>> functions.displacement.x.array.size == 3 * len(functions.node_rows)
        True
        >>> functions.cells["principal"].x.array[:2].round(6).tolist()
        [2000.0, 2000.0]
    """

    mesh: Mesh
    displacement: Function
    cells: dict[str, Function]
    node_rows: NDArray[np.int64]
    cell_rows: NDArray[np.int64]


def to_dolfinx(state: StageResult, part: str, comm: MPI.Intracomm = MPI.COMM_WORLD) -> PartFunctions:
    """State of a part as dolfinx functions: for dolfinx's writers of files, or forms of your own.

    Args:
        state: The state.
        part: Name of the part.
        comm: The processes that share the mesh; each must give the same state.

    Raises:
        ValueError: There is no part of that name; the processes have different states.
    """
    validation.communicator("to_dolfinx comm", comm)
    with together(comm):
        validation.instance("to_dolfinx state", state, StageResult)
        if not isinstance(part, str) or part not in state.parts:
            raise ValueError(f"No part is named {validation.short_repr(part)}; those are {list(state.parts)}.")
    refuse_differences(comm, lambda: of_settings({"displacement of the state": state.displacement, "part": part}))
    used, cells = np.unique(state.structure.parts[part].cells, return_inverse=True)
    cells = cells.reshape(-1, state.structure.parts[part].dimension + 1)
    here = slice(None if comm.rank == 0 else 0)  # dolfinx distributes those of the first process
    mesh = _dolfinx.create_mesh(state.structure.points[used][here], cells[here], comm)
    V = _dolfinx.functionspace(mesh, "Lagrange", 1, 3)
    node_rows, cell_rows = used[_dolfinx.node_order(V)], _dolfinx.cell_order(mesh)
    displacement = Function(V, name="displacement")
    displacement.x.array[:] = state.displacement[node_rows].ravel()
    return PartFunctions(
        mesh=mesh,
        displacement=displacement,
        cells={name: _cell_function(mesh, name, all_[cell_rows]) for name, all_ in _cell_values(state, part).items()},
        node_rows=node_rows,
        cell_rows=cell_rows,
    )


def _cell_values(state: StageResult, name: str) -> dict[str, NDArray[np.float64]]:
    """Results in the cells as numbers, by name."""
    found: dict[str, Any] = quantities(state.parts[name])
    if name in state.membranes:
        found["warp"] = state.structure.warp(name)
    if "state" in found:
        found["state"] = (found["state"][:, None] == STATES).argmax(axis=1)
    return {key: np.asarray(values, dtype=np.float64) for key, values in found.items()}


def _cell_function(mesh: Mesh, name: str, values: NDArray[np.float64]) -> Function:
    function = Function(_dolfinx.functionspace(mesh, "DG", 0, values.shape[1:]), name=name)
    function.x.array[:] = values.ravel()
    return function
