"""Stress of membranes and its derivatives by displacement and natural shape, as sparse matrices of all cells.

    d sigma = B du + D dH,    dR = K du + G dH        with H of `forms.natural_shape`

so that equilibrium under a change of the natural shape gives d sigma = (D - B K^-1 G) dH.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse

from .. import _dolfinx
from ..forms import kinematics
from ..runtime.processes import gathered
from .forms_of_parts import PartForms
from .problem_under_actions import LoadedProblem

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]


class StressDerivatives(NamedTuple):
    """Derivatives of stress and residual, in the user's order of nodes and cells; on every process, whole.

    Cells of all membranes follow each other; components of a tensor are row by row.

    Attributes:
        by_displacement: B, shape (4 cells, 3 n) [N/m2].
        by_shape: D, shape (4 cells, 4 cells) [N/m].
        residual_by_shape: G, shape (3 n, 4 cells) [N].
    """

    by_displacement: sparse.csr_matrix
    by_shape: sparse.csr_matrix
    residual_by_shape: sparse.csr_matrix


class _Side(NamedTuple):
    """Rows or columns of a matrix, three for each node or four for each cell."""

    size: int
    of_nodes: bool


def turned_stress(loaded: LoadedProblem, x: PETSc.Vec, names: Sequence[str]) -> Array:
    """Cauchy stress of membranes in axes that turn with their cells, shape (cells, 2, 2) [N/m]; collective.

    The axes are warp and weft of the reference shape, turned by the rotation of the deformation gradient.

    Args:
        loaded: The structure under actions.
        x: Displacement [m].
        names: Membranes with a natural shape.
    """
    loaded.assembler.update(x, loaded.cells)
    parts, found = loaded.assembler.parts, []
    for name in names:
        here = parts[name].compiled("turned stress", _stress)() if name in parts else np.empty((0, 4))
        found.append(loaded.discretization.gather_cells(name, here))
    return np.concatenate(found).reshape(-1, 2, 2)


def stress_derivatives(loaded: LoadedProblem, x: PETSc.Vec, names: Sequence[str]) -> StressDerivatives:
    """Differentiate the stress of `turned_stress` and the residual; arguments as there; collective."""
    loaded.assembler.update(x, loaded.cells)
    counts = [len(loaded.structure.parts[name].cells) for name in names]
    first = dict(zip(names, np.cumsum([0, *counts[:-1]]).tolist(), strict=True))
    cells, nodes = _Side(4 * sum(counts), False), _Side(3 * len(loaded.structure.points), True)
    return StressDerivatives(
        _whole(loaded, first, _by_displacement, (cells, nodes)),
        _whole(loaded, first, _by_shape, (cells, cells)),
        _whole(loaded, first, _residual_by_shape, (nodes, cells)),
    )


def _turned(part: PartForms) -> Any:
    """Cauchy stress U S U / det U in UFL, with the right stretch U of the deformation gradient."""
    C = part.F.T * part.F
    ratio = kinematics.stretch_ratio(part.F)
    U = (C + ratio * ufl.Identity(2)) / ufl.sqrt(ufl.tr(C) + 2 * ratio)
    return U * part.S * U / ratio


def _stress(part: PartForms) -> Callable[[], Array]:
    sigma = _turned(part)
    entries = ufl.as_vector([sigma[i, j] for i in range(2) for j in range(2)])
    return _dolfinx.cell_expression(entries, part.mesh.mesh)


def _by_displacement(part: PartForms) -> Any:
    def make(part: PartForms) -> Any:
        return _form(part, _work(part), part.mesh.u)

    return part.compiled("stress by displacement", make)


def _by_shape(part: PartForms) -> Any:
    def make(part: PartForms) -> Any:
        return _form(part, _work(part), part.natural)

    return part.compiled("stress by natural shape", make)


def _residual_by_shape(part: PartForms) -> Any:
    def make(part: PartForms) -> Any:
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return _form(part, residual, part.natural)

    return part.compiled("residual by natural shape", make)


def _work(part: PartForms) -> Any:
    """Integral of the stress times a test tensor that is constant in each cell, over the area of the cell."""
    assert part.natural is not None
    tau, sigma = ufl.TestFunction(part.natural.function_space), _turned(part)
    dx = ufl.Measure("dx", domain=part.mesh.mesh, metadata={"quadrature_degree": 1})  # exact: constant per cell
    return sum(tau[2 * i + j] * sigma[i, j] for i in range(2) for j in range(2)) / ufl.CellVolume(part.mesh.mesh) * dx


def _form(part: PartForms, functional: Any, variable: Any) -> Any:
    return _dolfinx.form(ufl.derivative(functional, variable, ufl.TrialFunction(variable.function_space)))


def _whole(
    loaded: LoadedProblem, first: dict[str, int], form: Callable[[PartForms], Any], shape: tuple[_Side, _Side]
) -> sparse.csr_matrix:
    """Sum a form over membranes, on every process.

    Args:
        loaded: The structure under actions.
        first: First cell of each membrane.
        form: Compiled bilinear form of a part.
        shape: Rows and columns of the matrix.
    """
    entries: list[Any] = []
    for name, start in first.items():
        if name in loaded.assembler.parts:
            part = loaded.assembler.parts[name]
            matrix = fem_petsc.assemble_matrix(form(part))
            matrix.assemble()
            pointers, columns, values = matrix.getValuesCSR()
            matrix.destroy()
            nodes = loaded.discretization.local_nodes[part.mesh.node_rows]
            of_nodes = (3 * nodes[:, None] + np.arange(3)).ravel()
            of_cells = (4 * (start + part.mesh.cell_rows)[:, None] + np.arange(4)).ravel()
            row, column = (of_nodes if side.of_nodes else of_cells for side in shape)
            lines = np.repeat(np.arange(len(pointers) - 1), np.diff(pointers))
            entries.append((row[lines], column[columns], values))
    kinds = (np.int64, np.int64, np.float64)
    joined = [
        gathered(loaded.comm, np.concatenate([np.empty(0, kind), *(entry[i] for entry in entries)]))
        for i, kind in enumerate(kinds)
    ]
    return sparse.csr_matrix((joined[2], (joined[0], joined[1])), shape=(shape[0].size, shape[1].size))
